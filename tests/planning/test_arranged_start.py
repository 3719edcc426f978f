"""First strokes of a hand in ink: along the picture's lines, and in groups, or each alone, elsewhere."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from maulstick.planning.guides import Guides
from maulstick.planning.initialise import Initialiser
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.problem import PlannerSettings, PlanningProblem
from maulstick.planning.regions import Region, Regions
from maulstick.storage.arrays import Floats
from maulstick.storage.arrays import Image as Picture
from maulstick.style.exemplar import Exemplar
from maulstick.style.hand import Hand
from tests.planning.conftest import options, problem_for
from tests.planning.test_arranged_plan import HAND
from tests.support.drawn import as_strokes
from tests.support.nominal import nominal
from tests.support.style.synthetic_hands import all_hands

SIDE, RADIUS = 96, 30  # pixels
INK = options(paints=None, strokes=60)
BLACK, RED = (0.0, 0.0, 0.0), (0.8, 0.15, 0.1)


def ring(inside: float = 0.6) -> Picture:
    """A black ring around a grey, on white."""
    y, x = np.indices((SIDE, SIDE)) + 0.5
    away = np.hypot(x - SIDE / 2, y - SIDE / 2)
    grey = np.where(np.abs(away - RADIUS) < 1, 0.0, np.where(away < RADIUS, inside, 1.0))
    return np.repeat(grey[..., None], 3, axis=2).astype(np.float32)


def of(picture: Picture) -> PlanningProblem:
    """A picture whose lines are what is black."""
    dark = (picture.max(axis=2) < 0.1).astype(np.float32)
    return replace(problem_for(picture, nominal("fineliner"), halftone=True), style=HAND, lines=lambda: dark)


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


def test_strokes_follow_the_lines_of_a_picture_and_fewer_do_without_lines_to_follow() -> None:
    problem = of(ring())
    found = first(problem)
    assert len(found) == INK.strokes
    assert on_the_ring(found, problem) > 0.9
    assert on_the_ring(first(replace(problem, lines=None)), problem) < 0.6


def liner(step: float) -> Exemplar:
    """A hand of ten lines of six strokes, each of which begins so many strokes' lengths after the one before."""
    length = 12 / of(ring()).canvas.pixels_per_metre
    along = step * np.arange(6)[:, None] + np.linspace(0, 1, 32)
    lines = [np.stack([along, np.full_like(along, 2 * row)], axis=-1) for row in range(10)]
    return Exemplar("liner", Hand.of(as_strokes(length * np.concatenate(lines))), all_hands(), 0.0)


def test_a_line_is_drawn_in_as_many_strokes_as_lie_on_so_much_of_the_hands_lines() -> None:
    def on_lines(step: float) -> int:
        style = liner(step)
        problem = replace(of(ring()), style=style)
        paths = first(problem).trajectories(style)[..., :2].detach().double().numpy()
        away = np.linalg.norm(paths * problem.canvas.pixels_per_metre - SIDE / 2, axis=-1)
        return int((np.abs(away - RADIUS) < 2.5).all(axis=1).sum())

    end_to_end = on_lines(1.0)
    assert end_to_end == pytest.approx(2 * np.pi * RADIUS / 12, rel=0.25)
    assert on_lines(0.6) > 1.4 * end_to_end
    assert on_lines(1.3) < 0.9 * end_to_end


def test_strokes_that_are_placed_alone_follow_lines_too() -> None:
    problem, few = of(ring()), replace(INK, strokes=20)
    found, without = (first(each, few, arranged=False) for each in (problem, replace(problem, lines=None)))
    assert on_the_ring(found, problem) > 0.9
    assert on_the_ring(without, problem) < 0.5


def test_a_line_is_followed_in_the_ink_that_most_of_it_is_drawn_in() -> None:
    black, red = (np.array(each, dtype=np.float32) for each in (BLACK, RED))
    picture = np.where(ring() == 0, 0.7 * black + 0.3 * red, np.where(ring() == 1, 1, 0.3 * red + 0.7))
    problem = replace(of(picture), lines=of(ring()).lines)
    strokes = first(problem, replace(INK, palette=(BLACK, RED), strokes=120))
    drawn = (strokes.colours == torch.tensor(BLACK)).all(dim=1)
    assert on_the_ring(strokes[drawn], problem) > 0.7
    assert on_the_ring(strokes[~drawn], problem) < 0.8


def test_no_line_is_followed_where_no_ink_is_wanted_nor_from_one_region_into_another() -> None:
    problem = of(ring())
    labels = np.repeat(np.arange(2), SIDE // 2)[None].repeat(SIDE, axis=0)
    said = (Region("left", HAND, (True,)), Region("right", HAND, (True,), bare=True))
    regions = Regions(labels, said, problem.canvas)
    middles = first(replace(problem, style=regions.style, regions=regions)).centres[:, 0]
    assert (middles * problem.canvas.pixels_per_metre < SIDE / 2 + 1).all()
    assert len(middles) == INK.strokes
    blank = replace(of(np.ones((SIDE, SIDE, 3), dtype=np.float32)), lines=problem.lines)
    blank.target[:, :, : SIDE // 2] = problem.target[:, :, : SIDE // 2]
    assert (places(first(blank), problem)[..., 0] < 8).mean() > 0.9


def test_strokes_on_lines_are_as_long_as_they_were_laid_though_their_shapes_vary() -> None:
    problem = replace(of(ring()), style=replace(HAND, freedom=1.0))
    found = first(problem)
    assert on_the_ring(found, problem) > 0.9


def test_lines_that_go_against_guides_are_not_followed() -> None:
    problem = of(ring())
    across = [np.array([[0, y], [problem.canvas.width, y]]) for y in np.linspace(0, problem.canvas.height, 9)]
    strokes = first(replace(problem, guides=Guides.of(problem.canvas, across)))
    found = places(strokes, problem)
    along = np.abs(np.diff(found[:, [0, -1]], axis=1)[:, 0])
    assert (along[:, 1] > along[:, 0]).mean() < 0.05
    assert on_the_ring(strokes, problem) < 0.5


@pytest.mark.parametrize("arranged", [True, False], ids=["arranged", "each alone"])
@pytest.mark.parametrize("strokes", [1, 2, 7])
def test_few_strokes_are_exactly_so_many(strokes: int, *, arranged: bool) -> None:
    assert len(first(of(ring()), replace(INK, strokes=strokes), arranged=arranged)) == strokes


@pytest.mark.parametrize("arranged", [True, False], ids=["arranged", "each alone"])
def test_a_blank_picture_has_as_many_strokes_as_any(*, arranged: bool) -> None:
    blank = of(np.ones((SIDE, SIDE, 3), dtype=np.float32))
    assert len(first(blank, arranged=arranged)) == INK.strokes
