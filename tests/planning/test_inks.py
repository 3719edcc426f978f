"""Plans in several inks: each stroke is drawn with one of them, where the picture has its colour."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import Tensor

from maulstick.planning.arranging import Arranging
from maulstick.planning.initialise import Initialiser
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings, PlanningProblem
from maulstick.planning.regions import Region, Regions
from maulstick.planning.result import PlanResult
from maulstick.planning.schedule import REPLAN
from maulstick.planning.stroke_effects import TargetView
from maulstick.style.regional import RegionalStyle
from tests.planning.conftest import options, problem_for, state_after
from tests.planning.test_arranged_plan import HAND, unplaced
from tests.support.nominal import nominal
from tests.support.planning.same import same

DARK, RED, BLUE = (0.05, 0.05, 0.1), (0.8, 0.15, 0.1), (0.1, 0.3, 0.75)
INKS = options(paints=None, palette=(DARK, RED, BLUE), strokes=60, steps=40)
LIGHT_FIRST = [pytest.approx(ink) for ink in (RED, BLUE, DARK)]


def halves(*colours: tuple[float, float, float]) -> PlanningProblem:
    """A picture of upright bands of these colours, as wide as each other."""
    picture = np.repeat(np.array(colours, dtype=np.float32), 48 // len(colours), axis=0)
    picture = np.broadcast_to(picture, (40, 48, 3)).copy()
    return replace(problem_for(picture, nominal("fineliner"), halftone=True), style=HAND)


@pytest.fixture(scope="module")
def problem() -> PlanningProblem:
    return halves((0.9, 0.6, 0.55), (0.6, 0.7, 0.9))


@pytest.fixture(scope="module")
def planned(problem: PlanningProblem) -> PlanResult:
    return plan(problem, INKS)


def middles(found: PlanResult, ink: tuple[float, float, float]) -> Tensor:
    """Where the strokes of an ink lie across the sheet, from 0 to 1."""
    own = found.paint_of == [tuple(paint) for paint in found.paints.tolist()].index(tuple(torch.tensor(ink).tolist()))
    x = found.strokes.trajectories(HAND)[own][..., 0].mean(dim=1)
    return x / found.strokes.trajectories(HAND)[..., 0].max()


@pytest.mark.parametrize("arrange", [1.0, 0.0], ids=["arranged", "each alone"])
def test_inks_are_drawn_as_they_are_from_light_to_dark_each_where_the_picture_has_its_colour(
    problem: PlanningProblem, arrange: float
) -> None:
    found = plan(problem, replace(INKS, arrange=arrange))
    assert found.paints.tolist() == LIGHT_FIRST
    assert (found.paint_of.diff() >= 0).all(), "pen by pen"
    red, blue = middles(found, RED), middles(found, BLUE)
    assert min(len(red), len(blue)) > 10
    assert (red < 0.6).float().mean() > 0.8
    assert (blue > 0.4).float().mean() > 0.8


def test_strokes_lie_by_groups_of_the_hand_ink_by_ink(problem: PlanningProblem, planned: PlanResult) -> None:
    alone = plan(problem, replace(INKS, arrange=0.0))
    prices = []
    for found in (planned, alone):
        price = Arranging(problem, found.strokes, found.paint_of, 0.01, 1.0)
        prices.append(float(price.price(found.strokes, torch.Generator().manual_seed(0))))
    assert prices[0] < 0.7 * prices[1]


def test_a_picture_in_the_tones_of_one_of_the_inks_is_drawn_in_that_alone() -> None:
    found = plan(halves((0.81, 0.81, 0.82), (0.43, 0.43, 0.46)), INKS)
    assert [found.paints[number].tolist() for number in found.paint_of.unique().tolist()] == [pytest.approx(DARK)]


def test_the_order_of_a_palette_of_inks_changes_nothing(problem: PlanningProblem, planned: PlanResult) -> None:
    assert same(plan(problem, replace(INKS, palette=(BLUE, DARK, RED))), planned)


@pytest.mark.parametrize("steps", [1, 19, 39])
def test_a_plan_in_inks_goes_on_as_if_it_had_not_stopped(
    problem: PlanningProblem, planned: PlanResult, steps: int
) -> None:
    assert same(plan(problem, INKS, resume=state_after(problem, INKS, steps)), planned)


def test_strokes_that_are_planned_again_keep_their_inks_and_new_ones_take_those_that_are_missing(
    problem: PlanningProblem, planned: PlanResult
) -> None:
    own = replace(planned.strokes, colours=planned.paints[planned.paint_of])
    red = planned.paints.tolist().index(torch.tensor(RED).tolist())
    kept = own[planned.paint_of != red]
    again = plan(problem, replace(INKS, exact=True), schedule=REPLAN, start=kept)
    assert again.paints.tolist() == LIGHT_FIRST
    counts = [each.paint_of.bincount(minlength=3) for each in (planned, again)]
    assert (counts[1] >= counts[0] - (torch.arange(3) == red) * counts[0]).all()
    assert counts[1][red] > 0.5 * counts[0][red]


def test_strokes_that_are_moved_keep_their_ink_and_go_where_it_is_missing(problem: PlanningProblem) -> None:
    new = initialiser(problem, INKS)
    target = problem.target
    assert target is not None
    missing = new.missing(TargetView(target, problem.weights), problem.paper)
    half = target.shape[2] // 2
    assert missing[0, :, :half].sum() > 4 * missing[0, :, half:].sum(), "red"
    assert missing[1, :, half:].sum() > 4 * missing[1, :, :half].sum(), "blue"
    strokes, _ = new.first()
    paint_of = torch.tensor([new.palette.index(ink) for ink in map(nearest, strokes.colours.tolist())])
    rows = torch.arange(len(strokes))
    found = new.by_pool(rows, strokes, paint_of, missing)
    for own, there in found:
        (moved,) = new.moved(strokes[own], target, problem.paper, there, 0.01)
        assert torch.equal(moved.colours, strokes.colours[own])
    assert torch.cat([own for own, _ in found]).sort().values.tolist() == rows.tolist()


def test_strokes_of_an_ink_that_is_nowhere_missing_are_not_moved(problem: PlanningProblem) -> None:
    new, paint_of = initialiser(problem, INKS), torch.tensor([0, 1, 1, 2])
    strokes = new.first()[0][torch.arange(4)]
    density = np.ones((3, *problem.weights.shape))
    density[1] = 0
    assert [rows.tolist() for rows, _ in new.by_pool(torch.arange(4), strokes, paint_of, density)] == [[0], [3]]


@pytest.mark.parametrize("strokes", [1, 2, 7])
def test_few_strokes_of_many_inks_are_exactly_so_many(problem: PlanningProblem, strokes: int) -> None:
    found = plan(problem, replace(INKS, strokes=strokes, steps=20, exact=True)).strokes
    assert len(found) == strokes
    assert all(tensor.isfinite().all() for tensor in found.each().values())


def test_regions_are_drawn_in_inks_each_in_those_that_it_allows(problem: PlanningProblem) -> None:
    labels = np.zeros(problem.weights.shape, dtype=np.int64)
    labels[: labels.shape[0] // 2] = 1
    said = (Region("rest", HAND, (True,)), Region("top", unplaced(), (True,), colours=(BLUE,)))
    regions = Regions(labels, said, problem.canvas)
    found = plan(replace(problem, regions=regions, style=regions.style), INKS)
    inks = [found.paint_of[regions.style.regions_of(found.strokes.codes) == number].unique() for number in range(2)]
    assert inks[1].tolist() == [1]
    assert len(inks[0]) > 1


@pytest.mark.parametrize("arranged", [True, False], ids=["arranged", "each alone"])
def test_a_region_with_a_share_has_the_inks_of_its_part_of_the_picture(
    problem: PlanningProblem, *, arranged: bool
) -> None:
    parted = in_halves(problem, Region("left", HAND, (True,), share=0.7))
    strokes, _ = initialiser(parted, INKS, arranged=arranged).first()
    assert isinstance(parted.style, RegionalStyle)
    left = parted.style.regions_of(strokes.codes) == 1
    assert int(left.sum()) == round(0.7 * INKS.strokes)
    assert {nearest(colour) for colour in strokes.colours[left].tolist()} == {RED}
    assert {nearest(colour) for colour in strokes.colours[~left].tolist()} == {BLUE}


def test_an_ink_is_not_moved_into_a_region_that_does_not_allow_it(problem: PlanningProblem) -> None:
    parted = in_halves(problem, Region("left", HAND, (True,), colours=(RED,)))
    new = initialiser(parted, INKS)
    strokes = new.first()[0]
    blue = torch.tensor([nearest(colour) == BLUE for colour in strokes.colours.tolist()])
    rows, paint_of = blue.nonzero()[:, 0], torch.full((len(strokes),), new.palette.index(BLUE))
    density = np.ones((3, *problem.weights.shape))
    density[new.palette.index(BLUE)] = 0
    assert len(rows) > 10
    assert new.by_pool(rows, strokes, paint_of, density) == []


def test_a_text_without_a_picture_begins_with_strokes_of_all_inks(problem: PlanningProblem) -> None:
    strokes, _ = initialiser(replace(problem, target=None), INKS).first()
    assert {nearest(colour) for colour in strokes.colours.tolist()} == {DARK, RED, BLUE}


def in_halves(problem: PlanningProblem, left: Region) -> PlanningProblem:
    labels = np.zeros(problem.weights.shape, dtype=np.int64)
    labels[:, : labels.shape[1] // 2] = 1
    regions = Regions(labels, (Region("rest", HAND, (True,)), left), problem.canvas)
    return replace(problem, regions=regions, style=regions.style)


def initialiser(problem: PlanningProblem, settings: PlannerSettings, *, arranged: bool = True) -> Initialiser:
    return Initialiser(problem, settings, arranged, np.random.default_rng(0), torch.Generator().manual_seed(0))


def nearest(colour: list[float]) -> tuple[float, float, float]:
    return min((DARK, RED, BLUE), key=lambda ink: np.abs(np.array(ink) - colour).sum())
