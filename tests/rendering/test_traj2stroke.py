import math
from collections.abc import Iterator, Sequence
from dataclasses import fields

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from torch import Tensor

from maulstick.painting.brush import Brush
from maulstick.rendering.laying import place
from maulstick.rendering.traj2stroke import Marks, Traj2Stroke, paint
from maulstick.strokes import strokes
from tests.support.nominal import nominal
from tests.support.tolerances import FLOAT32_METRES, FLOAT64_METRES, INK

NAMES = ("fineliner", "marker", "round")
MARKER = nominal("marker")
BENT = Brush(
    name="bent",
    source="a test",
    m_x=1.1,
    m_y=0.9,
    b_x=0.002,
    b_y=-0.001,
    alpha=0.004,
    beta=0.001,
    falloff=1.5,
    plateau=0.1,
)
REED = BENT.model_copy(  # with every number that goes beyond the paper
    update={
        "name": "reed",
        "curve": (0.05, 0.1, 0.15, 0.5, 0.7, 0.9, 0.95),
        "nib": (0.3, -0.2),
        "lag": 0.004,
        "touch": (0.001, -0.002),
        "faint": 0.4,
        "solid": 0.7,
    }
)
BEYOND = {"curve", "nib", "lag", "touch", "faint", "solid"}
CONE = MARKER.model_copy(update={"name": "cone", "plateau": 0.0})
HOLLOW = CONE.model_copy(update={"name": "hollow", "falloff": 2.5})
PIXELS = 1e-4  # of a coordinate or thickness in float32, some hundreds of pixels

trajectories = st.tuples(st.integers(1, 4), st.integers(1, 6)).flatmap(
    lambda shape: arrays(np.float64, (*shape, 3), elements=st.floats(0, 1, width=32))
)


def brushes(*each: Brush) -> Traj2Stroke:
    return Traj2Stroke.of(each)


def line(length: float, pressure: float, centre: tuple[float, float], angle: float, bend: float = 0.0) -> Tensor:
    """A stroke (1, 32, 3) of even pressure about a centre, metres, turned; it changes direction by `bend`."""
    t = np.linspace(-0.5, 0.5, 32)
    path = np.stack([t, np.zeros(32)], axis=1) * length
    if bend:
        path = np.stack([np.sin(bend * t), 1 - np.cos(bend * t)], axis=1) * length / bend
    turned = strokes.place(path[None], np.array([[*centre, angle]]))
    return torch.from_numpy(np.concatenate([turned, np.full((1, 32, 1), pressure)], axis=2)).float()


def darkness(brush: Brush, trajectory: Tensor, height: int, width: int, pixels_per_metre: float) -> Tensor:
    """How dark white ink makes a black canvas, (H, W)."""
    black, white = torch.zeros(1, height, width), torch.ones(1, 1)
    return paint(black, trajectory, white, brushes(brush), pixels_per_metre)[0]


def ink(brush: Brush, trajectory: Tensor, height: int, width: int, pixels_per_metre: float) -> float:
    """Ink of a stroke in mm²."""
    drawn = darkness(brush, trajectory, height, width, pixels_per_metre)
    return 1e6 * drawn.sum(dtype=torch.float64).item() / pixels_per_metre**2


def ink_of_a_line(brush: Brush, length: float, pressure: float) -> float:
    """What the darkness of docs/equations.md adds up to over a straight stroke, mm²: along its sides and two caps."""
    h, c, q = brush.alpha * pressure + brush.beta, brush.falloff, brush.plateau
    across = q + (1 - q) / (c + 1)
    around = q**2 / 2 + (1 - q) / (c + 1) - (1 - q) ** 2 / (c + 2)
    return 1e6 * brush.opacity * (2 * length * h * across + 2 * math.pi * h**2 * around)


def places(px: int, count: int, side: float) -> Iterator[tuple[tuple[float, float], float]]:
    """Centres within a pixel about the middle of the sheet, and angles: along rows, columns, diagonals and others."""
    rng = np.random.default_rng(px)
    for i in range(count):
        angle = (0, math.pi / 2, math.pi / 4, rng.uniform(0, 2 * math.pi))[i % 4]
        shift = rng.uniform(-0.5, 0.5, 2) if i % 3 else rng.integers(0, 4, 2) / 4
        x, y = side / 2 + shift * side / px
        yield (float(x), float(y)), angle


def test_placing_agrees_with_that_of_strokes_and_has_gradients() -> None:
    rng = np.random.default_rng(0)
    paths, poses = rng.uniform(-0.1, 0.1, (7, 32, 2)), rng.uniform(-3, 3, (7, 3))
    expected = strokes.place(paths, poses)
    exact = place(torch.from_numpy(paths), torch.from_numpy(poses))
    assert exact.numpy() == pytest.approx(expected, abs=FLOAT64_METRES)
    rounded = place(torch.from_numpy(paths).float(), torch.from_numpy(poses).float())
    assert rounded.numpy() == pytest.approx(expected, abs=10 * FLOAT32_METRES), "places of up to 3 m"
    two = [torch.from_numpy(x[:2]).requires_grad_() for x in (paths[:, :3], poses)]
    assert torch.autograd.gradcheck(place, two)


def test_a_mark_lies_where_the_design_says() -> None:
    # Standardised (0.02, 0.01) turned by 90 degrees is (-0.01, 0.02); then m, b and the place: docs/equations.md.
    path = torch.tensor([[[0.0, 0.0], [0.02, 0.01]]])
    placed = place(path, torch.tensor([[0.1, 0.05, math.pi / 2]]))
    commanded = torch.cat([placed, torch.full((1, 2, 1), 0.25)], dim=2)
    marks = brushes(BENT).marks(commanded, 1000)
    first = (1000 * (0.1 + 0.002), 1000 * (0.05 - 0.001))
    second = (1000 * (1.1 * -0.01 + 0.1 + 0.002), 1000 * (0.9 * 0.02 + 0.05 - 0.001))
    assert marks.points.numpy() == pytest.approx(np.array([[first, second]]), abs=PIXELS)


@given(trajectories, st.floats(10, 1000))
def test_marks_lie_where_the_brush_says_that_it_marks(commanded: np.ndarray, pixels_per_metre: float) -> None:
    each = [REED, MARKER, CONE, BENT][: len(commanded)]
    marks = brushes(*each).marks(torch.from_numpy(commanded).float(), pixels_per_metre)
    for brush, points, path in zip(each, marks.points, commanded, strict=True):
        expected = brush.mark(path)[:, :2] * pixels_per_metre
        assert points.numpy() == pytest.approx(expected, abs=10 * FLOAT32_METRES * pixels_per_metre)


@given(pressure=arrays(np.float64, (1, 5), elements=st.floats(0, 1)))
def test_half_widths_are_those_of_the_brush_on_average_over_all_directions(pressure: np.ndarray) -> None:
    angles = np.linspace(0, math.pi, 36, endpoint=False)
    along = np.linspace(0, 0.02, 5)
    paths = np.stack([np.outer(np.cos(angles), along), np.outer(np.sin(angles), along)], axis=2)
    commanded = np.concatenate([paths, np.repeat(pressure, 36, axis=0)[..., None]], axis=2)
    straight = REED.model_copy(update={"lag": 0.0, "touch": (0.0, 0.0), "m_x": 1.0, "m_y": 1.0})
    marks = brushes(*[straight] * 36).marks(torch.from_numpy(commanded), 1.0)
    assert marks.thickness.mean(dim=0).numpy() == pytest.approx(straight.half_width(pressure[0]), rel=1e-5)
    assert marks.thickness[0].numpy() == pytest.approx(1.3 * straight.half_width(pressure[0]), rel=1e-5)


def test_a_tip_that_is_dragged_follows_the_hand_at_its_lag_and_forgets_where_it_came_down() -> None:
    along = np.linspace(0, 0.1, 3000)
    path = np.stack([along, np.zeros(3000)], axis=1)
    dragged = REED.model_copy(update={"m_x": 1.0, "m_y": 1.0, "b_x": 0.0, "b_y": 0.0}).mark(path)
    assert dragged[0] == pytest.approx((0.001, -0.002)), "where it touches"
    assert dragged[-1] == pytest.approx((0.1 - 0.004, 0.0), abs=1e-9), "a lag behind"
    slope = np.gradient(dragged, along, axis=0)[1:-1]  # d tip / d s = (commanded - tip) / lag
    assert slope == pytest.approx((path - dragged)[1:-1] / 0.004, abs=1e-4)


def test_where_the_hand_rests_a_dragged_tip_has_the_slopes_of_double_precision() -> None:
    """Differences of two tips that nearly agree would lose the single's digits there."""
    commanded = torch.rand(4, 24, 3, generator=torch.Generator().manual_seed(0))
    commanded[:, 5] = commanded[:, 4]
    weights = torch.rand(4, 24, 2, generator=torch.Generator().manual_seed(1))

    def slopes(number: torch.dtype) -> Tensor:
        each = brushes(*[REED.model_copy(update={"nib": (0.0, 0.0)})] * 4)
        numbers = {field.name: getattr(each, field.name).to(number) for field in fields(Traj2Stroke)}
        path = commanded.to(number).requires_grad_()
        points = Traj2Stroke(**numbers).marks(path, 1.0).points
        return torch.autograd.grad((points * weights).sum(), path)[0]

    assert slopes(torch.float32).double().numpy() == pytest.approx(slopes(torch.float64).numpy(), rel=1e-4, abs=1e-4)


def test_a_lighter_stroke_is_fainter_until_the_pressure_that_is_solid() -> None:
    opacities = [
        brushes(REED).marks(line(0.02, pressure, (0, 0), 0), 1.0).opacity.item() for pressure in (0.0, 0.35, 0.7, 1.0)
    ]
    assert opacities == pytest.approx([0.4, 0.7, 1.0, 1.0], rel=1e-5)


@given(pressure=arrays(np.float32, (2, 5), elements=st.floats(0, 1, width=32)))
def test_thickness_is_a_line_in_pressure_and_no_number_changes(
    pressure: np.ndarray,
) -> None:
    commanded = torch.cat([torch.zeros(2, 5, 2), torch.from_numpy(pressure)[..., None]], dim=2)
    marks = brushes(BENT, MARKER).marks(commanded, 20_000)
    expected = np.stack([0.004 * pressure[0] + 0.001, 0.0008 * pressure[1] + 0.0007]) * 20_000
    assert marks.thickness.numpy() == pytest.approx(expected, rel=1e-5)
    numbers = torch.stack([marks.falloff, marks.plateau, marks.opacity])
    assert torch.equal(numbers, torch.tensor([[1.5, 1.0], [0.1, 0.6], [1.0, 0.95]]))


@pytest.mark.parametrize("name", NAMES)
def test_a_mark_has_the_numbers_of_its_brush_at_every_resolution(name: str) -> None:
    brush = nominal(name)
    for pixels_per_metre in np.geomspace(100, 50_000, 10):
        marks = brushes(brush).marks(line(0.05, 0.6, (0.1, 0.1), 0.0), float(pixels_per_metre))
        half_width = (0.6 * brush.alpha + brush.beta) * pixels_per_metre
        assert marks.thickness.numpy() == pytest.approx(half_width, rel=1e-5)
        numbers = (marks.falloff.item(), marks.plateau.item(), marks.opacity.item())
        assert numbers == pytest.approx((brush.falloff, brush.plateau, brush.opacity))


@pytest.mark.parametrize(
    ("brush", "side"),
    [
        (nominal("fineliner"), 0.038),
        (MARKER, 0.160),
        (nominal("round"), 0.160),
        (CONE, 0.160),
        (HOLLOW, 0.160),
    ],
    ids=lambda value: value.name if isinstance(value, Brush) else "",
)
@pytest.mark.parametrize("pressure", [0.0, 0.4, 1.0])
def test_ink_is_what_the_brush_leaves_at_every_resolution_place_and_angle(
    brush: Brush, side: float, pressure: float
) -> None:
    assert brush.thinnest * 256 / side >= 1, "the thinnest half-width is at least a pixel"
    length = 0.3 * side
    expected = ink_of_a_line(brush, length, pressure)
    for px, count in ((256, 80), (400, 40), (600, 40), (1024, 20)):
        for centre, angle in places(px, count, side):
            found = ink(brush, line(length, pressure, centre, angle), px, px, px / side)
            assert found == pytest.approx(expected, rel=INK), f"{px} px, at {centre}, angle {angle}"


@pytest.mark.parametrize(("name", "side"), [("fineliner", 0.038), ("marker", 0.160), ("round", 0.160)])
@pytest.mark.parametrize("pressure", [0.0, 1.0])
def test_a_bent_stroke_has_the_same_ink_at_every_resolution_place_and_angle(
    name: str, side: float, pressure: float
) -> None:
    brush = nominal(name)
    finest = ink(brush, line(0.3 * side, pressure, (side / 2, side / 2), 0.2, bend=2.0), 1024, 1024, 1024 / side)
    assert finest == pytest.approx(ink_of_a_line(brush, 0.3 * side, pressure), rel=INK), (
        "outside gains what inside loses"
    )
    for px in (256, 512):
        for centre, angle in places(px, 40, side):
            found = ink(brush, line(0.3 * side, pressure, centre, angle, bend=2.0), px, px, px / side)
            assert found == pytest.approx(finest, rel=INK)


@pytest.mark.parametrize(("name", "side"), [("marker", 0.160), ("round", 0.160)])
def test_a_stroke_of_rising_pressure_has_the_same_ink_at_every_resolution(name: str, side: float) -> None:
    brush = nominal(name)
    rising = line(0.3 * side, 0.0, (side / 2, side / 2), 0.5)
    rising[..., 2] = torch.linspace(0, 1, 32)
    amounts = [ink(brush, rising, px, px, px / side) for px in (256, 400, 600, 1024)]
    assert amounts == pytest.approx([amounts[-1]] * 4, rel=INK)


@settings(max_examples=40, deadline=None)
@given(
    name=st.sampled_from(["marker", "round"]),
    pressure=st.floats(0, 1),
    shift=st.tuples(st.floats(0, 1), st.floats(0, 1)),
    angle=st.floats(0, 2 * math.pi),
)
def test_no_place_on_the_grid_gains_ink(name: str, pressure: float, shift: tuple[float, float], angle: float) -> None:
    brush, side, px = nominal(name), 0.160, 256
    centre = (side / 2 + shift[0] * side / px, side / 2 + shift[1] * side / px)
    found = ink(brush, line(0.3 * side, pressure, centre, angle), px, px, px / side)
    assert found == pytest.approx(ink_of_a_line(brush, 0.3 * side, pressure), rel=INK)


@pytest.mark.parametrize(("height", "width"), [(64, 64), (64, 600), (600, 64), (61, 67)])
@pytest.mark.parametrize("brush", [MARKER, BENT], ids=["marker", "bent"])
def test_a_stroke_is_drawn_alike_on_canvases_of_every_shape(brush: Brush, height: int, width: int) -> None:
    trajectory = line(0.02, 0.5, (0.02, 0.015), 0.7)
    square = darkness(brush, trajectory, 64, 64, 1600)
    drawn = darkness(brush, trajectory, height, width, 1600)
    rows, columns = min(height, 64), min(width, 64)
    assert torch.equal(drawn[:rows, :columns], square[:rows, :columns])
    assert drawn.sum().item() == pytest.approx(square[:rows, :columns].sum().item(), rel=1e-6), "nothing beyond"
    assert square.sum() > 50


@pytest.mark.parametrize("name", NAMES)
def test_a_stroke_turned_by_a_right_angle_is_drawn_turned(name: str) -> None:
    lying, upright = (
        darkness(nominal(name), line(0.02, 0.5, (0.02, 0.02), angle, bend=1.0), 64, 64, 1600)
        for angle in (0, math.pi / 2)
    )
    assert torch.allclose(torch.rot90(lying, -1), upright, atol=1e-3)
    assert not torch.allclose(lying, upright, atol=0.1)


def _gradients(each: Sequence[Brush], commanded: Tensor, pixels_per_metre: float) -> tuple[Tensor, ...]:
    commanded = commanded.requires_grad_()
    parts = [getattr(Traj2Stroke.of(each), field.name).requires_grad_() for field in fields(Traj2Stroke)]
    marks: Marks = Traj2Stroke(*parts).marks(commanded, pixels_per_metre)
    total = sum(x.square().sum() for x in (marks.points, marks.thickness, marks.falloff, marks.plateau, marks.opacity))
    return torch.autograd.grad(total, [commanded, *parts])


@pytest.mark.parametrize("pixels_per_metre", [5.0, 300.0, 1600.0, 30_000.0])
def test_gradients_of_marks_are_finite(pixels_per_metre: float) -> None:
    dry = Brush(name="dry", source="a test", alpha=0.002, beta=-0.001)
    each = [nominal("fineliner"), MARKER, nominal("round"), REED, HOLLOW, BENT, dry, dry]
    commanded = torch.rand(len(each), 32, 3, generator=torch.Generator().manual_seed(0))
    commanded[-1, :, 2] = 0.0  # leaves no mark at all
    commanded[1, :, :2] = 0.1  # stands still
    for gradient in _gradients(each, commanded, pixels_per_metre):
        assert gradient.isfinite().all()


@pytest.mark.parametrize("pixels_per_metre", [400.0, 1600.0, 30_000.0])
def test_gradients_of_marks_are_those_of_finite_differences(pixels_per_metre: float) -> None:
    commanded = torch.rand(1, 4, 3, generator=torch.Generator().manual_seed(0), dtype=torch.float64)
    each = Traj2Stroke.of([MARKER.model_copy(update=REED.model_dump(include=BEYOND))])
    parts = {field.name: getattr(each, field.name).double() for field in fields(Traj2Stroke)}
    wanted = ["scale", "shift", "curve", "nib", "lag", "touch", "faint", "solid"]

    def marks(trajectory: Tensor, *numbers: Tensor) -> tuple[Tensor, ...]:
        drawn = Traj2Stroke(**{**parts, **dict(zip(wanted, numbers, strict=True))}).marks(trajectory, pixels_per_metre)
        return drawn.points, drawn.thickness, drawn.plateau, drawn.opacity

    inputs = [x.requires_grad_() for x in (commanded, *(parts[name] for name in wanted))]
    assert torch.autograd.gradcheck(marks, inputs, eps=1e-7, rtol=1e-4)


def test_the_ink_of_a_stroke_grows_with_its_pressure_for_the_optimiser_too() -> None:
    for pixels_per_metre in (600.0, 1600.0, 6400.0):
        trajectory = line(0.02, 0.5, (0.02, 0.02), 0.4).requires_grad_()
        px = int(0.04 * pixels_per_metre)
        drawn = darkness(MARKER, trajectory, px, px, pixels_per_metre)
        (gradient,) = torch.autograd.grad(drawn.sum() / pixels_per_metre**2, trajectory)
        expected = (ink_of_a_line(MARKER, 0.02, 0.51) - ink_of_a_line(MARKER, 0.02, 0.49)) / 0.02 * 1e-6
        assert gradient[..., 2].sum().item() == pytest.approx(expected, rel=0.1)


def test_no_strokes_leave_the_canvas_as_it_is() -> None:
    canvas = torch.rand(3, 5, 7, generator=torch.Generator().manual_seed(0))
    painted = paint(canvas, torch.zeros(0, 32, 3), torch.zeros(0, 3), brushes(), 1000)
    assert torch.equal(painted, canvas)


def test_every_stroke_takes_its_own_brush_and_colour() -> None:
    trajectory = torch.cat([line(0.05, 1.0, (0.04, y), 0.0) for y in (0.0205, 0.0605)])
    colours = torch.tensor([[1.0, 0, 0], [0, 0, 1.0]])
    canvas = paint(torch.zeros(3, 80, 80), trajectory, colours, brushes(nominal("round"), MARKER), 1000)
    assert canvas[:, 20, 40].tolist() == pytest.approx([1, 0, 0], abs=1e-6)
    assert canvas[:, 60, 40].tolist() == pytest.approx([0, 0, 0.95], abs=1e-6)
    assert (canvas[0] > 0.5).sum() > 3 * (canvas[2] > 0.5).sum()
    assert torch.equal(canvas[1], torch.zeros(80, 80))


def test_marks_of_few_points_are_evened_within_their_longest_step_and_others_stay() -> None:
    points = torch.tensor([[[0, 0], [1, 0], [5, 4], [6, 4], [6, 4], [6, 4]], [[k, 0] for k in range(6)]]).float()
    thickness = torch.tensor([[1, 2, 5, 6, 6, 6], [1, 2, 3, 4, 5, 6]]).float()
    evened = Marks(points, thickness, *torch.ones(3, 2)).evened(torch.tensor([4, 6]))
    divided = torch.tensor([[0, 0], [1, 0], [1 + 4 / 3, 4 / 3], [1 + 8 / 3, 8 / 3], [5, 4], [6, 4]])
    torch.testing.assert_close(evened.points, torch.stack([divided, points[1]]))
    torch.testing.assert_close(evened.thickness, torch.tensor([[1.0, 2, 3, 4, 5, 6], [1, 2, 3, 4, 5, 6]]))


def test_opacity_can_be_that_of_another_mean_pressure_than_of_the_points() -> None:
    pale, light = nominal("round").model_copy(update={"faint": 0.4, "solid": 0.5}), line(0.01, 0.1, (0.0, 0.0), 0.0)
    assert brushes(pale).marks(light, 1000).opacity.item() == pytest.approx(pale.opacity * (0.4 + 0.6 * 0.2))
    deep = brushes(pale).at_mean_pressure(torch.tensor([0.25])).marks(light, 1000)
    assert deep.opacity.item() == pytest.approx(pale.opacity * (0.4 + 0.6 * 0.5))
