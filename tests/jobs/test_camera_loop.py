from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import pytest
import torch

from maulstick.errors import InputError
from maulstick.jobs.paint import camera_loop
from maulstick.jobs.paint.camera_loop import check_replannable, replanned
from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.prepare import prepare
from maulstick.jobs.plan.request import PlanRequest
from maulstick.painting.painting import Painting, Sheet, Stroke
from maulstick.painting.painting_file import read_painting, write_painting
from maulstick.painting.raster import Canvas
from maulstick.planning.layout import Layout
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings, PlanningProblem
from maulstick.planning.result import PlanResult
from maulstick.rendering.preview import preview
from tests.support.nominal import nominal
from tests.support.planned import PIXELS, SIDE, STROKES, picture, planned

WHITE = np.ones((PIXELS, PIXELS, 3), dtype=np.float32)
PAINTED = {stroke.id for stroke in planned().strokes[:6]}
QUICK = 12  # steps


def left_of(painting: Painting) -> list[Stroke]:
    return [stroke for stroke in painting.strokes if stroke.id not in PAINTED]


@pytest.fixture(scope="module")
def again() -> Painting:
    """The painting planned again after six strokes, of which the photograph shows nothing."""
    return replanned(planned(), PAINTED, WHITE, picture(), steps=QUICK)


# Planning again.


def test_strokes_that_are_painted_stay_as_they_are_and_come_first(again: Painting) -> None:
    assert again.strokes[:6] == planned().strokes[:6]


def test_strokes_that_are_planned_again_have_ids_that_were_never_used(again: Painting) -> None:
    ids = [stroke.id for stroke in left_of(again)]
    assert ids == list(range(STROKES, STROKES + len(ids)))
    twice = replanned(again, PAINTED | {ids[0]}, WHITE, picture(), steps=QUICK)
    assert min(stroke.id for stroke in left_of(twice) if stroke.id != ids[0]) == 1 + ids[-1]


def test_what_is_planned_again_is_of_the_same_style_paints_and_brush_and_no_longer(again: Painting) -> None:
    before, after = planned(), left_of(again)
    assert 0 < len(after) <= STROKES - len(PAINTED)
    assert {stroke.style.hash for stroke in after if stroke.style} == {before.strokes[0].style.hash}  # type: ignore[union-attr]
    assert all(stroke.style is not None for stroke in after)
    assert (again.paints, again.brushes, again.sheet, again.area) == (
        before.paints, before.brushes, before.sheet, before.area,
    )  # fmt: skip
    assert {stroke.trajectory for stroke in after}.isdisjoint(stroke.trajectory for stroke in before.strokes)


def test_a_plan_of_an_exact_number_of_strokes_keeps_that_number(again: Painting) -> None:
    assert len(again.strokes) == STROKES
    nothing_to_do = replanned(at_most(planned()), PAINTED, WHITE, WHITE, steps=QUICK)
    assert len(nothing_to_do.strokes) < STROKES


def test_planning_again_is_the_same_each_time(again: Painting) -> None:
    assert replanned(planned(), PAINTED, WHITE, picture(), steps=QUICK) == again


@pytest.mark.parametrize("share", [0.0, 0.25, 1.0])
def test_strokes_are_planned_again_arranged_as_far_as_the_plan_was(
    monkeypatch: pytest.MonkeyPatch, share: float
) -> None:
    shares: list[float] = []

    def seen(problem: PlanningProblem, settings: PlannerSettings, **given: Any) -> PlanResult:
        shares.append(settings.arrange)
        return plan(problem, settings, **given)

    monkeypatch.setattr(camera_loop, "plan", seen)
    before = planned()
    options = {**before.provenance.options, "arrange": share}
    painting = before.model_copy(update={"provenance": before.provenance.model_copy(update={"options": options})})
    replanned(painting, PAINTED, WHITE, picture(), steps=1)
    assert shares == [share]


def test_what_was_planned_again_can_be_written_read_and_planned_again(again: Painting, tmp_path: Path) -> None:
    write_painting(again, tmp_path / "again.json")
    assert [stroke.id for stroke in read_painting(tmp_path / "again.json").strokes] == [s.id for s in again.strokes]
    check_replannable(read_painting(tmp_path / "again.json"))


def at_most(painting: Painting) -> Painting:
    """Return a painting that was planned with at most as many strokes, not exactly as many."""
    options = {**painting.provenance.options, "exact": False}
    return painting.model_copy(update={"provenance": painting.provenance.model_copy(update={"options": options})})


def in_the_disc(strokes: list[Stroke]) -> int:
    """Return how many strokes have their middle on the picture's dark disc."""
    middles = np.array([np.mean(stroke.trajectory, axis=0)[:2] for stroke in strokes]).reshape(-1, 2) / SIDE
    return int((np.hypot(middles[:, 0] - 0.35, middles[:, 1] - 0.4) < 0.28).sum())


def test_where_a_person_has_painted_meanwhile_fewer_strokes_are_left_to_paint() -> None:
    down, across = np.mgrid[:PIXELS, :PIXELS] / PIXELS
    blackened = np.where((np.hypot(down - 0.4, across - 0.35) < 0.28)[..., None], np.float32(0.05), WHITE)
    bare, beside = (
        in_the_disc(left_of(replanned(at_most(planned()), PAINTED, sheet, picture(), steps=QUICK)))
        for sheet in (WHITE, blackened)
    )
    assert beside < bare


def test_with_nothing_left_nothing_is_planned() -> None:
    ids = {stroke.id for stroke in planned().strokes}
    assert replanned(planned(), ids, WHITE, picture()) is planned()


def test_paints_of_other_brushes_are_not_used_by_this_one() -> None:
    before = planned()
    other = nominal("fineliner")
    theirs = before.paints[0].model_copy(update={"brush": other.name})
    both = before.model_copy(
        update={
            "paints": (theirs, *before.paints),
            "brushes": {**before.brushes, other.name: other},
            "strokes": tuple(stroke.model_copy(update={"paint": stroke.paint + 1}) for stroke in before.strokes),
        }
    )
    after = replanned(both, PAINTED, WHITE, picture(), steps=QUICK)
    assert {stroke.paint for stroke in after.strokes} == {1, 2}


def test_a_plan_of_more_pixels_than_one_piece_has_is_planned_again_with_fewer(monkeypatch: pytest.MonkeyPatch) -> None:
    canvases: list[Canvas] = []

    def stop(layout: Layout, *_: object, **__: object) -> NoReturn:
        canvases.append(layout.canvas)
        raise InterruptedError

    monkeypatch.setattr(camera_loop, "problem_of", stop)
    wide = {"sheet": Sheet(width=4 * SIDE, height=SIDE), "provenance": made_with(px=4000).provenance}
    for painting in (planned(), made_with(px=None), planned().model_copy(update=wide)):
        with pytest.raises(InterruptedError):
            replanned(painting, PAINTED, WHITE, picture())
    assert [(canvas.width_px, canvas.height_px) for canvas in canvases] == [(PIXELS, PIXELS), (256, 256), (2048, 512)]


def test_a_drawing_in_one_ink_is_planned_again_in_the_tones_that_it_was_planned_in(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    options = PlanOptions(
        strokes=40, style="contour", hand_size=0.3, ink="black", brush="fineliner", size="60x60mm", px=48, steps=8
    )
    prepared = prepare(PlanRequest(None, options), picture())
    painting = prepared.painting(prepared.plan(lambda progress: True, None))
    seen: list[PlanningProblem] = []
    problem_of = camera_loop.problem_of

    def watched(layout: Layout, *others: Any, **named: Any) -> PlanningProblem:
        seen.append(problem_of(layout, *others, **named))
        return seen[-1]

    monkeypatch.setattr(camera_loop, "problem_of", watched)
    photograph = preview(painting, prepared.layout.canvas, strokes=15)
    again = replanned(painting, set(range(15)), photograph, picture(), steps=QUICK)
    assert prepared.problem.target is not None
    assert seen[0].target is not None
    assert prepared.problem.target.mean().item() > picture().mean() + 0.1, "there is too little ink"
    assert torch.allclose(seen[0].target, prepared.problem.target, atol=1e-5)
    lengths = (np.sort(each.lengths()) for each in (painting, again))
    assert next(lengths) == pytest.approx(next(lengths), rel=5e-3), "and strokes stay as long"


def test_lines_are_planned_again_as_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    options = PlanOptions(
        strokes=40,
        style="marks",
        hand_size=0.5,
        ink="black",
        brush="fineliner",
        size="60x60mm",
        px=48,
        steps=8,
        drawing="lines",
    )
    prepared = prepare(PlanRequest(None, options), picture())
    painting = prepared.painting(prepared.plan(lambda progress: True, None))
    seen: list[Layout] = []

    def stop(layout: Layout, *_: object, **__: object) -> NoReturn:
        seen.append(layout)
        raise InterruptedError

    monkeypatch.setattr(camera_loop, "problem_of", stop)
    with pytest.raises(InterruptedError):
        replanned(painting, set(range(5)), WHITE, picture())
    assert prepared.layout.target is not None
    assert seen[0].target is not None
    assert prepared.layout.target.mean() > picture().mean() + 0.05, "lines leave most of the paper white"
    assert seen[0].target.mean() == pytest.approx(prepared.layout.target.mean(), abs=0.05)


def made_with(**options: object) -> Painting:
    made = planned().provenance
    return planned().model_copy(update={"provenance": made.model_copy(update={"options": {**made.options, **options}})})


@pytest.mark.parametrize(("paints", "is_ink"), [(1, False), (None, True)])
def test_a_single_paint_that_was_mixed_does_not_become_an_ink(
    monkeypatch: pytest.MonkeyPatch, paints: int | None, is_ink: bool
) -> None:
    strokes = tuple(stroke.model_copy(update={"paint": 0}) for stroke in planned().strokes)
    alone = made_with(paints=paints).model_copy(update={"paints": planned().paints[:1], "strokes": strokes})
    seen: list[PlannerSettings] = []

    def stop(problem: PlanningProblem, settings: PlannerSettings, **_: object) -> NoReturn:
        seen.append(settings)
        raise InterruptedError

    monkeypatch.setattr(camera_loop, "plan", stop)
    with pytest.raises(InterruptedError):
        replanned(alone, PAINTED, WHITE, picture())
    assert seen[0].in_ink == is_ink


def without_style() -> Painting:
    strokes = (planned().strokes[0].model_copy(update={"style": None}), *planned().strokes[1:])
    return planned().model_copy(update={"strokes": strokes})


def of_another_style() -> Painting:
    changed = [
        stroke.model_copy(update={"style": stroke.style.model_copy(update={"hash": "0" * 64})})  # type: ignore[union-attr]
        for stroke in planned().strokes
    ]
    return planned().model_copy(update={"strokes": tuple(changed)})


def test_strokes_of_several_brushes_are_planned_again_each_with_its_own() -> None:
    before = of_two_brushes()
    check_replannable(before)
    again = replanned(before, PAINTED, WHITE, picture(), steps=QUICK)
    assert (again.paints, again.brushes) == (before.paints, before.brushes)
    brushes = [[plan.paints[stroke.paint].brush for stroke in left_of(plan)] for plan in (before, again)]
    assert sorted(brushes[0]) == sorted(brushes[1])
    assert len(set(brushes[1])) == 2


def of_two_brushes() -> Painting:
    paints = (planned().paints[0], planned().paints[1].model_copy(update={"brush": "fineliner"}))
    brushes = {**planned().brushes, "fineliner": nominal("fineliner")}
    return planned().model_copy(update={"paints": paints, "brushes": brushes})


@pytest.mark.parametrize(
    ("painting", "text"),
    [
        (made_with(weights={"tone": 1.0, "text": 1.0}), "text was weighed when it was planned"),
        (made_with(weights={"look": 1.0}), "look was weighed when it was planned"),
        (without_style(), "the strokes that are left are not all of one style"),
        (of_another_style(), "the style loops is not what it was when the painting was planned; plan it anew"),
        (made_with(style="nobody"), "there is no style 'nobody'"),
    ],
)
def test_what_cannot_be_planned_again_is_refused_before_and_on_the_way(painting: Painting, text: str) -> None:
    with pytest.raises(InputError, match=text) as before:
        check_replannable(painting)
    with pytest.raises(InputError, match=text) as after:
        replanned(painting, (), WHITE, picture())
    assert str(before.value) == str(after.value)
    assert "\n" not in str(before.value)


def test_a_painting_whose_strokes_are_all_locked_stays_as_it_is_under_the_camera() -> None:
    strokes = tuple(stroke.model_copy(update={"locked": True}) for stroke in planned().strokes)
    painting = planned().model_copy(update={"strokes": strokes})
    check_replannable(painting)
    assert replanned(painting, PAINTED, WHITE, picture()) == painting
