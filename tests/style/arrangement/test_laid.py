import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from maulstick.storage.arrays import Floats
from maulstick.style.arrangement.laid import Laid, describe, plain_describe
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


def test_slopes_of_numbers_are_their_differences() -> None:
    laid = lay(scattered(8, seed=3), seed=3)
    given = [tensor.clone().requires_grad_() for tensor in vars(laid).values()]
    assert torch.autograd.gradcheck(lambda *tensors: describe(Laid(*tensors), 0.02), given, eps=1e-8, atol=1e-3)


def test_fewer_strokes_than_are_near_one_are_refused() -> None:
    with pytest.raises(ValueError, match="too few strokes"):
        describe(lay(scattered(4, seed=0), seed=0), 0.02)
