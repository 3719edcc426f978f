from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import Tensor

from maulstick.colour.palette import lightness
from maulstick.errors import InputError
from maulstick.painting.brush import Brush, load_brush
from maulstick.planning import planner, style_price
from maulstick.planning.drawn_pixels import FINE, to_canvas, to_drawn
from maulstick.planning.objectives import Objective
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.placement import Places, start_strokes
from maulstick.planning.planner import plan
from maulstick.planning.problem import Neighbours, PlannerSettings, PlanningProblem, Weighted
from maulstick.planning.result import PlanProgress, PlanResult
from maulstick.planning.schedule import GIVEN_PAINTS, Schedule
from maulstick.planning.state import State, set_back
from maulstick.rendering.traj2stroke import Traj2Stroke, paint
from maulstick.storage.arrays import Image as Picture
from maulstick.style import Style
from maulstick.style.free import FreeStyle
from maulstick.style.traits import path_length
from tests.planning.conftest import QUICK, mse, options, problem_for
from tests.support.nominal import nominal
from tests.support.style.synthetic_hands import exemplar_of, zigzag
from tests.support.tolerances import FLOAT32_METRES, LIGHTNESS_DRIFT, MAX_MEAN_COST


@pytest.fixture(scope="module")
def problem(portrait: Picture, round_brush: Brush) -> PlanningProblem:
    return problem_for(portrait, round_brush)


@pytest.fixture(scope="module")
def steps() -> list[PlanProgress]:
    """Progress after every step of `planned`."""
    return []


@pytest.fixture(scope="module")
def planned(problem: PlanningProblem, steps: list[PlanProgress]) -> PlanResult:
    def watch(progress: PlanProgress) -> bool:
        steps.append(progress)
        return True

    return plan(problem, QUICK, watch)


def rendered(problem: PlanningProblem, planned: PlanResult, side: float = 1) -> Tensor:
    """The canvas, drawn on pixels of that side."""
    trajectories = planned.strokes.trajectories(problem.style)
    brushes = Traj2Stroke.of(problem.brushes)[planned.strokes.brush_of]
    colours = planned.paints[planned.paint_of]
    resolution = problem.canvas.pixels_per_metre / side
    drawn = paint(to_drawn(problem.paper, side), trajectories, colours, brushes, resolution)
    return to_canvas(drawn, side, problem.paper)


def same(one: PlanResult, two: PlanResult) -> bool:
    """Return whether two plans are equal to the bit."""
    pairs = [(one.paints, two.paints), (one.paint_of, two.paint_of)]
    pairs += [(tensor, two.strokes.each()[name]) for name, tensor in one.strokes.each().items()]
    return all(torch.equal(a, b) for a, b in pairs)


def changes(planned: PlanResult) -> int:
    return int((planned.paint_of.diff() != 0).sum())


def nearly_blank() -> Picture:
    picture = np.ones((48, 60, 3), dtype=np.float32)
    picture[20:26, 20:32] = (0.1, 0.2, 0.5)
    return picture


def test_a_plan_is_nearer_to_its_picture_than_its_start_and_than_random_strokes(
    problem: PlanningProblem, planned: PlanResult, steps: list[PlanProgress]
) -> None:
    error = mse(rendered(problem, planned), problem.target)
    assert error < 0.3 * mse(steps[0].canvas, problem.target)
    rng = np.random.default_rng(0)
    anywhere = Places(
        rng.uniform((0, 0), (60, 48), (30, 2)), rng.uniform(0, 3, 30), np.full(30, 12.0), rng.random((30, 3))
    )
    generator = torch.Generator().manual_seed(0)
    random = start_strokes(anywhere, problem.style, problem.brushes[0], problem.canvas.pixels_per_metre, generator)
    assert error < 0.15 * mse(rendered(problem, PlanResult(random, random.colours, torch.arange(30))), problem.target)


def test_a_plan_shows_what_it_was_watched_to_become(
    problem: PlanningProblem, planned: PlanResult, steps: list[PlanProgress]
) -> None:
    assert len(steps) == 80
    assert [step.done for step in steps] == pytest.approx(np.arange(80) / 80)
    assert np.mean([step.loss for step in steps[-8:]]) < 0.5 * np.mean([step.loss for step in steps[:8]])
    for step in steps[::20]:
        assert step.canvas.shape == problem.target.shape
        assert not step.canvas.requires_grad
    assert mse(rendered(problem, planned), steps[-1].canvas) < 1e-4


def test_a_seed_repeats_a_plan_to_the_bit_and_another_seed_does_not(
    problem: PlanningProblem, planned: PlanResult
) -> None:
    torch.manual_seed(123)
    np.random.seed(123)  # noqa: NPY002  random numbers from elsewhere would show
    assert same(plan(problem, QUICK), planned)
    assert not same(plan(problem, options(seed=1)), planned)


def test_planning_takes_no_random_numbers_from_elsewhere_and_changes_no_argument(problem: PlanningProblem) -> None:
    before = problem.target.clone(), problem.paper.clone(), problem.weights.clone()
    torch_rng, rng = torch.random.get_rng_state(), np.random.get_state()[1].copy()  # type: ignore[index, union-attr]  # noqa: NPY002
    plan(problem, options(steps=12))
    assert torch.equal(torch.random.get_rng_state(), torch_rng)
    assert np.array_equal(np.random.get_state()[1], rng)  # type: ignore[index]  # noqa: NPY002
    for tensor, was in zip((problem.target, problem.paper, problem.weights), before, strict=True):
        assert torch.equal(tensor, was)


def test_every_paint_is_taken_up_once_the_lightest_first(problem: PlanningProblem) -> None:
    found = plan(problem, options(strokes=60, paints=12))
    assert 6 < len(torch.unique(found.paint_of)) <= 12
    assert changes(found) == len(torch.unique(found.paint_of)) - 1
    shades = lightness(found.paints[torch.unique_consecutive(found.paint_of)].double().numpy())
    assert np.diff(shades).max() < LIGHTNESS_DRIFT
    assert shades[0] > shades.max() - LIGHTNESS_DRIFT  # two that are nearly as light may change places
    assert shades[-1] < shades.min() + LIGHTNESS_DRIFT


def test_a_plan_has_all_its_numbers_in_range(problem: PlanningProblem, planned: PlanResult) -> None:
    assert 0.5 * QUICK.strokes < len(planned.strokes) <= QUICK.strokes
    assert planned.paints.shape == (4, 3)
    assert planned.paint_of.shape == (len(planned.strokes),)
    trajectories = planned.strokes.trajectories(problem.style)
    assert trajectories.shape == (len(planned.strokes), 32, 3)
    for shares in (planned.paints, planned.strokes.pressure_knots, planned.strokes.colours):
        assert shares.min() >= 0
        assert shares.max() <= 1
    size = torch.tensor([problem.canvas.width, problem.canvas.height])
    assert trajectories[..., :2].min() >= -FLOAT32_METRES
    assert (trajectories[..., :2] - size).max() <= FLOAT32_METRES
    assert not any(tensor.requires_grad for tensor in (planned.paints, *planned.strokes.each().values()))


@pytest.mark.parametrize("paints", [4, None])
def test_exact_gives_exactly_so_many_strokes(round_brush: Brush, paints: int | None) -> None:
    problem = problem_for(nearly_blank(), round_brush, halftone=paints is None)
    assert len(plan(problem, options(exact=True, paints=paints, steps=30)).strokes) == 30


@pytest.mark.parametrize("side", [1, FINE])
@pytest.mark.parametrize("paints", [4, None])
def test_a_nearly_blank_picture_is_planned_with_fewer_strokes(
    round_brush: Brush, paints: int | None, side: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = problem_for(nearly_blank(), round_brush, halftone=paints is None)
    # On which pixels it ends, and is judged, may hang on rounding.
    monkeypatch.setattr(planner, "finest", lambda target, rendered: side)

    def loss(found: PlanResult) -> float:
        return problem.objectives[0].term.loss(rendered(problem, found, side), 1.0).item()

    found = plan(problem, options(strokes=120, paints=paints))
    assert 1 <= len(found.strokes) < 120
    assert loss(found) < 0.6 * problem.objectives[0].term.loss(problem.paper, 1.0).item()
    whole = plan(problem, options(strokes=120, paints=paints, exact=True))
    assert loss(found) <= (1 + 1e-5) * loss(whole), "what was left out is not missed"


@pytest.mark.parametrize("paints", [4, None])
@pytest.mark.parametrize("name", ["round", "fineliner"])
def test_a_white_picture_is_left_nearly_bare(name: str, paints: int | None) -> None:
    problem = problem_for(np.ones((48, 60, 3), dtype=np.float32), load_brush(name), halftone=paints is None)
    found = plan(problem, options(paints=paints, steps=30))
    assert len(found.strokes) <= 3
    assert rendered(problem, found).min() > 0.98


TUBES = ((0.1, 0.1, 0.1), (0.95, 0.95, 0.9), (0.75, 0.3, 0.15), (0.2, 0.3, 0.5))


def test_given_paints_are_used_as_they_are_the_lightest_first(problem: PlanningProblem) -> None:
    found = plan(problem, options(paints=None, palette=TUBES, in_colours=True))
    assert found.paints.tolist() == [pytest.approx(TUBES[i]) for i in (1, 2, 3, 0)]
    assert 2 <= changes(found) <= 3
    assert mse(rendered(problem, found), problem.target) < 0.3 * mse(problem.paper, problem.target)


def test_strokes_take_other_paints_of_those_given_where_that_is_better(problem: PlanningProblem) -> None:
    given = options(paints=None, palette=TUBES, in_colours=True, exact=True)
    kept = [plan(problem, replace(given, seed=seed), schedule=replace(GIVEN_PAINTS, repaints=())) for seed in range(3)]
    taken = [plan(problem, replace(given, seed=seed)) for seed in range(3)]
    errors = [np.mean([mse(rendered(problem, found), problem.target) for found in plans]) for plans in (kept, taken)]
    assert errors[1] < errors[0]


def test_one_ink_paints_every_stroke(portrait: Picture) -> None:
    problem = problem_for(portrait, nominal("marker"), halftone=True)
    ink = (0.2, 0.1, 0.4)
    found = plan(problem, options(paints=None, palette=(ink,)))
    assert found.paints.tolist() == [pytest.approx(ink)]
    assert not found.paint_of.any()
    assert len(found.strokes) > 10
    assert changes(found) == 0
    assert mse(rendered(problem, found), problem.target) < mse(problem.paper, problem.target)


def test_a_pen_that_can_only_lift_never_presses(portrait: Picture) -> None:
    found = plan(problem_for(portrait, nominal("fineliner")), options(steps=30))
    assert len(found.strokes) > 0
    assert not found.strokes.pressure_knots.any()


@pytest.mark.parametrize("after", [1, 30, 70])
@pytest.mark.parametrize("paints", [4, None])
def test_a_plan_that_is_stopped_is_finished_in_a_few_steps_with_paints(
    portrait: Picture, round_brush: Brush, after: int, paints: int | None
) -> None:
    problem = problem_for(portrait, round_brush, halftone=paints is None)
    steps: list[PlanProgress] = []

    def watch(progress: PlanProgress) -> bool:
        steps.append(progress)
        return len(steps) < after

    found = plan(problem, options(paints=paints, steps=80), watch)
    assert after < len(steps) <= min(80, after + 60)
    assert np.diff([step.done for step in steps]).min() > 0
    assert steps[-1].done < 1
    assert len(found.paints) == (paints or 1)
    assert len(torch.unique(found.paint_of)) == changes(found) + 1
    assert mse(rendered(problem, found), problem.target) < mse(steps[0].canvas, problem.target)


def test_a_plan_that_is_stopped_when_it_ends_is_the_whole_plan(problem: PlanningProblem, planned: PlanResult) -> None:
    count = 0

    def watch(progress: PlanProgress) -> bool:
        nonlocal count
        count += 1
        return count < QUICK.steps

    assert same(plan(problem, QUICK, watch), planned)


@pytest.mark.parametrize("paints", [5, None])
def test_a_plan_that_is_set_back_late_comes_nearer_to_another_aim(
    portrait: Picture, round_brush: Brush, paints: int | None
) -> None:
    palette = ((0.0, 0.0, 0.0),) if paints else ((0.1, 0.1, 0.1), (0.5, 0.3, 0.2), (0.9, 0.8, 0.7))
    wanted = options(strokes=40, steps=60, paints=paints, palette=palette)
    problem, other = problem_for(portrait, round_brush), problem_for(portrait[::-1].copy(), round_brush)
    states: list[State] = []

    def keep(progress: PlanProgress) -> bool:
        if progress.done >= 0.9 and not states:
            states.append(progress.state())
        return True

    plan(problem, wanted, keep)
    reached, steps = {}, {}
    for name, state in (("late", states[0]), ("set back", set_back(states[0]))):
        losses: list[float] = []
        plan(other, wanted, lambda progress, losses=losses: losses.append(progress.loss) or True, resume=state)  # type: ignore[misc]
        reached[name], steps[name] = losses[-1], len(losses)
    assert steps["set back"] == 16  # two thirds of four tenths
    assert set_back(set_back(states[0]))["progress"].tolist() == set_back(states[0])["progress"].tolist()
    assert steps["late"] < 6
    assert reached["set back"] < 0.9 * reached["late"]
    early = {**states[0], "progress": np.array([0.2, *states[0]["progress"][1:]])}
    assert set_back(early)["progress"].tolist() == early["progress"].tolist()


def test_an_error_of_the_watch_stops_planning(problem: PlanningProblem) -> None:
    def watch(progress: PlanProgress) -> bool:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        plan(problem, QUICK, watch)


@pytest.mark.parametrize("steps", [1, 2, 3, 7])
def test_a_plan_of_a_few_steps_is_a_plan(problem: PlanningProblem, steps: int) -> None:
    found = plan(problem, options(steps=steps, exact=True))
    assert len(found.strokes) == 30
    assert changes(found) == len(torch.unique(found.paint_of)) - 1


@pytest.mark.parametrize(("strokes", "paints"), [(1, 1), (1, None), (2, 2), (5, 5)])
def test_a_few_strokes_are_a_plan(problem: PlanningProblem, strokes: int, paints: int | None) -> None:
    found = plan(problem, options(strokes=strokes, paints=paints, exact=True, steps=30))
    assert len(found.strokes) == strokes
    assert found.strokes.trajectories(problem.style).isfinite().all()


@pytest.mark.parametrize("shape", [(2, 90), (90, 2), (3, 5)])
@pytest.mark.parametrize("paints", [4, None])
def test_a_tiny_or_thin_canvas_is_planned(round_brush: Brush, shape: tuple[int, int], paints: int | None) -> None:
    picture = np.random.default_rng(0).random((*shape, 3)).astype(np.float32)
    problem = problem_for(picture, round_brush, halftone=paints is None)
    found = plan(problem, options(strokes=8, paints=paints, steps=20, exact=True))
    assert len(found.strokes) == 8
    assert rendered(problem, found).isfinite().all()


def test_strokes_begin_where_they_are_told_to(problem: PlanningProblem, planned: PlanResult) -> None:
    steps: list[PlanProgress] = []

    def watch(progress: PlanProgress) -> bool:
        steps.append(progress)
        return True

    count = len(planned.strokes)
    before = {name: tensor.clone() for name, tensor in planned.strokes.each().items()}
    finely = Schedule(coarse=(0.0, 0.0))
    plan(problem, options(strokes=count, steps=3), watch, schedule=finely, start=planned.strokes)
    free = PlanResult(planned.strokes, planned.strokes.colours, torch.arange(count))
    expected = rendered(problem, free)
    order = np.argsort(-lightness(planned.strokes.colours.double().numpy()), kind="stable")
    light_first = rendered(
        problem, PlanResult(planned.strokes[torch.from_numpy(order)], free.paints[order], free.paint_of)
    )
    assert min(mse(steps[0].canvas, image) for image in (expected, light_first)) < 1e-9
    assert all(torch.equal(tensor, before[name]) for name, tensor in planned.strokes.each().items())


def test_strokes_that_are_left_out_at_the_start_begin_where_the_canvas_is_furthest_from_the_picture(
    problem: PlanningProblem, planned: PlanResult
) -> None:
    left_half = planned.strokes.centres[:, 0] < problem.canvas.width / 2
    start = planned.strokes[left_half]
    steps: list[PlanProgress] = []

    def watch(progress: PlanProgress) -> bool:
        steps.append(progress)
        return True

    count = 4 * len(planned.strokes)
    free = Schedule(sorts=(), relocations=(), quantise=1.0)
    found = plan(problem, options(strokes=count, steps=1, exact=True), watch, schedule=free, start=start)
    assert len(found.strokes) == count
    new = found.strokes.centres[found.strokes.centres[:, 0] > problem.canvas.width / 2]
    assert len(new) > 0.8 * (count - len(start))


def test_of_too_many_strokes_to_start_with_those_that_would_be_missed_least_are_left_out(
    problem: PlanningProblem, planned: PlanResult
) -> None:
    count, target = len(planned.strokes) // 2, problem.target
    assert target is not None

    def error_of(start: StrokeParameters) -> float:
        canvases: list[Tensor] = []
        nearly_over = Schedule(sorts=(), relocations=(), begins=0.99)
        few = options(strokes=count, steps=1, exact=True)
        found = plan(problem, few, lambda at: canvases.append(at.canvas) is None, schedule=nearly_over, start=start)
        assert len(found.strokes) == count
        return mse(canvases[0], target)

    orders = [torch.randperm(len(planned.strokes), generator=torch.Generator().manual_seed(seed)) for seed in range(5)]
    assert error_of(planned.strokes) < 0.8 * min(error_of(planned.strokes[rows[:count]]) for rows in orders)


def test_a_plan_says_how_many_strokes_are_painted_before_each_neighbour(
    problem: PlanningProblem, planned: PlanResult
) -> None:
    palette = ((0.9, 0.9, 0.9), (0.5, 0.5, 0.5), (0.1, 0.1, 0.1))
    shades = torch.tensor([palette[2], palette[0], palette[1], palette[2]])
    three = planned.strokes[torch.tensor([0, 1, 2, 3])]
    there = Neighbours(three.trajectories(problem.style), shades, three.brush_of)
    found = plan(replace(problem, neighbours=there), options(paints=None, palette=palette, steps=30))
    lighter = [int((found.paint_of < paint).sum()) for paint in (2, 0, 1, 2)]
    as_light = [int((found.paint_of <= paint).sum()) for paint in (2, 0, 1, 2)]
    assert all(
        few <= before <= many for few, before, many in zip(lighter, found.before.tolist(), as_light, strict=True)
    )
    assert len(found.before) == 4
    assert len(plan(problem, options(steps=1)).before) == 0


def test_strokes_are_not_grouped_by_paint_where_the_schedule_says_so(problem: PlanningProblem) -> None:
    loose = plan(problem, options(steps=40, exact=True), schedule=Schedule(sorts=(), grouped=False))
    assert changes(loose) > 10
    assert same(plan(problem, options(steps=40), schedule=Schedule()), plan(problem, options(steps=40)))


def test_a_paint_is_mixed_for_the_strokes_that_show_most(problem: PlanningProblem) -> None:
    dot, line = FreeStyle(0.001, 0.03).encode(
        torch.tensor([[[0.0, 0.0]] * 32, [[0.03 * i / 31, 0.0] for i in range(32)]])
    )
    start = StrokeParameters(
        codes=torch.stack([dot, line]),
        centres=torch.tensor([[0.01, 0.01], [0.04, 0.03]]),
        angles=torch.zeros(2),
        pressure_knots=torch.tensor([[0.0] * 4, [1.0] * 4]),
        colours=torch.tensor([[0.0, 0.0, 0.0], [1.0, 1.0, 0.9]]),  # the line is painted first
        brush_of=torch.zeros(2, dtype=torch.long),
    )
    at_once = Schedule(relocations=(), quantise=0.0)
    found = plan(problem, options(strokes=2, paints=1, steps=1, exact=True), schedule=at_once, start=start)
    assert lightness(found.paints.double().numpy())[0] > 70


def as_unlikely(style: Style, found: PlanResult) -> float:
    """Return the mean cost of a plan's strokes, relative to strokes that the style alone draws."""
    torch_rng = torch.Generator().manual_seed(1)
    usual = torch.stack([style.cost(*style.sample(len(found.strokes), torch_rng)).mean() for _ in range(8)]).mean()
    return (style.cost(found.strokes.codes, found.strokes.pressure_knots).mean() / usual).item()


def test_a_plan_in_a_hand_stays_within_the_hands_max_mean_cost(portrait: Picture, round_brush: Brush) -> None:
    problem, hand = problem_for(portrait, round_brush), exemplar_of(zigzag)
    bounded, free = (
        plan(replace(problem, style=replace(hand, max_mean_cost=max_mean_cost)), options(paints=4, exact=True))
        for max_mean_cost in (0.5, float("inf"))
    )
    assert as_unlikely(hand, bounded) < 0.5 * MAX_MEAN_COST
    assert as_unlikely(hand, free) > 1.2 * as_unlikely(hand, bounded)
    assert mse(rendered(replace(problem, style=hand), bounded), problem.target) < 0.7 * mse(
        problem.paper, problem.target
    )


@pytest.mark.parametrize("paints", [None, 4])
def test_the_strokes_of_a_plan_in_a_hand_are_as_long_as_the_hands(
    portrait: Picture, round_brush: Brush, paints: int | None
) -> None:
    hand = exemplar_of(zigzag)
    problem = replace(problem_for(portrait, round_brush), style=hand)
    found = plan(problem, options(paints=paints, exact=True))
    lengths = path_length(hand.decode(found.strokes.codes)).sort().values
    assert lengths.numpy() == pytest.approx(hand.lengths(len(lengths)).numpy(), rel=1e-4)


def test_strokes_to_start_with_keep_the_lengths_that_they_have_together(portrait: Picture, round_brush: Brush) -> None:
    hand = exemplar_of(zigzag)
    problem = replace(problem_for(portrait, round_brush), style=hand)
    start = plan(problem, options(paints=4, steps=8, exact=True)).strokes[torch.arange(10)]
    found = plan(problem, options(paints=4, strokes=10, exact=True), start=start).strokes
    both = (path_length(hand.decode(strokes.codes)).sort().values.numpy() for strokes in (start, found))
    assert next(both) == pytest.approx(next(both), rel=1e-4)
    assert not torch.allclose(found.codes[:, 0], start.codes[:, 0])


def test_a_style_that_binds_nobody_never_weighs_more(
    problem: PlanningProblem, planned: PlanResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(style_price, "_GROWTH", 0.0)
    monkeypatch.setattr(style_price, "_SAMPLES", 1)
    assert same(plan(problem, QUICK), planned)


class Darker(Objective):
    """Objective of a black canvas."""

    @property
    def name(self) -> str:
        """Name of the term."""
        return "darker"

    def loss(self, canvas: Tensor, progress: float) -> Tensor:
        """Return the mean brightness."""
        return canvas.square().mean()


def test_any_objective_that_sees_the_canvas_can_lead(problem: PlanningProblem) -> None:
    led = replace(problem, objectives=(Weighted(Darker(), 1.0),))
    found = plan(led, options(steps=40, exact=True))
    assert rendered(problem, found).mean() < 0.7 * rendered(problem, plan(problem, options(steps=40))).mean()


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"strokes": 0}, "the number of strokes is 0; it must be at least 1"),
        ({"strokes": -3}, "the number of strokes is -3; it must be at least 1"),
        ({"paints": 0}, "the number of paints is 0; it must be 1 to the 30 strokes"),
        ({"paints": 31}, "the number of paints is 31; it must be 1 to the 30 strokes"),
        ({"steps": 0}, "the number of steps is 0; it must be at least 1"),
        ({"seed": -1}, "the seed is -1; it must be in 0 to 4294967295"),
        ({"seed": 2**32}, "the seed is 4294967296; it must be in 0 to 4294967295"),
    ],
)
def test_options_that_cannot_be_planned_are_refused(change: dict[str, int], text: str) -> None:
    with pytest.raises(InputError) as caught:
        options(**change)
    assert str(caught.value) == text


def test_options_at_their_limits_are_accepted() -> None:
    assert PlannerSettings(strokes=1, paints=1, steps=1, seed=2**32 - 1).paints == 1
    assert PlannerSettings(strokes=1, paints=None).paints is None
