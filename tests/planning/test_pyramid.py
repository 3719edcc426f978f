import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from maulstick.planning.objectives.pyramid import levels_of, mean_squares, plain_mean_squares

ROUNDING = 1e-5  # relative, of float32

sides = st.integers(1, 70)


def noise(seed: int, *shape: int) -> Tensor:
    return torch.randn(*shape, generator=torch.Generator().manual_seed(seed))


@settings(deadline=None)
@given(
    shape=st.tuples(st.integers(1, 3), sides, sides),
    weights=st.lists(st.just(0.0) | st.floats(0.0625, 8, width=32), min_size=1, max_size=5),
    seed=st.integers(0, 99),
)
def test_values_and_slopes_are_those_of_the_plain_way(
    shape: tuple[int, int, int], weights: list[float], seed: int
) -> None:
    fast = noise(seed, *shape).requires_grad_()
    plain = fast.detach().double().requires_grad_()
    loss, expected = mean_squares(fast, weights), plain_mean_squares(plain, weights)
    assert loss.item() == pytest.approx(expected.item(), rel=ROUNDING, abs=1e-12)
    (3 * loss).backward()
    (3 * expected).backward()
    assert fast.grad is not None
    assert plain.grad is not None
    size = plain.grad.abs().max().item()
    assert (fast.grad - plain.grad).abs().max().item() <= ROUNDING * size


def test_a_difference_that_does_not_lie_row_by_row_has_the_same_value_and_slope() -> None:
    plain = noise(0, 3, 40, 24).transpose(1, 2).requires_grad_()
    rows = plain.detach().clone(memory_format=torch.contiguous_format).requires_grad_()
    for each in (plain, rows):
        mean_squares(each, [1.0, 2.0, 4.0]).backward()
    assert not plain.is_contiguous()
    assert torch.equal(plain.grad, rows.grad)


def test_other_precisions_are_computed_as_they_are() -> None:
    difference = noise(1, 3, 33, 20).double()
    assert torch.equal(mean_squares(difference, [1.0, 2.0]), plain_mean_squares(difference, [1.0, 2.0]))


def test_the_same_difference_has_the_same_slope_to_the_bit() -> None:
    slopes = []
    for _ in range(2):
        difference = noise(2, 3, 65, 48).requires_grad_()
        mean_squares(difference, [1.0, 2.0, 4.0]).backward()
        slopes.append(difference.grad)
    assert torch.equal(*slopes)


def test_the_coarsest_level_is_some_16_pixels_high() -> None:
    image = torch.zeros(3, 256, 300)
    assert 8 < 256 / 2 ** (levels_of(image) - 1) <= 32
    assert levels_of(torch.zeros(3, 1, 1)) == 1
