"""Strokes that are moved on the way of a plan, in a hand of two kinds of strokes, lines and circles."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import Tensor

from maulstick.planning.initialise import Initialiser
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.problem import PlannerSettings, PlanningProblem
from maulstick.planning.regions import Region, Regions
from maulstick.storage.arrays import Floats
from maulstick.storage.arrays import Image as Picture
from maulstick.style import Style
from maulstick.style.exemplar import Exemplar
from maulstick.style.traits import path_length
from tests.planning.conftest import options, problem_for
from tests.support.nominal import nominal
from tests.support.style.synthetic_hands import all_hands, circle, drawn, hand_of, line

INK, PAINTS = options(paints=None), options(paints=4)
EACH = 20  # strokes of each kind; the hand draws them in turns


def hand() -> Exemplar:
    """The hand: a line, a circle, a line and so on, beside one another."""
    paths = np.stack([drawn(one, EACH) for one in (line, circle)], axis=1).reshape(2 * EACH, 32, 2)
    poses = np.array([(0.01 * (i % 8), 0.01 * (i // 8), 0) for i in range(len(paths))])
    return Exemplar("both", replace(hand_of(paths), poses=poses), all_hands(), 0.0)


HAND = hand()


@pytest.fixture(scope="module")
def problem(portrait: Picture) -> PlanningProblem:
    return replace(problem_for(portrait, nominal("fineliner"), halftone=True), style=HAND)


def initialiser(problem: PlanningProblem, settings: PlannerSettings, *, arranged: bool) -> Initialiser:
    return Initialiser(problem, settings, arranged, np.random.default_rng(0), torch.Generator().manual_seed(0))


def density(problem: PlanningProblem) -> Floats:
    return np.ones(problem.weights.shape)


def of_kind(strokes: StrokeParameters, *, circles: bool) -> StrokeParameters:
    return strokes[are_circles(HAND, strokes) == circles]


def are_circles(style: Style, strokes: StrokeParameters) -> Tensor:
    paths = style.decode(strokes.codes)
    return (paths[:, -1] - paths[:, 0]).norm(dim=1) < 0.8 * path_length(paths)


@pytest.mark.parametrize("arranged", [True, False], ids=["arranged", "each alone"])
@pytest.mark.parametrize("circles", [True, False], ids=["circles", "lines"])
def test_in_one_ink_strokes_that_are_moved_are_of_the_kind_they_were(
    problem: PlanningProblem, circles: bool, arranged: bool
) -> None:
    new = initialiser(problem, INK, arranged=arranged)
    old = of_kind(new.strokes(problem.paper, density(problem), 60)[0], circles=circles)
    (moved,) = new.moved(old, problem.paper, problem.paper, density(problem), 0.01)
    assert len(moved) == len(old) > 15
    assert (are_circles(HAND, moved) == circles).all()
    assert not torch.equal(moved.codes, old.codes)


def test_in_paints_strokes_that_are_moved_are_of_any_kind(problem: PlanningProblem) -> None:
    new = initialiser(problem, PAINTS, arranged=False)
    old = of_kind(new.strokes(problem.paper, density(problem), 60)[0], circles=True)
    (moved,) = new.moved(old, problem.paper, problem.paper, density(problem), 0.01)
    assert 0.2 < are_circles(HAND, moved).float().mean() < 0.8


def test_in_paints_fine_detail_is_mended_by_narrower_strokes_than_a_broad_patch(problem: PlanningProblem) -> None:
    broad = replace(problem, brushes=(nominal("marker"),))
    old = initialiser(broad, PAINTS, arranged=False).strokes(broad.paper, density(broad), 20)[0]
    rows, columns = np.indices(problem.weights.shape)
    squares = torch.from_numpy((rows // 2 + columns // 2) % 2).to(broad.paper) - 0.5
    (narrow,), (wide,) = (
        initialiser(broad, PAINTS, arranged=False).moved(old, broad.paper, canvas, density(broad), 1.0)
        for canvas in (broad.paper + squares, broad.paper - 0.5)
    )
    assert torch.equal(narrow.centres, wide.centres)
    assert narrow.pressure_knots.mean() < 0.8 * wide.pressure_knots.mean()


def test_strokes_are_moved_with_each_brush_to_the_same_places(problem: PlanningProblem) -> None:
    two = replace(problem, brushes=(nominal("fineliner"), nominal("marker")))
    new = initialiser(two, PAINTS, arranged=False)
    old = new.strokes(two.paper, density(two), 20)[0]
    one, other = new.moved(old, two.paper, two.paper, density(two), 0.01)
    assert torch.equal(one.centres, other.centres)
    assert [one.brush_of.unique().tolist(), other.brush_of.unique().tolist()] == [[0], [1]]


@pytest.mark.parametrize("arranged", [True, False], ids=["arranged", "each alone"])
def test_strokes_that_are_moved_in_regions_are_of_the_kind_they_were(
    problem: PlanningProblem, *, arranged: bool
) -> None:
    labels = np.zeros(problem.weights.shape, dtype=np.int64)
    labels[:, labels.shape[1] // 2 :] = 1
    said = (Region("rest", HAND, (True,)), Region("right", HAND, (True,)))
    regions = Regions(labels, said, problem.canvas)
    both = replace(problem, regions=regions, style=regions.style)
    new = initialiser(both, INK, arranged=arranged)
    strokes = new.strokes(both.paper, density(both), 60)[0]
    old = strokes[are_circles(regions.style, strokes)]
    for rows, there in new.by_pool(torch.arange(len(old)), old, torch.zeros(len(old)), density(both)[None]):
        (moved,) = new.moved(old[rows], both.paper, both.paper, there, 0.01)
        assert len(moved) == len(rows) > 5
        assert are_circles(regions.style, moved).all()


@pytest.mark.parametrize("arranged", [True, False], ids=["arranged", "each alone"])
def test_a_region_where_nothing_is_wanted_keeps_its_share_of_strokes_and_those_that_are_moved(
    problem: PlanningProblem, *, arranged: bool
) -> None:
    labels = np.zeros(problem.weights.shape, dtype=np.int64)
    labels[: labels.shape[0] // 2] = 1
    labels[:, : labels.shape[1] // 4] = 2
    said = (
        Region("rest", HAND, (True,)),
        Region("sky", HAND, (True,), share=0.5),
        Region("edge", HAND, (True,), bare=True),
    )
    regions = Regions(labels, said, problem.canvas)
    parted = replace(problem, regions=regions, style=regions.style)
    new, wanted = initialiser(parted, INK, arranged=arranged), density(parted) * (labels == 0)
    strokes = new.strokes(parted.paper, wanted, 60)[0]
    assert regions.style.regions_of(strokes.codes).bincount(minlength=3).tolist() == [30, 30, 0]
    own = strokes[regions.style.regions_of(strokes.codes) == 1]
    ((rows, there),) = new.by_pool(torch.arange(len(own)), own, torch.zeros(len(own)), wanted[None])
    (moved,) = new.moved(own[rows], parted.paper, parted.paper, there, 0.01)
    assert (regions.style.regions_of(moved.codes) == 1).all()


def test_without_a_picture_strokes_that_complete_others_are_of_all_brushes(problem: PlanningProblem) -> None:
    two = replace(problem, target=None, brushes=(nominal("marker"), nominal("fineliner")))
    new = initialiser(two, PAINTS, arranged=False)
    broad = new.first()[0][torch.arange(PAINTS.strokes - 8)]
    broad.brush_of.fill_(0)
    completed = new.completed(broad, 0)
    assert len(completed) == PAINTS.strokes
    assert completed.brush_of[-8:].unique().tolist() == [0, 1]
    assert not torch.equal(completed.centres[-8:], broad.centres[:8])
