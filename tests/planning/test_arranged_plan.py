"""Plans in one ink in a hand whose arrangement is known."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from maulstick.errors import InputError
from maulstick.painting.brush import Brush
from maulstick.planning.arranging import Arranging
from maulstick.planning.initialise import Initialiser
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings, PlanningProblem
from maulstick.planning.regions import Region, Regions
from maulstick.planning.result import PlanResult
from maulstick.planning.schedule import REPLAN
from maulstick.storage.arrays import Image as Picture
from maulstick.style import Style
from maulstick.style.arrangement.laid import Laid
from maulstick.style.exemplar import Exemplar
from maulstick.style.hand import Hand
from maulstick.style.regional import RegionalStyle
from tests.planning.conftest import options, problem_for, state_after
from tests.support.drawn import as_strokes, hatching
from tests.support.nominal import nominal
from tests.support.style.synthetic_hands import all_hands

INK = options(paints=None, strokes=40, steps=40)
HAND = Exemplar("hatcher", Hand.of(as_strokes(0.4 * hatching(6, seed=0))), all_hands(), 0.0)


def unplaced() -> Exemplar:
    return replace(HAND, hand=replace(HAND.hand, poses=None))


@pytest.fixture(scope="module")
def problem(portrait: Picture) -> PlanningProblem:
    return replace(problem_for(portrait, nominal("fineliner"), halftone=True), style=HAND)


@pytest.fixture(scope="module")
def planned(problem: PlanningProblem) -> PlanResult:
    return plan(problem, INK)


def same(one: PlanResult, two: PlanResult) -> bool:
    return all(torch.equal(tensor, two.strokes.each()[name]) for name, tensor in one.strokes.each().items())


def far(strokes: StrokeParameters) -> float:
    """How far strokes lie from the hand's to those near them."""
    assert HAND.arrangement is not None
    laid = Laid.of(HAND.decode(strokes.codes), strokes.centres, strokes.angles)
    return float(HAND.arrangement.neighbourhoods.price(laid, torch.Generator().manual_seed(0)))


def test_strokes_lie_as_the_hands_do_and_without_arrangement_they_do_not(
    problem: PlanningProblem, planned: PlanResult
) -> None:
    alone = plan(problem, replace(INK, arrange=0.0))
    assert far(planned.strokes) < 0.5 * far(alone.strokes)


def test_strokes_lie_along_the_stripes_of_a_picture_as_the_hands_lie_along_their_groups(
    problem: PlanningProblem,
) -> None:
    height, width = problem.weights.shape
    stripes = 0.6 + 0.3 * np.sin(np.arange(width, dtype=np.float32) / 3)
    picture = np.broadcast_to(stripes[:, None], (height, width, 3))
    striped = replace(problem_for(picture, problem.brushes[0], halftone=True), style=HAND)
    found, alone = (plan(striped, replace(INK, arrange=arrange)).strokes for arrange in (1.0, 0.0))

    def upright(strokes: StrokeParameters) -> float:
        laid = Laid.of(HAND.decode(strokes.codes), strokes.centres, strokes.angles)
        return float(-(2 * laid.axes).cos().mean())

    assert upright(found) > 0.9
    assert upright(found) > upright(alone)


def test_a_seed_repeats_an_arranged_plan_to_the_bit_and_another_seed_does_not(
    problem: PlanningProblem, planned: PlanResult
) -> None:
    assert same(plan(problem, INK), planned)
    assert not same(plan(problem, replace(INK, seed=1, exact=True)), plan(problem, replace(INK, exact=True)))


@pytest.mark.parametrize("steps", [1, 7, 19, 39])
def test_an_arranged_plan_goes_on_as_if_it_had_not_stopped(
    problem: PlanningProblem, planned: PlanResult, steps: int
) -> None:
    assert same(plan(problem, INK, resume=state_after(problem, INK, steps)), planned)


@pytest.mark.parametrize("in_regions", [False, True])
def test_an_arranged_plan_that_goes_on_looks_for_no_strokes_to_begin_with(
    problem: PlanningProblem, monkeypatch: pytest.MonkeyPatch, *, in_regions: bool
) -> None:
    asked = split(problem, other=HAND) if in_regions else problem
    whole, state = plan(asked, INK), state_after(asked, INK, 19)
    older = {name: array for name, array in state.items() if name != "densities"}
    assert same(plan(asked, INK, resume=older), whole)
    monkeypatch.delattr(Initialiser, "first")
    assert same(plan(asked, INK, resume=state), whole)


@pytest.mark.parametrize("settings", [replace(INK, arrange=0.0), replace(INK, paints=4)], ids=["0", "paints"])
def test_without_arranging_and_with_paints_a_plan_is_that_of_a_hand_of_unknown_places(
    problem: PlanningProblem, settings: PlannerSettings
) -> None:
    assert same(plan(problem, settings), plan(replace(problem, style=unplaced()), settings))


def test_without_arranging_strokes_to_start_with_are_planned_as_of_a_hand_of_unknown_places(
    problem: PlanningProblem, planned: PlanResult
) -> None:
    settings = replace(INK, strokes=len(planned.strokes), steps=5, arrange=0.0)
    both = [plan(replace(problem, style=style), settings, start=planned.strokes) for style in (HAND, unplaced())]
    assert same(*both)


def test_strokes_that_are_planned_again_stay_arranged(problem: PlanningProblem, planned: PlanResult) -> None:
    kept = planned.strokes[torch.arange(len(planned.strokes) - 8)]
    arranged, alone = (
        plan(problem, replace(INK, arrange=arrange), schedule=REPLAN, start=kept).strokes for arrange in (1.0, 0.0)
    )
    assert far(arranged) < 0.7 * far(alone)


@pytest.mark.parametrize("strokes", [1, 4, 5, 6, 61])
def test_few_strokes_are_arranged_and_exact_means_exactly_so_many(problem: PlanningProblem, strokes: int) -> None:
    found = plan(problem, replace(INK, strokes=strokes, steps=25, exact=True)).strokes
    assert len(found) == strokes
    assert all(tensor.isfinite().all() for tensor in found.each().values())


def test_strokes_keep_inside_the_sheet_and_the_lengths_of_the_hand(problem: PlanningProblem) -> None:
    found = plan(problem, replace(INK, exact=True)).strokes
    paths = found.trajectories(HAND)[..., :2]
    assert paths.min() > -1e-6
    assert (paths.amax(dim=(0, 1)) < torch.tensor([problem.canvas.width, problem.canvas.height]) + 1e-6).all()
    lengths = paths.diff(dim=1).norm(dim=-1).sum(dim=1).sort().values
    assert lengths.numpy() == pytest.approx(HAND.lengths(len(found)).numpy(), rel=1e-3)


def test_a_brush_that_presses_draws_an_arranged_plan(problem: PlanningProblem, round_brush: Brush) -> None:
    found = plan(replace(problem, brushes=(round_brush,)), replace(INK, steps=10)).strokes
    assert found.pressure_knots.max() > 0


def split(problem: PlanningProblem, *, other: Style) -> PlanningProblem:
    """The problem with two regions side by side, the right one in another hand."""
    height, width = problem.weights.shape
    labels = np.zeros((height, width), dtype=np.int64)
    labels[:, width // 2 :] = 1
    said = (Region("rest", HAND, (True,)), Region("right", other, (True,)))
    regions = Regions(labels, said, problem.canvas)
    return replace(problem, regions=regions, style=regions.style)


def in_region(found: StrokeParameters, style: RegionalStyle, number: int) -> StrokeParameters:
    own = found[style.regions_of(found.codes) == number]
    return replace(own, codes=style.own_codes(own.codes, number))


def test_each_region_is_arranged_as_its_own_hand_arranges(problem: PlanningProblem) -> None:
    both = split(problem, other=HAND)
    assert isinstance(both.style, RegionalStyle)
    found, alone = (plan(both, replace(INK, strokes=60, arrange=arrange)).strokes for arrange in (1.0, 0.0))
    for number in range(2):
        assert far(in_region(found, both.style, number)) < 0.7 * far(in_region(alone, both.style, number))


def test_a_region_whose_hand_has_no_arrangement_is_placed_stroke_by_stroke(problem: PlanningProblem) -> None:
    both = split(problem, other=unplaced())
    assert isinstance(both.style, RegionalStyle)
    found = plan(both, replace(INK, strokes=60, exact=True)).strokes
    assert len(found) == 60
    arranged, alone = (in_region(found, both.style, number) for number in range(2))
    assert min(len(arranged), len(alone)) > 5
    middle = problem.canvas.width / 2
    slack = 1.5 / problem.canvas.pixels_per_metre
    assert arranged.centres[:, 0].max() < middle + slack
    assert alone.centres[:, 0].min() > middle - slack


def test_the_price_of_regions_moves_strokes(problem: PlanningProblem) -> None:
    both = split(problem, other=HAND)
    start = plan(both, replace(INK, strokes=40, steps=1, exact=True)).strokes
    moving = replace(start, centres=start.centres.clone().requires_grad_())
    ink_of = torch.zeros(len(start), dtype=torch.long)
    price = Arranging(both, start, ink_of, 0.01, 1.0).price(moving, torch.Generator().manual_seed(0))
    (slopes,) = torch.autograd.grad(price, moving.centres)
    assert (slopes.abs().sum(dim=1) > 0).float().mean() > 0.9


@pytest.mark.parametrize("arrange", [-0.1, 1.5, float("nan")])
def test_arranging_by_less_than_nothing_or_more_than_wholly_is_refused(arrange: float) -> None:
    with pytest.raises(InputError, match="how far strokes are arranged"):
        options(arrange=arrange)
