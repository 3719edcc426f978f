"""Strokes that lie far across the lights of a picture are left out."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import Tensor

from maulstick.planning.initialise import Initialiser
from maulstick.planning.lights import across_lights
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlanningProblem
from maulstick.planning.result import PlanResult
from maulstick.storage.arrays import Bools, Floats
from maulstick.storage.arrays import Image as Picture
from tests.planning.conftest import options, problem_for
from tests.planning.test_arranged_plan import HAND
from tests.support.nominal import nominal

SIDE, SPACING = 120, 10.0  # pixels
BLACK = ((0.0, 0.0, 0.0),)
INK = options(paints=None, strokes=60, steps=2)


def picture(light: float = 1.0, dark: float = 0.2) -> Picture:
    """Two darks, left and right, with a light forty pixels broad between them."""
    grey = np.full((SIDE, SIDE, 3), dark, dtype=np.float32)
    grey[:, 40:80] = light
    return grey


def as_tensor(image: Picture) -> Tensor:
    return torch.from_numpy(image).permute(2, 0, 1)


def level(start: float, end: float, y: float = 60.0) -> Floats:
    """A stroke from the left to the right."""
    return np.stack([np.linspace(start, end, 32), np.full(32, y)], axis=1)


def found(*strokes: Floats, image: Picture | None = None, paper: Tensor | None = None, among: int = 100) -> Bools:
    """Which of the strokes are found among so many in the darks."""
    rest = [level(5, 35, y) for y in np.linspace(2, SIDE - 2, among - len(strokes))]
    target = as_tensor(picture() if image is None else image)
    bare = torch.ones_like(target) if paper is None else paper
    across = across_lights(np.stack([*strokes, *rest]), target, bare, BLACK, SPACING)
    assert not across[len(strokes) :].any()
    return across[: len(strokes)]


def test_a_stroke_from_dark_to_dark_across_a_light_is_found_and_a_short_way_into_it_is_not() -> None:
    assert found(level(20, 100)).all()
    assert not found(level(20, 62)).any()
    assert not found(level(45, 55)).any(), "a short stroke in a light is a detail"


def test_a_stroke_along_a_line_in_a_light_is_drawn_and_one_beside_it_is_not() -> None:
    image = picture()
    image[58:60, 40:80] = 0
    assert not found(level(20, 100, 59.5), image=image).any()
    assert found(level(20, 100, 64), image=image).all()


def test_what_is_pale_beside_pale_darks_is_no_light() -> None:
    assert not found(level(20, 100), image=picture(light=0.97, dark=0.9)).any()
    assert found(level(20, 100), image=picture(light=1.0, dark=0.9)).all()


@pytest.mark.parametrize("value", [0.0, 0.5, 1.0])
def test_a_picture_of_one_tone_has_no_lights(value: float) -> None:
    image = np.full((SIDE, SIDE, 3), value, dtype=np.float32)
    assert not found(level(20, 100), image=image).any()


def test_where_many_lie_across_lights_those_that_do_so_farthest_are_found() -> None:
    ends = [85.0, 90.0, 95.0, 118.0]
    many = [level(45 - 10 * i, end - 10 * i, 10 + 20 * i) for i, end in enumerate(ends)]
    short = [level(52 + i, 79, 12 + 20 * i) for i in range(3)]
    across = found(*many, *short, among=200)
    assert across.tolist() == [True] * 4 + [False] * 3
    assert found(*many, *short, among=100).sum() == 2


def test_nothing_is_left_out_of_what_is_drawn_over_a_drawing() -> None:
    paper = torch.ones(3, SIDE, SIDE)
    paper[:, 60:62, 50:60] = 0.4
    assert not found(level(20, 100), paper=paper).any()


@pytest.fixture(scope="module")
def problem() -> PlanningProblem:
    return replace(problem_for(picture(), nominal("fineliner"), halftone=True), style=HAND)


def with_one_across(problem: PlanningProblem) -> StrokeParameters:
    """As many strokes as are planned, of which the first goes from dark to dark."""
    rng, torch_rng = np.random.default_rng(0), torch.Generator().manual_seed(0)
    start = Initialiser(problem, INK, False, rng, torch_rng).first()[0]
    scale = problem.canvas.pixels_per_metre
    start.codes[:1] = HAND.encode(torch.from_numpy(level(-40, 40, 0)[None] / scale)).float()
    start.centres[0] = torch.tensor([60.0, 60.0]) / scale
    start.angles[0] = 0
    return start


def across(planned: PlanResult, problem: PlanningProblem) -> int:
    """How many strokes go from the left dark to the right one."""
    x = planned.strokes.trajectories(HAND)[..., 0].detach().numpy() * problem.canvas.pixels_per_metre
    return int(((x.min(axis=1) < 35) & (x.max(axis=1) > 85)).sum())


def test_a_plan_in_ink_leaves_such_strokes_out_unless_the_number_is_to_be_exact(problem: PlanningProblem) -> None:
    start = with_one_across(problem)
    exact = plan(problem, replace(INK, exact=True), start=start)
    assert (len(exact.strokes), across(exact, problem)) == (INK.strokes, 1)
    assert across(plan(problem, INK, start=start), problem) == 0


def test_a_plan_without_lights_keeps_them(problem: PlanningProblem) -> None:
    dark = replace(problem_for(picture(light=0.2), nominal("fineliner"), halftone=True), style=HAND)
    assert across(plan(dark, INK, start=with_one_across(problem)), problem) == 1
