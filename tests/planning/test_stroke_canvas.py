from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import Tensor

from maulstick.painting.brush import Brush
from maulstick.painting.raster import Canvas
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.problem import Neighbours, PlanningProblem
from maulstick.planning.stroke_canvas import StrokeCanvas
from maulstick.rendering.traj2stroke import Traj2Stroke, paint
from maulstick.style import load_style
from tests.support.tolerances import FLOAT32_VALUE

CANVAS = Canvas(0.06, 0.04, 1000)
STYLE = load_style("free", CANVAS)
LIGHT, MIDDLE, DARK = (0.9, 0.8, 0.7), (0.5, 0.4, 0.6), (0.1, 0.0, 0.2)


def strokes(colours: list[tuple[float, float, float]], seed: int) -> StrokeParameters:
    """Strokes in the middle of the canvas, where all lie on top of each other."""
    torch_rng = torch.Generator().manual_seed(seed)
    codes, knots = STYLE.sample_for(torch.full((len(colours),), 0.02), torch_rng)
    centres = torch.tensor([0.03, 0.02]) + 0.004 * torch.rand(len(colours), 2, generator=torch_rng)
    angles, brush_of = torch.arange(float(len(colours))), torch.zeros(len(colours), dtype=torch.long)
    return StrokeParameters(codes, centres, angles, knots, torch.tensor(colours), brush_of)


@pytest.fixture
def theirs() -> Neighbours:
    both = strokes([MIDDLE, DARK], 1)
    return Neighbours(both.trajectories(STYLE), both.colours, both.brush_of)


def among(neighbours: Neighbours, brush: Brush) -> PlanningProblem:
    """The problem of painting with this brush, among neighbours, on white paper."""
    paper = torch.ones(3, 40, 60)
    return PlanningProblem(None, paper, paper[0], CANVAS, (brush,), STYLE, (), neighbours=neighbours)


@pytest.fixture
def stroke_canvas(theirs: Neighbours, round_brush: Brush) -> StrokeCanvas:
    own = strokes([DARK, LIGHT], 0)
    return StrokeCanvas(own, among(theirs, round_brush))


def painted(trajectories: list[Tensor], colours: list[tuple[float, float, float]], brush: Brush) -> Tensor:
    """Return white paper with these strokes painted one after the other."""
    brushes = Traj2Stroke.of([brush] * len(colours))
    return paint(torch.ones(3, 40, 60), torch.stack(trajectories), torch.tensor(colours), brushes, 1000)


def test_neighbours_are_painted_where_their_lightness_puts_them(
    stroke_canvas: StrokeCanvas, theirs: Neighbours, round_brush: Brush
) -> None:
    dark, light = stroke_canvas.strokes.trajectories(STYLE)
    middle, other_dark = theirs.trajectories
    stroke_canvas.sort()
    assert stroke_canvas.order.tolist() == [1, 0]
    expected = painted([light, middle, dark, other_dark], [LIGHT, MIDDLE, DARK, DARK], round_brush)
    assert torch.allclose(stroke_canvas.render(), expected, atol=FLOAT32_VALUE)
    fewer = painted([light, middle, other_dark], [LIGHT, MIDDLE, DARK], round_brush)
    assert torch.allclose(stroke_canvas.render(np.array([False, True])), fewer, atol=FLOAT32_VALUE)
    assert (expected - fewer).abs().max() > 0.05


def test_neighbours_stand_with_the_paint_that_is_nearest_to_theirs(
    stroke_canvas: StrokeCanvas, theirs: Neighbours, round_brush: Brush
) -> None:
    paints = torch.tensor([LIGHT, (0.5, 0.4, 0.5), DARK])
    stroke_canvas.quantise(paints.flip(0), grouped=True)
    dark, light = stroke_canvas.strokes.trajectories(STYLE)
    middle, other_dark = theirs.trajectories
    assert stroke_canvas.order.tolist() == [0, 1]
    expected = painted([dark, other_dark, middle, light], [DARK, DARK, MIDDLE, LIGHT], round_brush)
    assert torch.allclose(stroke_canvas.render(), expected, atol=FLOAT32_VALUE)


def test_what_is_given_in_painting_order_comes_back_for_the_strokes_alone(stroke_canvas: StrokeCanvas) -> None:
    stroke_canvas.sort()
    marks, colours = stroke_canvas.drawn()
    assert len(marks.points) == len(colours) == 4
    assert torch.equal(stroke_canvas.by_row(colours), torch.tensor([DARK, LIGHT]))


def test_nothing_pulls_at_neighbours(round_brush: Brush, theirs: Neighbours) -> None:
    own = strokes([DARK, LIGHT], 0)
    moved = StrokeParameters(**{name: x.requires_grad_(x.is_floating_point()) for name, x in own.each().items()})
    there = replace(theirs, trajectories=theirs.trajectories.requires_grad_())
    stroke_canvas = StrokeCanvas(moved, among(there, round_brush))
    stroke_canvas.render().square().mean().backward()
    assert moved.centres.grad is not None
    assert moved.centres.grad.abs().min() > 0
    assert not there.trajectories.grad.any()


def test_going_on_from_a_state_paints_neighbours_in_the_same_place(
    stroke_canvas: StrokeCanvas, theirs: Neighbours, round_brush: Brush
) -> None:
    stroke_canvas.sort()
    again = StrokeCanvas(strokes([LIGHT, LIGHT], 2), among(theirs, round_brush))
    again.restore(stroke_canvas.state())
    assert torch.equal(again.render(), stroke_canvas.render())
