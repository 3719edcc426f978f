"""Trajectories and marks by the fast way beside the plain one: values, and all slopes."""

from collections.abc import Callable

import pytest
import torch
from torch import Tensor

from maulstick.painting.brush import Brush
from maulstick.rendering.laying import extents, laid, plain_extents, plain_laid
from maulstick.rendering.traj2stroke import Marks, Traj2Stroke
from tests.support.nominal import nominal
from tests.support.tolerances import FLOAT32_GRADIENT

ROUNDING = 2e-6  # relative to the largest number, of float32

Given = tuple[Tensor, ...]


def rng(seed: int = 0) -> torch.Generator:
    return torch.Generator().manual_seed(seed)


def strokes(count: int, points: int) -> Given:
    """Paths, centres, angles and pressure, float64."""
    sizes = (count, points, 2), (count, 2), (count,), (count, points)
    paths, centres, angles, pressure = (torch.randn(*size, generator=rng(), dtype=torch.float64) for size in sizes)
    return paths, centres, 4 * angles, pressure.sigmoid()


def brushes() -> list[Brush]:
    light = nominal("round").model_copy(update={"faint": 0.3, "solid": 0.5, "m_x": 1.1, "b_y": 0.001})
    return [light, nominal("marker"), nominal("fineliner"), light]


def outcome(of: Callable[..., Given], given: Given) -> tuple[Given, Given]:
    """What comes of it, and the slopes of a sum of it with respect to all that is given."""
    leaves = [each.clone().requires_grad_() for each in given]
    found = of(*leaves)
    signals = [torch.randn(each.shape, generator=rng(1), dtype=torch.float64) for each in found]
    sum((each.double() * signal).sum() for each, signal in zip(found, signals, strict=True)).backward()
    return found, tuple(leaf.grad for leaf in leaves)  # type: ignore[misc]


def are_near(fast: Given, plain: Given, share: float) -> bool:
    pairs = zip(fast, plain, strict=True)
    return all(bool((one.double() - other).abs().max() <= share * other.abs().max()) for one, other in pairs)


@pytest.mark.parametrize(("count", "points"), [(1, 1), (5, 2), (40, 32)])
def test_trajectories_and_their_slopes_are_those_of_the_plain_way(count: int, points: int) -> None:
    given = strokes(count, points)
    single = tuple(each.float() for each in given)
    fast, slopes = outcome(lambda *all_of: (laid(*all_of),), single)
    plain, expected = outcome(lambda *all_of: (plain_laid(*all_of),), tuple(each.double() for each in single))
    assert fast[0].dtype == torch.float32
    assert are_near(fast, plain, ROUNDING)
    if points == 1:  # turning a dot about its middle moves nothing
        slopes, expected = slopes[1:2] + slopes[3:], expected[1:2] + expected[3:]
    assert are_near(slopes, expected, FLOAT32_GRADIENT)


@pytest.mark.parametrize("pressure", ["any", "light", "full", "none"])
def test_marks_and_their_slopes_are_those_of_the_plain_way(pressure: str) -> None:
    paths, _, _, pressures = strokes(4, 32)
    times = {"any": 1.0, "light": 0.1, "full": 0.0, "none": 0.0}[pressure]
    given = torch.cat([paths, (times * pressures + (pressure == "full"))[..., None]], dim=-1).float()
    both = Traj2Stroke.of(brushes())
    in_double = Traj2Stroke(**{name: tensor.double() for name, tensor in vars(Traj2Stroke.of(brushes())).items()})

    def parts(marks: Marks) -> Given:
        return marks.points, marks.thickness, marks.opacity

    fast, slopes = outcome(lambda trajectories: parts(both.marks(trajectories, 1600.0)), (given,))
    plain, expected = outcome(lambda trajectories: parts(in_double.marks(trajectories, 1600.0)), (given.double(),))
    assert fast[0].grad_fn is not None
    assert "Marks" in fast[0].grad_fn.name()
    assert are_near(fast, plain, ROUNDING)
    assert are_near(slopes, expected, FLOAT32_GRADIENT)
    assert are_near(slopes, outcome(lambda t: parts(both.plain_marks(t, 1600.0)), (given,))[1], FLOAT32_GRADIENT)


@pytest.mark.parametrize("more", [{"lag": 0.001}, {"nib": (0.3, 0.0)}, {"touch": (0.001, 0.0)}])
def test_a_brush_that_trails_or_is_broader_one_way_marks_plainly(more: dict[str, object]) -> None:
    each = [nominal("marker").model_copy(update=more)] * 3
    trajectories = torch.rand(3, 32, 3, generator=rng())
    marks, plain = (getattr(Traj2Stroke.of(each), name)(trajectories, 1600.0) for name in ("marks", "plain_marks"))
    assert torch.equal(marks.points, plain.points)
    assert torch.equal(marks.thickness, plain.thickness)


def test_extents_are_those_of_the_plain_way() -> None:
    trajectories = torch.randn(30, 32, 3, generator=rng())
    for fast, plain in zip(extents(trajectories), plain_extents(trajectories), strict=True):
        assert torch.equal(fast, plain)
