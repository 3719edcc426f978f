"""First strokes of a hand in ink: along the picture's lines, and in groups, or each alone, elsewhere."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from maulstick.planning.initialise import Initialiser
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.problem import PlannerSettings, PlanningProblem
from maulstick.planning.regions import Region, Regions
from maulstick.storage.arrays import Floats
from maulstick.storage.arrays import Image as Picture
from tests.planning.conftest import options, problem_for
from tests.planning.test_arranged_plan import HAND
from tests.support.nominal import nominal

SIDE, RADIUS = 96, 30  # pixels
INK = options(paints=None, strokes=60)
BLACK, RED = (0.0, 0.0, 0.0), (0.8, 0.15, 0.1)


def ring(inside: float = 0.6) -> Picture:
    """A black ring around a grey, on white."""
    y, x = np.indices((SIDE, SIDE)) + 0.5
    away = np.hypot(x - SIDE / 2, y - SIDE / 2)
    grey = np.where(np.abs(away - RADIUS) < 1, 0.0, np.where(away < RADIUS, inside, 1.0))
    return np.repeat(grey[..., None], 3, axis=2).astype(np.float32)


def of(picture: Picture, *, contours: bool = True) -> PlanningProblem:
    return replace(problem_for(picture, nominal("fineliner"), halftone=True), style=HAND, contours=contours)


def first(problem: PlanningProblem, settings: PlannerSettings = INK, *, arranged: bool = True) -> StrokeParameters:
    rng, torch_rng = np.random.default_rng(0), torch.Generator().manual_seed(0)
    return Initialiser(problem, settings, arranged, rng, torch_rng).first()[0]


def places(strokes: StrokeParameters, problem: PlanningProblem) -> Floats:
    """All points of the strokes, (N, n, 2), pixels from the middle."""
    paths = strokes.trajectories(HAND)[..., :2].detach().double().numpy()
    found: Floats = paths * problem.canvas.pixels_per_metre - SIDE / 2
    return found


def on_the_ring(strokes: StrokeParameters, problem: PlanningProblem) -> float:
    """How much of the ring strokes lie along that are on it in all their points, from 0 to 1."""
    found = places(strokes, problem)
    x, y = found[(np.abs(np.linalg.norm(found, axis=-1) - RADIUS) < 2.5).all(axis=1)].reshape(-1, 2).T
    return len(np.unique(np.arctan2(y, x) // (np.pi / 36))) / 72


def test_strokes_follow_the_lines_of_a_picture_and_fewer_do_without_contours() -> None:
    problem = of(ring())
    found = first(problem)
    assert len(found) == INK.strokes
    assert on_the_ring(found, problem) > 0.9
    assert on_the_ring(first(replace(problem, contours=False)), problem) < 0.6


def test_strokes_that_are_placed_alone_follow_lines_too() -> None:
    problem, few = of(ring()), replace(INK, strokes=20)
    found, without = (first(each, few, arranged=False) for each in (problem, replace(problem, contours=False)))
    assert on_the_ring(found, problem) > 0.9
    assert on_the_ring(without, problem) < 0.5


def test_strokes_follow_light_lines_in_white_ink_on_black() -> None:
    problem = of(1 - ring())
    night = replace(problem, paper=torch.zeros_like(problem.paper))
    assert on_the_ring(first(night, replace(INK, palette=((1.0, 1.0, 1.0),))), night) > 0.9


def test_a_line_is_followed_in_the_ink_that_it_is_drawn_in() -> None:
    picture = np.where(ring() == np.float32(0.6), np.array([0.9, 0.5, 0.5], dtype=np.float32), ring())
    problem = of(picture)
    strokes = first(problem, replace(INK, palette=(BLACK, RED)))
    black = (strokes.colours == torch.tensor(BLACK)).all(dim=1)
    assert on_the_ring(strokes[black], problem) > 0.7
    assert on_the_ring(strokes[~black], problem) < 0.4


def test_no_stroke_follows_a_line_on_bare_paper() -> None:
    problem = of(ring())
    labels = np.repeat(np.arange(2), SIDE // 2)[None].repeat(SIDE, axis=0)
    regions = Regions(
        labels, (Region("left", HAND, (True,)), Region("right", HAND, (True,), bare=True)), problem.canvas
    )
    strokes = first(replace(problem, style=regions.style, regions=regions))
    middles = strokes.centres[:, 0] * problem.canvas.pixels_per_metre
    assert (middles < SIDE / 2 + 1).all()
    assert len(middles) == INK.strokes


@pytest.mark.parametrize("arranged", [True, False], ids=["arranged", "each alone"])
@pytest.mark.parametrize("strokes", [1, 2, 7])
def test_few_strokes_are_exactly_so_many(strokes: int, *, arranged: bool) -> None:
    assert len(first(of(ring()), replace(INK, strokes=strokes), arranged=arranged)) == strokes


@pytest.mark.parametrize("arranged", [True, False], ids=["arranged", "each alone"])
def test_a_blank_picture_has_as_many_strokes_as_any(*, arranged: bool) -> None:
    blank = of(np.ones((SIDE, SIDE, 3), dtype=np.float32))
    assert len(first(blank, arranged=arranged)) == INK.strokes
