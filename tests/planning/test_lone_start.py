"""Strokes along lines of a hand whose arrangement is unknown."""

import numpy as np
import pytest
import torch

from maulstick.planning.lone_start import OnLines, strokes_on_lines
from maulstick.storage.arrays import Floats
from maulstick.style import Style
from maulstick.style.free import FreeStyle
from maulstick.style.traits import path_length
from tests.support.nominal import nominal
from tests.support.style.synthetic_hands import exemplar_of, line

SIZE, SCALE, COUNT = (120, 160), 2000.0, 40  # pixels, and pixels per metre
ACROSS = np.stack([np.linspace(10.0, 150.0, 141), np.full(141, 60.0)], axis=1)


def laid(hand: Style, *lines: Floats, density: Floats | None = None) -> OnLines | None:
    return strokes_on_lines(
        hand, lines, np.ones((3, *SIZE)), np.ones(SIZE) if density is None else density, COUNT, nominal("fineliner"),
        SCALE, torch.Generator().manual_seed(0),
    )  # fmt: skip


@pytest.fixture(scope="module")
def hand() -> Style:
    return exemplar_of(line)


def test_strokes_lie_on_the_line_and_the_others_are_left_with_the_hands_lengths(hand: Style) -> None:
    found = laid(hand, ACROSS)
    assert found is not None
    on, others, _ = found
    assert 1 < len(on) < COUNT
    assert len(on) + len(others) == COUNT
    paths = SCALE * on.trajectories(hand)[..., :2].detach().numpy()
    assert np.abs(paths[..., 1] - 60).max() < 3
    assert np.ptp(paths[..., 0]) > 120
    lengths = torch.cat([path_length(hand.decode(on.codes)), path_length(others)]).sort().values
    assert lengths.detach().numpy() == pytest.approx(hand.lengths(COUNT).numpy(), rel=1e-3)


def test_less_is_left_to_be_drawn_on_the_line_and_as_much_elsewhere(hand: Style) -> None:
    density = np.full(SIZE, 0.5)
    found = laid(hand, ACROSS, density=density)
    assert found is not None
    left = found.density
    assert left[60, 20:140].mean() < 0.8 * 0.5
    assert left[[5, -5]] == pytest.approx(0.5)
    assert (left <= density).all()


def test_where_there_is_no_line_or_none_fits_and_of_strokes_that_may_grow_none_is_laid(
    hand: Style,
) -> None:
    assert laid(hand) is None
    assert laid(hand, np.ones((5, 2))) is None
    assert laid(FreeStyle(0.004, 0.1), ACROSS) is None
