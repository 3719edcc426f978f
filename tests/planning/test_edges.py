"""The fast way of the term for edges is the plain one, values and slopes."""

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from maulstick.planning.objectives import edges
from maulstick.planning.objectives.edges import Edges
from maulstick.planning.objectives.luminance import luminance

VALUE, SLOPE = 2e-6, 2e-5  # of float32; relative to the largest slopes, before those of a part are taken from another's

sides = st.integers(1, 70)


def noise(seed: int, *shape: int) -> Tensor:
    return torch.rand(*shape, generator=torch.Generator().manual_seed(seed))


def term(seed: int, height: int, width: int, precision: torch.dtype = torch.float32) -> Edges:
    return Edges(noise(seed + 1, 3, height, width).to(precision), noise(seed + 2, height, width).to(precision))


def parts_of_slopes(plain: Edges, canvas: Tensor) -> Tensor:
    """Sizes of all that is summed to a slope (3, H, W): where canvas and picture correlate, little is left of it.

    Of each level, through the correlation's numerator and through its denominator.
    """
    total = torch.zeros_like(canvas)
    for number, (wanted, energy, shares) in enumerate(plain._wanted):
        for held in ("numerator", "denominator"):
            image = canvas.detach().requires_grad_()
            slopes = edges._slopes(plain._pyramid(luminance(image))[number])
            both, own = edges._windowed(slopes, wanted), edges._windowed(slopes, slopes)
            both, own = (both.detach(), own) if held == "numerator" else (both, own.detach())
            correlations = (shares * both / (own * energy).sqrt()).sum()
            total += torch.autograd.grad(correlations, image)[0].abs() / len(plain._wanted)
    return total


def assert_as_plainly(fast: Edges, plain: Edges, canvas: Tensor) -> None:
    canvas.requires_grad_()
    in_double = canvas.detach().double().requires_grad_()
    parts = parts_of_slopes(plain, in_double)
    loss, expected = fast.loss(canvas, 0.5), plain.plain_loss(luminance(in_double))
    assert loss.item() == pytest.approx(expected.item(), abs=VALUE * (1 + parts.norm().item()))  # pixels are rounded
    (3 * loss).backward()
    (3 * expected).backward()
    assert canvas.grad is not None
    assert in_double.grad is not None
    assert (canvas.grad - in_double.grad).abs().max() <= SLOPE * 3 * parts.max()


@settings(deadline=None)
@given(height=sides, width=sides, seed=st.integers(0, 99))
def test_values_and_slopes_are_those_of_the_plain_way(height: int, width: int, seed: int) -> None:
    canvas = noise(seed, 3, height, width)
    assert_as_plainly(term(seed, height, width), term(seed, height, width, torch.float64), canvas)


def test_a_large_canvas_is_compared_on_halved_pixels_as_plainly(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(edges, "_LARGEST_PX", 20)
    assert_as_plainly(term(1, 70, 41), term(1, 70, 41, torch.float64), noise(1, 3, 70, 41))


def test_a_canvas_that_does_not_lie_row_by_row_has_the_same_value_and_slope() -> None:
    canvas, compared = noise(3, 3, 24, 40), term(3, 24, 40)
    plain = canvas.transpose(1, 2).contiguous().transpose(1, 2).requires_grad_()
    rows = canvas.clone().requires_grad_()
    for each in (plain, rows):
        compared.loss(each, 0.0).backward()
    assert (plain.grad - rows.grad).abs().max() <= SLOPE * rows.grad.abs().max()  # some processors round otherwise


def test_blank_paper_and_flat_pictures_have_finite_slopes() -> None:
    for target in (torch.ones(3, 20, 30), noise(4, 3, 20, 30)):
        canvas = torch.ones(3, 20, 30, requires_grad=True)
        Edges(target, torch.ones(20, 30)).loss(canvas, 0.0).backward()
        assert canvas.grad is not None
        assert canvas.grad.isfinite().all()
