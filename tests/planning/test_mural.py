from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image as Pillow
from skimage.data import astronaut

from maulstick.colour.palette import lightness
from maulstick.errors import InputError
from maulstick.painting.brush import Brush
from maulstick.painting.painting import Sheet
from maulstick.painting.raster import Canvas
from maulstick.planning import drawn_pixels, stroke_canvas, stroke_effects
from maulstick.planning.from_picture import as_painting, problem_of, provenance_of
from maulstick.planning.layout import Layout
from maulstick.planning.losses import LossOptions
from maulstick.planning.mural.planner import plan_mural
from maulstick.planning.mural.windows import Mural
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings
from maulstick.planning.result import PlanProgress, PlanResult
from maulstick.planning.state import State, read_state, write_state
from maulstick.rendering.kernels.render import composite
from maulstick.rendering.preview import preview
from maulstick.storage.arrays import Image
from maulstick.style import load_style
from tests.support.planning.same import same
from tests.support.tolerances import FLOAT32_METRES

PX, CORE, SIDE = 96, 48, 0.12
FINE = PlannerSettings(strokes=150, paints=4, steps=30)
QUICK = PlannerSettings(strokes=30, paints=3, steps=6)
TONE = LossOptions(weights={"tone": 1, "likeness": 0})
STYLE = load_style("free", Canvas(SIDE, SIDE, 1))
SEAM_PX = 4
SEAM = 1.4  # the error near seams beside that elsewhere, as a share of the same when planned whole
BETTER = 0.8  # the error of a mural, as a share of that when planned whole; of windows blind to each other it is 1.2


@pytest.fixture(scope="module")
def mural() -> Mural:
    """A mural of a face, in two by two windows."""
    face = Pillow.fromarray(astronaut()[:400, 50:450]).resize((PX, PX), Pillow.Resampling.LANCZOS)
    sheet = Sheet(width=SIDE, height=SIDE)
    return Mural(np.asarray(face, dtype=np.float32) / 255, sheet, Canvas(SIDE, SIDE, PX / SIDE))


@pytest.fixture(scope="module")
def layout(mural: Mural) -> Layout:
    """Layout of the whole mural at its full resolution."""
    return mural.overview(PX)


def planned_as(
    wanted: PlannerSettings,
    mural: Mural,
    brush: Brush,
    watch: Callable[[PlanProgress], bool] = lambda progress: True,
    resume: State | None = None,
) -> PlanResult:
    return plan_mural(mural, (brush,), STYLE, wanted, watch, loss_options=TONE, window_px=CORE, resume=resume)


def square_error(planned: PlanResult, layout: Layout, brush: Brush) -> Image:
    """Return the squared difference of the plan from the picture, (H, W)."""
    painting = as_painting(planned, layout, (brush,), STYLE, provenance_of(FINE))
    return np.square(preview(painting, layout.canvas) - layout.target).mean(axis=2)


@pytest.fixture(scope="module")
def steps() -> list[PlanProgress]:
    """Progress after every step of `planned`."""
    return []


@pytest.fixture(scope="module")
def rendered() -> list[int]:
    """The longest side of every canvas that was rendered for `planned`, pixels."""
    return []


@pytest.fixture(scope="module")
def planned(mural: Mural, round_brush: Brush, steps: list[PlanProgress], rendered: list[int]) -> PlanResult:
    def render(canvas, *rest, **options):  # type: ignore[no-untyped-def]
        rendered.append(max(canvas.shape))
        return composite(canvas, *rest, **options)

    def watch(progress: PlanProgress) -> bool:
        steps.append(progress)
        return True

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(stroke_canvas, "composite", render)
        patch.setattr(stroke_effects, "composite", render)
        patch.setattr(drawn_pixels, "_LARGE", 40)  # as windows of real murals are
        patch.setattr(drawn_pixels, "_FEWEST", 4)  # which are drawn coarsely at first
        return planned_as(FINE, mural, round_brush, watch)


@pytest.fixture(scope="module")
def states() -> list[State]:
    """States after every step of `quick`."""
    return []


@pytest.fixture(scope="module")
def quick(mural: Mural, round_brush: Brush, states: list[State]) -> PlanResult:
    def watch(progress: PlanProgress) -> bool:
        states.append(progress.state())
        return True

    return planned_as(QUICK, mural, round_brush, watch)


def test_seams_are_not_seen(planned: PlanResult, mural: Mural, layout: Layout, round_brush: Brush) -> None:
    whole = plan(problem_of(layout, (round_brush,), STYLE, FINE, TONE), FINE)
    near = np.zeros((PX, PX), dtype=bool)
    near[CORE - SEAM_PX : CORE + SEAM_PX] = near[:, CORE - SEAM_PX : CORE + SEAM_PX] = True
    in_windows, in_one = (square_error(each, layout, round_brush) for each in (planned, whole))
    assert in_windows.mean() < BETTER * in_one.mean()
    assert in_windows[near].mean() / in_windows[~near].mean() < SEAM * in_one[near].mean() / in_one[~near].mean()


def test_no_canvas_is_larger_than_a_window(planned: PlanResult, rendered: list[int], steps: list[PlanProgress]) -> None:
    assert len(rendered) > 5 * FINE.steps
    assert CORE < max(rendered) < 0.85 * PX
    assert max(max(step.canvas.shape) for step in steps) == max(rendered)


def test_strokes_stay_on_the_sheet_and_are_as_many_as_asked(planned: PlanResult) -> None:
    assert 0.9 * FINE.strokes < len(planned.strokes) <= FINE.strokes
    path = planned.strokes.trajectories(STYLE)[..., :2]
    assert path.min() >= -FLOAT32_METRES
    assert path.max() <= SIDE + FLOAT32_METRES


def test_all_windows_are_painted_together_a_paint_after_the_other(planned: PlanResult) -> None:
    assert torch.equal(planned.paint_of, planned.paint_of.sort().values)
    assert len(torch.unique(planned.paint_of)) == len(planned.paints) == 4
    assert (np.diff(lightness(planned.paints.double().numpy())) < 0).all()
    halves = (planned.strokes.centres < SIDE / 2).long()
    for paint in range(4):
        windows = halves[planned.paint_of == paint]
        assert len(torch.unique(2 * windows[:, 1] + windows[:, 0])) > 1


def test_progress_goes_on_through_all_windows(planned: PlanResult, steps: list[PlanProgress]) -> None:
    assert [step.done for step in steps] == pytest.approx(np.arange(5 * FINE.steps) / (5 * FINE.steps))
    assert steps[-1].canvas.shape[0] == 3


def test_what_a_window_finishes_lies_in_no_later_one_s_core_and_stays(quick: PlanResult, states: list[State]) -> None:
    in_the_end = {tuple(row) for row in quick.strokes.centres.tolist()}
    shares = []
    for state in states[QUICK.steps :]:
        centres, done = state["all.centres"][state["finished"] > 0], state["windows_done"].tolist()
        right, below = centres.T > SIDE / 2
        assert np.isin(2 * below + right, done).all()
        assert {tuple(row) for row in centres.tolist()} <= in_the_end
        shares.append(len(centres) / len(quick.strokes))
    assert done == [0, 1, 2]
    assert shares[:: QUICK.steps] == sorted(set(shares))
    assert 0.5 < shares[-1] < 1


def test_a_window_leaves_what_does_not_lie_in_it(quick: PlanResult, states: list[State]) -> None:
    before, after = ({tuple(row) for row in states[step]["all.centres"].tolist()} for step in (11, 12))
    stayed = np.array(sorted(before & after))
    assert 0.1 * len(before) < len(stayed) < 0.7 * len(before)
    assert (stayed.max(axis=1) > SIDE / 2).all()


@pytest.mark.parametrize("paints", [3, None])
def test_exact_gives_exactly_so_many_strokes(mural: Mural, round_brush: Brush, paints: int | None) -> None:
    exact = replace(QUICK, exact=True, paints=paints, steps=3)
    assert len(planned_as(exact, mural, round_brush).strokes) == 30


def test_fewer_strokes_than_windows_are_planned_where_they_are_wanted(mural: Mural, round_brush: Brush) -> None:
    few = replace(QUICK, strokes=3, paints=2, exact=True, steps=3)
    assert len(planned_as(few, mural, round_brush).strokes) == 3


def test_a_seed_repeats_a_mural_to_the_bit_and_another_does_not(
    mural: Mural, round_brush: Brush, quick: PlanResult
) -> None:
    torch.manual_seed(123)
    np.random.seed(123)  # noqa: NPY002  random numbers from elsewhere would show
    assert same(planned_as(QUICK, mural, round_brush), quick)
    assert not same(planned_as(replace(QUICK, seed=1), mural, round_brush), quick)


def test_a_mural_goes_on_from_the_file_of_its_whole_as_if_it_had_not_stopped(
    mural: Mural, round_brush: Brush, quick: PlanResult, states: list[State], tmp_path: Path
) -> None:
    assert len(states) == 30
    write_state(tmp_path / "plan.npz", states[4], {})
    state, _ = read_state(tmp_path / "plan.npz")
    assert same(planned_as(QUICK, mural, round_brush, resume=state), quick)


def test_who_stops_early_finds_later_windows_as_they_were_in_the_whole(
    mural: Mural, layout: Layout, round_brush: Brush, quick: PlanResult
) -> None:
    seen: list[State] = []

    def stop(progress: PlanProgress) -> bool:
        seen.append(progress.state())
        return len(seen) < 15

    stopped = planned_as(QUICK, mural, round_brush, stop)
    in_the_whole = {tuple(row) for row in seen[QUICK.steps]["all.centres"].tolist()}
    left = np.array([row for row in stopped.strokes.centres.tolist() if tuple(row) in in_the_whole])
    assert 2 < len(left) < 0.5 * len(stopped.strokes)
    assert (left[:, 1] > SIDE / 2).all()
    bare = PlanResult(stopped.strokes[torch.arange(0)], stopped.paints, torch.arange(0))
    error, nothing = (square_error(each, layout, round_brush)[PX // 2 :].mean() for each in (stopped, bare))
    assert error < 0.7 * nothing
    assert same(planned_as(QUICK, mural, round_brush, resume=seen[14]), quick)


def test_one_ink_draws_all_windows(mural: Mural, round_brush: Brush) -> None:
    drawn = planned_as(replace(QUICK, paints=None, palette=((0.0, 0.1, 0.3),)), mural, round_brush)
    assert drawn.paints.tolist() == [pytest.approx([0.0, 0.1, 0.3])]
    assert len(torch.unique((drawn.strokes.centres < SIDE / 2).long() @ torch.tensor([1, 2]))) == 4


def test_several_inks_draw_all_windows_each_with_a_pen_of_its_own(mural: Mural, round_brush: Brush) -> None:
    inks = ((0.0, 0.1, 0.3), (0.9, 0.6, 0.4))
    drawn = planned_as(replace(QUICK, paints=None, palette=inks), mural, round_brush)
    assert drawn.paints.tolist() == [pytest.approx(inks[1]), pytest.approx(inks[0])]
    assert drawn.paint_of.unique().tolist() == [0, 1]
    assert (drawn.paint_of.diff() >= 0).all(), "pen by pen"


def test_paints_that_there_are_stay_what_they_are(mural: Mural, round_brush: Brush) -> None:
    there = ((0.1, 0.1, 0.1), (0.9, 0.8, 0.7), (0.5, 0.3, 0.2))
    drawn = planned_as(replace(QUICK, paints=None, palette=there, in_colours=True), mural, round_brush)
    assert drawn.paints.tolist() == [pytest.approx(there[i]) for i in (1, 2, 0)]
    assert len(torch.unique(drawn.paint_of)) == 3


def test_colours_that_are_pinned_are_among_its_paints(mural: Mural, round_brush: Brush) -> None:
    red = (1.0, 0.0, 0.0)
    drawn = planned_as(replace(QUICK, pinned=(red,), steps=2), mural, round_brush)
    assert red in map(tuple, drawn.paints.tolist())


def test_an_empty_picture_leaves_the_sheet_nearly_bare(round_brush: Brush) -> None:
    white = Mural(np.ones((9, 12, 3), dtype=np.float32), Sheet(width=SIDE, height=0.09), Canvas(SIDE, 0.09, 800))
    assert len(planned_as(QUICK, white, round_brush).strokes) <= 6


def test_what_cannot_be_planned_in_windows_is_refused(mural: Mural, round_brush: Brush) -> None:
    with pytest.raises(InputError, match="a text is about a whole picture, and a mural is planned in windows"):
        plan_mural(mural, (round_brush,), STYLE, QUICK, loss_options=LossOptions(text="a face"))
    with pytest.raises(InputError, match=r"\d+ million pixels, and at most 67 are planned at once; take more"):
        plan_mural(replace(mural, canvas=Canvas(SIDE, SIDE, 32_000 / SIDE)), (round_brush,), STYLE, QUICK)
    with pytest.raises(InputError, match="the side of a window is 0 pixels; it must be at least 1"):
        plan_mural(mural, (round_brush,), STYLE, QUICK, loss_options=TONE, window_px=0)
