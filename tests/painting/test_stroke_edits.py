from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.errors import InputError
from maulstick.painting.painting import Paint, Painting, Provenance, Sheet, Stroke, StyleUse
from maulstick.painting.stroke_edits import (
    STROKE_EDIT,
    AddStroke,
    LockStrokes,
    MoveStrokes,
    RemoveStrokes,
    RepaintStrokes,
    StrokeEdit,
    UnlockStrokes,
    edited,
)
from tests.support.nominal import nominal

MICROMETRES = 2e-6
LINE = np.array([(-0.02, 0.0), (0.0, 0.005), (0.02, 0.0)])  # standardised


def placed(pose: tuple[float, float, float]) -> tuple[tuple[float, float, float], ...]:
    dx, dy, angle = pose
    turned = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return tuple((x, y, 0.5) for x, y in (LINE @ turned.T + (dx, dy)).tolist())


def a_stroke(number: int, pose: tuple[float, float, float]) -> Stroke:
    use = StyleUse(name="lines", hash="ab", code=(0.5,), pose=pose)
    return Stroke(id=number, paint=number % 3, trajectory=placed(pose), style=use)


def a_painting() -> Painting:
    poses = [(0.06 + 0.01 * number, 0.05 + 0.01 * number, 0.3 * number) for number in range(6)]
    return Painting(
        sheet=Sheet(width=0.2, height=0.16),
        provenance=Provenance(version="1"),
        brushes={"round": nominal("round")},
        paints=tuple(Paint(colour=(i / 3, 0.5, 1.0), brush="round") for i in range(3)),
        strokes=tuple(sorted((a_stroke(number, pose) for number, pose in enumerate(poses)), key=lambda s: s.paint)),
    )


def ids(painting: Painting) -> list[int]:
    return [stroke.id for stroke in painting.strokes]


def stroke_of(painting: Painting, number: int) -> Stroke:
    return next(stroke for stroke in painting.strokes if stroke.id == number)


strokes = st.lists(st.integers(0, 5), min_size=1, max_size=6).map(tuple)
metres = st.floats(-0.01, 0.01)
edits: st.SearchStrategy[StrokeEdit] = st.one_of(
    st.builds(LockStrokes, strokes=strokes),
    st.builds(UnlockStrokes, strokes=strokes),
    st.builds(MoveStrokes, strokes=strokes, by=st.tuples(metres, metres), turn=st.floats(-pi, pi)),
    st.builds(RepaintStrokes, strokes=strokes, paint=st.integers(0, 2)),
    st.builds(AddStroke, paint=st.integers(0, 2), trajectory=st.just(((0.1, 0.1, 0.5),))),
)


def test_strokes_are_locked_and_unlocked() -> None:
    locked = edited(a_painting(), [LockStrokes(strokes=(1, 4)), UnlockStrokes(strokes=(4,))])
    assert [stroke.id for stroke in locked.strokes if stroke.locked] == [1]


def test_strokes_are_taken_out() -> None:
    assert ids(edited(a_painting(), [RemoveStrokes(strokes=(0, 5))])) == [3, 1, 4, 2]


def test_a_stroke_of_another_paint_is_painted_after_all_of_that_paint_and_locked() -> None:
    painting = edited(a_painting(), [RepaintStrokes(strokes=(2, 0), paint=1)])
    assert ids(painting) == [3, 1, 4, 0, 2, 5]
    assert [stroke.paint for stroke in painting.strokes] == [0, 1, 1, 1, 1, 2]
    assert stroke_of(painting, 0).locked


def test_a_drawn_stroke_has_the_next_number_and_is_a_persons() -> None:
    line = ((0.01, 0.02, 0.5), (0.03, 0.02, 0.7))
    painting = edited(
        a_painting(), [AddStroke(paint=1, trajectory=line, speed=(0.1, 0.2)), AddStroke(paint=0, trajectory=line)]
    )
    assert ids(painting) == [0, 3, 7, 1, 4, 6, 2, 5]
    own = stroke_of(painting, 6)
    assert (own.trajectory, own.speed, own.origin, own.locked, own.style) == (line, (0.1, 0.2), "person", True, None)


def test_a_drawn_stroke_that_is_undone_leaves_its_number_to_nobody_else() -> None:
    dot = AddStroke(paint=0, trajectory=((0.1, 0.1, 0.5),))
    painting = edited(a_painting(), [dot, RemoveStrokes(strokes=(6,)), dot])
    assert sorted(ids(painting)) == [0, 1, 2, 3, 4, 5, 7]


@given(st.tuples(metres, metres), st.floats(-pi, pi))
def test_the_pose_of_a_moved_stroke_still_places_its_code(by: tuple[float, float], turn: float) -> None:
    painting = edited(a_painting(), [MoveStrokes(strokes=(2, 3), by=by, turn=turn)])
    for number in (2, 3):
        stroke = stroke_of(painting, number)
        assert stroke.style is not None
        assert np.abs(np.array(stroke.trajectory) - placed(stroke.style.pose)).max() < MICROMETRES


def test_strokes_are_turned_about_their_common_middle() -> None:
    before = a_painting()
    after = edited(before, [MoveStrokes(strokes=(0, 1), turn=pi)])
    both = [np.concatenate([np.array(stroke_of(p, n).trajectory) for n in (0, 1)])[:, :2] for p in (before, after)]
    assert np.allclose(both[0].min(axis=0) + both[0].max(axis=0), both[1].min(axis=0) + both[1].max(axis=0), atol=1e-5)


@given(st.lists(edits, max_size=6))
def test_strokes_that_no_edit_names_stay_as_they_are(some: list[StrokeEdit]) -> None:
    painting = a_painting()
    try:
        after = edited(painting, some)
    except InputError:  # moved off the sheet
        return
    named = {number for edit in some if not isinstance(edit, AddStroke) for number in edit.strokes}
    for number in set(ids(painting)) - named:
        assert stroke_of(after, number) == stroke_of(painting, number)


@given(edits)
def test_an_edit_is_the_same_after_it_was_written_and_read(edit: StrokeEdit) -> None:
    assert STROKE_EDIT.validate_json(STROKE_EDIT.dump_json(edit)) == edit


@pytest.mark.parametrize(
    ("edit", "text"),
    [
        (LockStrokes(strokes=(1, 99)), "there is no stroke 99 in the painting; name strokes by their ids"),
        (RepaintStrokes(strokes=(1,), paint=3), "the paint is 3; it must be an index into the 3 paints, from 0"),
        (AddStroke(paint=-1, trajectory=((0, 0, 0),)), "the paint is -1; it must be an index into the 3 paints"),
        (AddStroke(paint=0, trajectory=((0, 0, 0),), speed=(1, 1)), "it has 2 speeds for 1 point; give as many"),
        (MoveStrokes(strokes=(1,), by=(1, 0)), "stroke 1 reaches 889.1 mm"),
        (AddStroke(paint=0, trajectory=((0.5, 0, 0),)), "stroke 6 reaches 300 mm beyond the sheet of 200 x 160 mm"),
    ],
)
def test_an_edit_that_cannot_be_made_is_refused(edit: StrokeEdit, text: str) -> None:
    with pytest.raises(InputError, match=text):
        edited(a_painting(), [edit])


def test_metrics_stay_only_while_the_same_is_painted() -> None:
    before = a_painting()
    before = before.model_copy(update={"provenance": Provenance(version="1", seed=3, metrics={"psnr": 20.0})})
    same = edited(before, [LockStrokes(strokes=(1,)), UnlockStrokes(strokes=(1,))])
    assert same.provenance == before.provenance
    assert edited(before, []).provenance == before.provenance
    changed = edited(before, [RemoveStrokes(strokes=(1,)), LockStrokes(strokes=(2,))])
    assert changed.provenance == Provenance(version="1", seed=3)
