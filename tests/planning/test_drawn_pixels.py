from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import Tensor
from torch.nn.functional import avg_pool2d

from maulstick.painting.brush import Brush
from maulstick.painting.metrics import PlanMetrics, psnr
from maulstick.painting.painting import Painting, Sheet
from maulstick.planning import drawn_pixels
from maulstick.planning.drawn_pixels import FINE, coarsest, finest, to_canvas, to_drawn
from maulstick.planning.from_picture import as_painting, metrics_of, problem_of, provenance_of
from maulstick.planning.layout import Layout, lay_out_for
from maulstick.planning.losses import LossOptions
from maulstick.planning.objectives import Edges
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings, PlanningProblem, Weighted
from maulstick.planning.result import PlanProgress
from maulstick.planning.schedule import Schedule
from maulstick.planning.state import State
from maulstick.planning.stroke_canvas import StrokeCanvas
from maulstick.planning.stroke_effects import TargetView
from maulstick.rendering.preview import preview
from maulstick.storage.arrays import Image as Picture
from maulstick.style import load_style
from tests.planning.conftest import mse, options, problem_for
from tests.support.nominal import nominal
from tests.support.planning.network_losses import Shifted
from tests.support.tolerances import FLOAT32_VALUE

FEW = PlannerSettings(strokes=4, paints=4)
SIZES = (3, 15, 21), (3, 5, 7), (5, 7)  # of a canvas on fine pixels, and of a picture and its weights
APART = 0.03  # metres: so far apart lie four strokes on the canvas of the tests


@pytest.fixture(scope="module", autouse=True)
def small_canvases_are_drawn_coarsely() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(drawn_pixels, "_FEWEST", 4)
        yield


@pytest.fixture(scope="module")
def problem(portrait: Picture, round_brush: Brush) -> PlanningProblem:
    return problem_for(portrait[:47, :59], round_brush)


@pytest.fixture(scope="module")
def planned(problem: PlanningProblem) -> list[PlanProgress]:
    """Progress after every step of a plan."""
    steps: list[PlanProgress] = []

    def watch(progress: PlanProgress) -> bool:
        steps.append(progress)
        return True

    plan(problem, options(strokes=12, steps=20), watch)
    return steps


def in_squares(image: Tensor, side: int) -> bool:
    """Return whether all pixels of each square of an image (C, H, W) are the same."""
    return torch.equal(to_canvas(image[:, ::side, ::side], side, image), image)


def side_of(image: Tensor) -> int:
    """Return the side in pixels of the largest squares that an image (C, H, W) is made of."""
    return next(side for side in range(12, 0, -1) if in_squares(image, side))


@pytest.mark.parametrize("side", [2, 3])
def test_slopes_of_squares_are_those_of_repeated_pixels(side: int) -> None:
    coarse = torch.rand((2, 3, 4), dtype=torch.float64, requires_grad=True)
    canvas = torch.rand((2, 3 * side - 1, 4 * side), dtype=torch.float64)
    assert torch.autograd.gradcheck(lambda drawn: to_canvas(drawn, side, canvas), coarse)
    repeated = coarse.repeat_interleave(side, 1).repeat_interleave(side, 2)[:, : canvas.shape[1]]
    slopes = [
        torch.autograd.grad((drawn * canvas).sum(), coarse)[0] for drawn in (to_canvas(coarse, side, canvas), repeated)
    ]
    assert torch.allclose(*slopes)


def test_a_canvas_on_coarse_pixels_is_nearly_the_average_of_the_fine_one(problem: PlanningProblem) -> None:
    strokes = plan(problem, options(strokes=12, steps=10)).strokes
    with torch.no_grad():
        fine, coarse = (StrokeCanvas(strokes, problem).render(side=side) for side in (1, 3))
    assert coarse.shape == fine.shape
    assert in_squares(coarse, 3)
    averaged = to_canvas(to_drawn(fine, 3), 3, fine)
    assert mse(coarse, averaged) < 0.02 * mse(averaged, problem.paper)


def test_beside_a_picture_squares_have_the_slope_of_coarse_pixels_beside_a_coarse_picture() -> None:
    picture = torch.rand(3, 12, 9, generator=torch.Generator().manual_seed(0))
    coarse = torch.full((3, 4, 3), 0.5, requires_grad=True)
    slopes = [
        torch.autograd.grad((image - other).square().mean(), coarse)[0]
        for image, other in ((to_canvas(coarse, 3, picture), picture), (coarse, avg_pool2d(picture, 3)))
    ]
    assert torch.allclose(slopes[0], slopes[1], atol=FLOAT32_VALUE)


def test_squares_are_a_third_of_the_room_of_a_stroke_and_no_broader_than_a_mark(problem: PlanningProblem) -> None:
    scale, pen = problem.canvas.pixels_per_metre, nominal("fineliner")
    assert coarsest(problem, FEW, APART) == round(min(APART / 3, 2 * problem.brushes[0].widest) * scale) > 1
    assert coarsest(replace(problem, brushes=(pen,)), FEW, APART) == max(1, round(2 * pen.widest * scale))
    assert coarsest(problem, FEW, APART / 100) == 1


def test_a_picture_keeps_a_hundred_coarse_pixels_over_its_shorter_side(
    problem: PlanningProblem, monkeypatch: pytest.MonkeyPatch
) -> None:
    wide = coarsest(problem, FEW, APART)
    monkeypatch.setattr(drawn_pixels, "_FEWEST", 100)
    assert coarsest(problem, FEW, APART) == 1
    for short, side in ((199, 1), (200, 2), (299, 2), (100 * wide + 99, wide), (200 * wide, wide)):
        for size in ((short, 300 * wide), (300 * wide, short)):
            assert coarsest(replace(problem, paper=torch.ones(1, *size)), FEW, APART) == side


def test_one_ink_edges_and_what_networks_see_are_drawn_on_the_canvas_own_pixels(problem: PlanningProblem) -> None:
    assert problem.target is not None
    assert coarsest(problem, replace(FEW, paints=None), APART) == 1
    edges = Weighted(Edges(problem.target, problem.weights), 0.01)
    assert coarsest(replace(problem, objectives=(*problem.objectives, edges)), FEW, APART) == 1
    assert coarsest(replace(problem, network_losses=(Weighted(Shifted(problem.target), 1.0),)), FEW, APART) == 1


def test_a_plan_is_drawn_on_coarse_pixels_at_first_and_then_on_half_as_large_ones(
    problem: PlanningProblem, planned: list[PlanProgress]
) -> None:
    first, *_ = sides = [side_of(step.canvas) for step in planned]
    assert first >= 4
    assert sides == [first if step.done < 0.3 else first // 2 if step.done < 0.5 else 1 for step in planned]
    assert {step.canvas.shape for step in planned} == {problem.paper.shape}


def test_fine_pixels_are_averaged_over_those_of_the_canvas() -> None:
    picture = torch.rand(3, 5, 7, generator=torch.Generator().manual_seed(0))
    fine = to_drawn(picture, FINE)
    assert fine.shape == (3, 15, 21)
    assert torch.allclose(to_canvas(fine, FINE, picture), picture, atol=FLOAT32_VALUE)
    fine[:, ::3, ::3] += 0.9
    assert torch.allclose(to_canvas(fine, FINE, picture), picture + 0.1, atol=FLOAT32_VALUE)


def test_a_view_of_fine_pixels_sees_what_the_canvas_shows_of_them() -> None:
    fine, target, weights = (torch.rand(size, generator=torch.Generator().manual_seed(0)) for size in SIZES)
    view = TargetView(target, weights)
    seen, wanted = view.drawn(FINE).difference(fine), view.difference(to_canvas(fine, FINE, target))
    assert torch.allclose(seen, wanted, atol=FLOAT32_VALUE)


def test_a_canvas_is_misjudged_where_fine_pixels_are_nearer_or_farther_by_a_fifth_of_a_decibel() -> None:
    black = torch.zeros(3, 39, 59)
    seen = torch.full((3, 39, 59), 0.1)
    for decibels, told in ((0.19, 1), (0.21, FINE)):
        other = seen * 10 ** (decibels / 20)
        assert finest(black, {1: seen, FINE: other}.__getitem__) == told
        assert finest(black, {1: other, FINE: seen}.__getitem__) == told
    assert finest(black, lambda side: black) == 1
    assert finest(None, {}.__getitem__) == 1
    assert finest(torch.zeros(3, 512, 520), {}.__getitem__) == 1


@pytest.fixture(scope="module")
def square() -> Layout:
    """A black square, on a sheet of 8 cm."""
    picture = np.ones((64, 64, 3), dtype=np.float32)
    picture[12:52, 12:52] = 0
    return lay_out_for(picture, Sheet(width=0.08, height=0.08), nominal("round"), height_px=64)


def painted(layout: Layout, *, fine: float) -> Painting:
    """Return a plan whose last steps, from the share `fine` on, may be drawn on fine pixels."""
    settings, brush, style = options(strokes=80, steps=200), nominal("round"), load_style("free", layout.canvas)
    problem = problem_of(layout, (brush,), style, settings, LossOptions())
    planned = plan(problem, settings, schedule=Schedule(fine=fine))
    return as_painting(planned, layout, (brush,), style, provenance_of(settings))


def seen(painting: Painting, layout: Layout) -> PlanMetrics:
    metrics = metrics_of(painting, layout)
    assert metrics is not None
    return metrics


def test_hard_edges_end_on_fine_pixels_which_show_them_as_they_will_be(square: Layout) -> None:
    painting = painted(square, fine=0.9)
    fine, own = seen(painting, square), seen(painted(square, fine=1.0), square)
    assert fine.psnr > own.psnr + 1
    assert square.target is not None
    on_own_pixels = psnr(preview(painting, square.canvas), square.target)
    assert abs(fine.psnr_planned - fine.psnr) < 0.5 * abs(on_own_pixels - fine.psnr)


def test_a_photograph_is_drawn_on_the_canvas_own_pixels_to_the_end(problem: PlanningProblem) -> None:
    plans = [plan(problem, options(strokes=12, steps=40), schedule=Schedule(fine=fine)) for fine in (1.0, 0.9)]
    assert torch.equal(plans[0].strokes.centres, plans[1].strokes.centres)


def test_a_plan_on_fine_pixels_goes_on_as_it_was_interrupted(square: Layout) -> None:
    settings, brush, style = options(strokes=40, steps=100), nominal("round"), load_style("free", square.canvas)
    problem = problem_of(square, (brush,), style, settings, LossOptions())
    states: list[State] = []

    def watch(progress: PlanProgress) -> bool:
        if progress.done > 0.94:
            states.append(progress.state())
        return True

    whole = plan(problem, settings, watch)
    assert states[0]["finest"] == FINE
    resumed = plan(problem, settings, resume=states[0])
    assert torch.equal(whole.strokes.centres, resumed.strokes.centres)


def test_a_plan_that_is_to_end_is_drawn_finely_at_once(problem: PlanningProblem) -> None:
    sides: list[int] = []

    def watch(progress: PlanProgress) -> bool:
        sides.append(side_of(progress.canvas))
        return len(sides) < 3

    plan(problem, options(strokes=12), watch)
    assert sides[2] > 1
    assert sides[3] == 1
