from collections.abc import Iterator
from dataclasses import replace

import pytest
import torch
from torch import Tensor
from torch.nn.functional import avg_pool2d

from maulstick.painting.brush import Brush
from maulstick.planning import coarse
from maulstick.planning.coarse import coarser, coarsest, finer
from maulstick.planning.objectives import Edges
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings, PlanningProblem, Weighted
from maulstick.planning.result import PlanProgress
from maulstick.planning.stroke_canvas import StrokeCanvas
from maulstick.storage.arrays import Image as Picture
from tests.planning.conftest import mse, options, problem_for
from tests.support.nominal import nominal
from tests.support.planning.network_losses import Shifted
from tests.support.tolerances import FLOAT32_VALUE

FEW = PlannerSettings(strokes=4, paints=4)
APART = 0.03  # metres: so far apart lie four strokes on the canvas of the tests


@pytest.fixture(scope="module", autouse=True)
def small_canvases_count_as_large() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(coarse, "_LARGE", 40)
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
    return torch.equal(finer(image[:, ::side, ::side], side, image), image)


def side_of(image: Tensor) -> int:
    """Return the side in pixels of the largest squares that an image (C, H, W) is made of."""
    return next(side for side in range(12, 0, -1) if in_squares(image, side))


def test_a_canvas_on_coarse_pixels_is_nearly_the_average_of_the_fine_one(problem: PlanningProblem) -> None:
    strokes = plan(problem, options(strokes=12, steps=10)).strokes
    with torch.no_grad():
        fine, coarse = (StrokeCanvas(strokes, problem).render(side=side) for side in (1, 3))
    assert coarse.shape == fine.shape
    assert in_squares(coarse, 3)
    averaged = finer(coarser(fine, 3), 3, fine)
    assert mse(coarse, averaged) < 0.02 * mse(averaged, problem.paper)


def test_beside_a_picture_squares_have_the_slope_of_coarse_pixels_beside_a_coarse_picture() -> None:
    picture = torch.rand(3, 12, 9, generator=torch.Generator().manual_seed(0))
    coarse = torch.full((3, 4, 3), 0.5, requires_grad=True)
    slopes = [
        torch.autograd.grad((image - other).square().mean(), coarse)[0]
        for image, other in ((finer(coarse, 3, picture), picture), (coarse, avg_pool2d(picture, 3)))
    ]
    assert torch.allclose(slopes[0], slopes[1], atol=FLOAT32_VALUE)


def test_squares_are_a_third_of_the_room_of_a_stroke_and_no_broader_than_a_mark(problem: PlanningProblem) -> None:
    scale, pen = problem.canvas.pixels_per_metre, nominal("fineliner")
    assert coarsest(problem, FEW, APART) == round(min(APART / 3, 2 * problem.brushes[0].widest) * scale) > 1
    assert coarsest(replace(problem, brushes=(pen,)), FEW, APART) == max(1, round(2 * pen.widest * scale))
    assert coarsest(problem, FEW, APART / 100) == 1


def test_a_small_canvas_one_ink_edges_and_what_networks_see_are_drawn_on_the_canvas_own_pixels(
    problem: PlanningProblem,
) -> None:
    assert problem.target is not None
    small = replace(problem, paper=problem.paper[:, :39])
    assert coarsest(small, FEW, APART) == 1
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


def test_a_plan_that_is_to_end_is_drawn_finely_at_once(problem: PlanningProblem) -> None:
    sides: list[int] = []

    def watch(progress: PlanProgress) -> bool:
        sides.append(side_of(progress.canvas))
        return len(sides) < 3

    plan(problem, options(strokes=12), watch)
    assert sides[2] > 1
    assert sides[3] == 1
