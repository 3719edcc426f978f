import numpy as np
import pytest
import torch

from maulstick.painting.raster import Canvas
from maulstick.style.free import FreeStyle
from maulstick.style.style import Style
from maulstick.style.train import fine_tune, pretrained
from tests.support.style.synthetic_hands import circle, drawn, exemplar_of, hand_of, strokes_of


@pytest.fixture(scope="module", params=["exemplar", "trajvae"])
def style(request: pytest.FixtureRequest) -> Style:
    if request.param == "exemplar":
        return exemplar_of(circle)
    return fine_tune(pretrained(), hand_of(drawn(circle, 20)), seed=0, steps=5)


def test_the_hand_of_another_size_draws_the_same_strokes_as_much_larger(style: Style) -> None:
    twice = style.scaled(2.0)
    few, many = (each.sample(30, torch.Generator().manual_seed(0))[0] for each in (style, twice))
    assert twice.decode(many).numpy() == pytest.approx(2 * style.decode(few).numpy(), rel=0.02, abs=2e-4)
    assert twice.lengths(9).numpy() == pytest.approx(2 * style.lengths(9).numpy())  # type: ignore[union-attr]


def test_a_style_of_its_own_size_is_itself_and_keeps_what_it_has_computed(style: Style) -> None:
    free = FreeStyle.for_canvas(Canvas(0.2, 0.16, 1000.0))
    assert style.scaled(1.0) is style
    assert free.scaled(1.0) is free


def test_strokes_of_a_scaled_hand_cost_as_much_as_they_did(style: Style) -> None:
    knots = torch.full((30, 4), 0.5)
    costs = [
        each.cost(each.sample(30, torch.Generator().manual_seed(0))[0], knots).mean().item()
        for each in (style, style.scaled(0.5))
    ]
    assert costs[1] == pytest.approx(costs[0], rel=0.02)


def test_a_hand_that_draws_larger_draws_faster() -> None:
    strokes = strokes_of(drawn(circle, 20), seconds=1.0)
    hand = type(hand_of(drawn(circle, 20))).of(strokes)
    assert hand.scaled(3.0).speeds == pytest.approx(3 * hand.speeds)


def test_the_limits_of_the_free_style_scale() -> None:
    free = FreeStyle.for_canvas(Canvas(0.2, 0.16, 1000.0))
    assert np.array([free.scaled(0.5).shortest, free.scaled(0.5).longest]) == pytest.approx(
        0.5 * np.array([free.shortest, free.longest])
    )
