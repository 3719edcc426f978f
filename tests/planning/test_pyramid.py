import gc
import weakref

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from maulstick.planning.objectives import pyramid
from maulstick.planning.objectives.fused import Plain, Recorded
from maulstick.planning.objectives.pyramid import MeanSquares, levels_of

ROUNDING = 1e-5  # relative, of float32

sides = st.integers(1, 70)


def noise(seed: int, *shape: int) -> Tensor:
    return torch.randn(*shape, generator=torch.Generator().manual_seed(seed))


def images(seed: int, *shape: int) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """A canvas, a target, a scale and a pull."""
    canvas, target, pull = (noise(seed + i, *shape) for i in range(3))
    return canvas, target, noise(seed + 3, *shape[1:]).abs(), pull


@settings(deadline=None)
@given(
    shape=st.tuples(st.integers(1, 3), sides, sides),
    weights=st.lists(st.just(0.0) | st.floats(0.0625, 8, width=32), min_size=1, max_size=5),
    pulled=st.booleans(),
    seed=st.integers(0, 99),
)
def test_values_and_slopes_are_those_of_the_plain_way(
    shape: tuple[int, int, int], weights: list[float], pulled: bool, seed: int
) -> None:
    fast, target, scale, pull = images(seed, *shape)
    fast.requires_grad_()
    plain = fast.detach().double().requires_grad_()
    loss = MeanSquares(target, scale, pull if pulled else None)(fast, weights)
    in_double, in_levels = [each.double() for each in (target, scale)], torch.tensor(weights, dtype=torch.float64)
    expected = MeanSquares(*in_double, pull.double() if pulled else None).plain(plain, in_levels)
    terms = MeanSquares(*in_double).plain(plain, in_levels).item() + ((plain - target) * pull).abs().mean().item()
    assert loss.item() == pytest.approx(expected.item(), rel=ROUNDING, abs=ROUNDING * terms if pulled else 1e-12)
    (3 * loss).backward()
    (3 * expected).backward()
    assert fast.grad is not None
    assert plain.grad is not None
    size = plain.grad.abs().max().item()
    assert (fast.grad - plain.grad).abs().max().item() <= ROUNDING * size


def test_a_canvas_that_does_not_lie_row_by_row_has_the_same_value_and_slope() -> None:
    canvas, *others = images(0, 3, 24, 40)
    plain = canvas.transpose(1, 2).contiguous().transpose(1, 2).requires_grad_()
    rows = canvas.clone().requires_grad_()
    for each in (plain, rows):
        MeanSquares(*others)(each, [1.0, 2.0, 4.0]).backward()
    assert not plain.is_contiguous()
    assert torch.equal(plain.grad, rows.grad)


@pytest.fixture(params=["as it is", "replayed"])
def device(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> torch.device:
    """A GPU where there is one; else the CPU, which also writes results where the first were, as what is replayed."""
    find = Recorded._work

    def again(self: Recorded, plain: Plain) -> None:
        first = vars(self).get("_value"), vars(self).get("_slope")
        find(self, plain)
        if first[1] is not None and first[1].shape == self._slope.shape:
            self._value, self._slope = first[0].copy_(self._value), first[1].copy_(self._slope)

    if request.param == "replayed":
        monkeypatch.setattr(Recorded, "_work", again)
    return torch.device("cuda" if torch.cuda.is_available() else "cpu")


@pytest.mark.parametrize("weights", [[1.0, 2.0], [0.5, 0.25, 0.25], [3.0]])
def test_other_precisions_are_computed_plainly_again_and_again(device: torch.device, weights: list[float]) -> None:
    first, target, scale, pull = (each.double().to(device) for each in images(1, 3, 33, 20))
    compared, in_levels = MeanSquares(target, scale, pull), torch.tensor(weights, dtype=torch.float64, device=device)
    for canvas in (first, first - 0.5, first):  # a GPU records the second, and replays the third
        fast, plain = (canvas.clone().requires_grad_() for _ in range(2))
        loss, expected = compared(fast, weights), compared.plain(plain, in_levels)
        (3 * loss).backward()
        (3 * expected).backward()
        assert fast.grad is not None
        assert torch.equal(loss, expected)
        assert torch.allclose(fast.grad, plain.grad, rtol=1e-12, atol=0)


def test_what_was_found_for_one_canvas_stays_when_others_are_compared(device: torch.device) -> None:
    first, target, scale, _ = (each.double().to(device) for each in images(5, 3, 18, 16))
    compared, weights = MeanSquares(target, scale), (1.0, 2.0, 2.0, 4.0)
    canvases = [(first + shift).requires_grad_() for shift in range(4)]
    losses = [compared(canvas, [weight]) for canvas, weight in zip(canvases, weights, strict=True)]
    for canvas, loss, weight in zip(canvases, losses, weights, strict=True):
        plain = canvas.detach().requires_grad_()
        expected = compared.plain(plain, torch.tensor([weight], dtype=torch.float64, device=device))
        expected.backward()
        loss.backward()
        assert torch.equal(loss, expected)
        assert torch.equal(canvas.grad, plain.grad)


@pytest.mark.parametrize("precision", [torch.float32, torch.float64])
def test_a_target_is_freed_with_what_compares_it(precision: torch.dtype) -> None:
    canvas, target, scale, _ = (each.to(precision) for each in images(6, 3, 18, 16))
    compared, known = MeanSquares(target, scale), weakref.ref(target)
    compared(canvas.requires_grad_(), [1.0]).backward()
    gc.disable()
    try:
        del compared, target
        assert known() is None
    finally:
        gc.enable()


def test_the_same_difference_has_the_same_slope_to_the_bit() -> None:
    slopes = []
    for _ in range(2):
        canvas, target, scale, pull = images(2, 3, 65, 48)
        MeanSquares(target, scale, pull)(canvas.requires_grad_(), [1.0, 2.0, 4.0]).backward()
        slopes.append(canvas.grad)
    assert torch.equal(*slopes)


def test_any_number_of_threads_gives_the_same_to_the_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    found = []
    for threads in (1, 2, 5):
        monkeypatch.setattr(pyramid, "THREADS", threads)
        canvas, target, scale, pull = images(4, 3, 363, 365)  # large enough to be shared out
        loss = MeanSquares(target, scale, pull)(canvas.requires_grad_(), [1.0, 2.0, 4.0])
        loss.backward()
        found.append((loss.item(), canvas.grad))
    for value, slope in found[1:]:
        assert value == found[0][0]
        assert torch.equal(slope, found[0][1])


def test_the_coarsest_level_is_some_16_pixels_high() -> None:
    image = torch.zeros(3, 256, 300)
    assert 8 < 256 / 2 ** (levels_of(image) - 1) <= 32
    assert levels_of(torch.zeros(3, 1, 1)) == 1
