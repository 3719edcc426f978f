import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from maulstick.storage.arrays import Floats
from maulstick.style.arrangement.laid import NEAREST, Laid, describe, plain_describe
from tests.support.drawn import scattered


def both_ways(laid: Laid, unit: float) -> list[tuple[Tensor, ...]]:
    """Numbers, and slopes of a sum of them that is weighted at random, by the native pass and by the plain one."""
    found = []
    for way in (describe, plain_describe):
        given = [tensor.detach().clone().requires_grad_() for tensor in vars(laid).values()]
        numbers = way(Laid(*given), unit)
        weights = torch.randn(numbers.shape, generator=torch.Generator().manual_seed(0), dtype=torch.float64)
        found.append((numbers.detach(), *torch.autograd.grad((weights * numbers).sum(), given)))
    return found


def lay(paths: Floats, seed: int) -> Laid:
    angles = torch.from_numpy(np.random.default_rng(seed).uniform(0, 2 * np.pi, len(paths)))
    return Laid.of(torch.from_numpy(paths), torch.from_numpy(paths.mean(axis=1)), angles)


@settings(max_examples=30, deadline=None)
@given(count=st.integers(6, 60), seed=st.integers(0, 2**31), unit=st.sampled_from([1e-3, 0.02, 1.0]))
def test_numbers_of_strokes_and_their_slopes_are_those_of_the_plain_twin(count: int, seed: int, unit: float) -> None:
    native, plain = both_ways(lay(scattered(count, seed=seed), seed), unit)
    for ours, theirs in zip(native, plain, strict=True):
        assert ours.numpy() == pytest.approx(theirs.numpy(), rel=1e-9, abs=1e-9 * float(theirs.abs().max()))


def test_strokes_on_top_of_each_other_have_the_slopes_of_the_plain_twin() -> None:
    """All gaps of a stroke are equal there, so none is the shortest, and they have no spread."""
    native, plain = both_ways(lay(np.repeat(scattered(1, seed=0), 12, axis=0), seed=0), 0.02)
    for ours, theirs in zip(native, plain, strict=True):
        assert ours.isfinite().all()
        assert ours.numpy() == pytest.approx(theirs.numpy(), rel=1e-9, abs=1e-9)


def test_a_stroke_is_never_near_itself_where_others_have_its_centre() -> None:
    along = torch.linspace(-0.005, 0.005, 32, dtype=torch.float64)
    level, upright = torch.stack([along, 0 * along], dim=1), torch.stack([0 * along, along], dim=1)
    places = torch.cartesian_prod(*2 * [torch.arange(5, dtype=torch.float64)])
    crosses = torch.stack([place + line for place in places for line in (level, upright)])
    centres = places.repeat_interleave(2, dim=0)
    numbers = describe(Laid.of(crosses, centres, crosses.new_zeros(len(crosses))), 0.01)
    assert numbers[:, NEAREST].numpy() == pytest.approx(-1), "how parallel the nearest is: the other of its cross"


def test_strokes_of_one_centre_have_each_other_near() -> None:
    lengths = torch.linspace(0.01, 0.02, 12, dtype=torch.float64)
    along = torch.linspace(-0.5, 0.5, 32, dtype=torch.float64)
    rulers = torch.stack([lengths[:, None] * along, 0 * lengths[:, None] * along], dim=-1)
    numbers = describe(Laid.of(rulers, rulers.new_zeros(12, 2), rulers.new_zeros(12)), 0.01)
    assert (numbers[:, 4 * NEAREST : 5 * NEAREST] > 0).all(), "how much longer or shorter the near ones are"


def test_slopes_of_numbers_are_their_differences() -> None:
    laid = lay(scattered(8, seed=3), seed=3)
    given = [tensor.clone().requires_grad_() for tensor in vars(laid).values()]
    assert torch.autograd.gradcheck(lambda *tensors: describe(Laid(*tensors), 0.02), given, eps=1e-8, atol=1e-3)


def test_fewer_strokes_than_are_near_one_are_refused() -> None:
    with pytest.raises(ValueError, match="too few strokes"):
        describe(lay(scattered(4, seed=0), seed=0), 0.02)
