"""Acts of a person on a plan: kept beside it, undone and redone in any order, and told to pages as marks."""

import asyncio
import json
import resource
from pathlib import Path

import numpy as np
import pytest

from maulstick.errors import InputError, OutputError
from maulstick.painting.brush import load_brush
from maulstick.painting.painting_file import read_painting
from maulstick.studio.panels.direct.chosen import chosen_in_words
from maulstick.studio.state.directing import Directing
from maulstick.studio.state.titles import clean_title
from maulstick.studio.state.versions import version_title
from maulstick.studio.workers.stroke_marks import ShownPaint, as_bytes, changed_marks, drawn_edit, write_edited
from tests.support.robot.small_paintings import SIX, line, painting_of
from tests.support.studio.acting import acting
from tests.support.studio.plans_to_paint import put_plan

_HEAD = 6
_LOCK = {"kind": "lock", "strokes": [10]}
_REMOVE = {"kind": "remove", "strokes": [11]}


def read_back(told: bytes) -> tuple[list[int], dict[int, tuple[int, bool, np.ndarray]]]:
    """Return the order of all strokes, and paint, lock and points (n, 3) in millimetres of those that were told."""
    all_, some, many, left, upper, step = np.frombuffer(told, "<f8", _HEAD)
    at = 8 * _HEAD
    parts = []
    for kind, count in (("<f8", all_), ("<f8", some), ("<u4", some), ("<u2", some), ("<u2", some), ("<u2", some)):
        parts.append(np.frombuffer(told, kind, int(count), at))
        at += parts[-1].nbytes
    points = np.frombuffer(told, "<u2", 3 * int(many), at).reshape(-1, 3) * step + (left, upper, 0)
    assert at + 6 * int(many) == len(told)
    order, ids, counts, paints, _, locks = parts
    own = np.split(points, np.cumsum(counts)[:-1]) if len(counts) else []
    told_of = zip(ids.tolist(), paints.tolist(), locks.tolist(), own, strict=True)
    return order.astype(int).tolist(), {int(id): (paint, bool(lock), each) for id, paint, lock, each in told_of}


def test_marks_are_told_to_a_page_where_the_brush_leaves_them(tmp_path: Path) -> None:
    brush = load_brush("fineliner").model_copy(update={"b_x": 0.001, "m_y": 0.9})
    painting = painting_of([line(7, (0.01, 0.01), (0.03, 0.02)), line(3)], [brush])
    order, told = read_back(as_bytes(painting, painting.strokes))
    assert order == [7, 3]
    for stroke in painting.strokes:
        points, widths, _ = brush.bare_mark(np.array(stroke.trajectory))
        _, _, seen = told[stroke.id]
        assert seen[:, :2] == pytest.approx(1e3 * points, abs=0.01)
        assert (seen[:, 2] < 1e3 * widths).all()
        assert (seen[:, 2] > 0.5e3 * widths).all(), "as wide as an eye sees it"


def test_a_page_is_told_only_what_an_edit_changed(tmp_path: Path) -> None:
    file = put_plan(tmp_path, "six", SIX)
    lock, remove = json.dumps(_LOCK), json.dumps(_REMOVE)
    order, told = read_back(changed_marks(file, (lock, remove), ()))
    assert order == [10, 12, 13, 14, 15]
    assert list(told) == [10]
    assert told[10][1], "it is locked"
    order, told = read_back(changed_marks(file, (), (lock, remove)))
    assert order == [10, 11, 12, 13, 14, 15], "what is undone returns to its place"
    assert sorted(told) == [10, 11]


def test_a_stroke_that_is_drawn_leaves_its_mark_where_the_pointer_was(tmp_path: Path) -> None:
    brush = load_brush("fineliner").model_copy(update={"b_x": 0.001, "b_y": -0.0005, "m_x": 0.9, "m_y": 1.1})
    file = put_plan(tmp_path, "shifted", painting_of([line(0)], [brush]))
    drawn = [(0.01 + 0.0002 * i, 0.02 + 0.0001 * i, 0.5) for i in range(90)]
    edit = json.loads(drawn_edit(file, 0, drawn))
    mark = brush.mark(np.array(edit["trajectory"]))
    assert mark[0, :2] == pytest.approx(drawn[0][:2], abs=2e-6)
    assert mark[-1, :2] == pytest.approx(drawn[-1][:2], abs=2e-6)
    with pytest.raises(InputError, match="paint"):
        drawn_edit(file, 5, drawn)


def test_acts_are_undone_and_redone_also_in_a_later_studio_and_the_plan_stays_as_planned(tmp_path: Path) -> None:
    file = put_plan(tmp_path, "six", SIX)

    async def edit(directing: Directing) -> None:
        await directing.edit(_LOCK)
        await directing.edit(_REMOVE)
        await directing.draw(1, [0.01, 0.01, 0.5, 0.02, 0.02, 0.7])

    assert acting(tmp_path, edit).version == 3

    async def undo(directing: Directing) -> None:
        for _ in range(5):
            await directing.undo()
        assert not directing.can_undo
        await directing.redo()
        await directing.redo()

    assert [json.loads(each)["kind"] for each in acting(tmp_path, undo).edits] == ["lock", "remove"]
    with file.with_name(next(file.parent.glob("edits-*")).name).open("ab") as torn:
        torn.write(b'{"edit": {"kind": "lo')

    async def go_on(directing: Directing) -> None:
        assert directing.can_redo
        await directing.edit({"kind": "repaint", "strokes": [12], "paint": 1})
        assert not directing.can_redo, "after another edit there is nothing to redo"
        await directing.write(tmp_path / "now.json")

    acting(tmp_path, go_on)
    now = {stroke.id: stroke for stroke in read_painting(tmp_path / "now.json").strokes}
    assert sorted(now) == [10, 12, 13, 14, 15]
    assert now[10].locked
    assert now[12].paint == 1
    assert read_painting(file) == SIX


def test_what_is_undone_while_an_act_is_worked_out_is_that_act(tmp_path: Path) -> None:
    put_plan(tmp_path, "six", SIX)

    async def act(directing: Directing) -> None:
        await directing.edit(_LOCK)
        drawn, line = [0.01, 0.01, 0.5, 0.02, 0.02, 0.7], [0.01, 0.01, 0.03, 0.01, 0.03, 0.03]
        for begun in (
            directing.draw(1, drawn),
            directing.saying.enclose(line, bare=False),
            directing.saying.guide(line),
        ):
            await asyncio.gather(begun, directing.undo())
            assert [json.loads(each)["kind"] for each in directing.edits] == ["lock"]
            assert (directing.saying.now.regions, directing.saying.now.guides) == ((), ())
            assert directing.can_redo

    assert acting(tmp_path, act).version == 7


@pytest.mark.parametrize("line", [b'{"edit": {"kind": "of another version"}}', b"\xff", b"[" * 100_000])
def test_a_line_that_is_no_act_is_named_and_no_act_is_lost(tmp_path: Path, line: bytes) -> None:
    file = put_plan(tmp_path, "six", SIX)

    async def lock(directing: Directing) -> None:
        await directing.edit(_LOCK)

    acting(tmp_path, lock)
    (acts,) = file.parent.glob("edits-*")
    content = acts.read_bytes() + line + b"\n" + acts.read_bytes()
    acts.write_bytes(content)
    with pytest.raises(InputError, match=r"line 2 of .*edits-.*\.jsonl is no act that this Maulstick knows; update"):
        acting(tmp_path, _nothing)
    assert acts.read_bytes() == content
    acts.rename(file.with_name("kept.jsonl"))
    assert acting(tmp_path, _nothing).version == 0


def test_an_act_that_the_disk_has_no_room_for_is_told_and_those_before_and_after_it_stay(tmp_path: Path) -> None:
    file = put_plan(tmp_path, "six", SIX)

    async def lock_thrice(directing: Directing) -> None:
        await directing.edit(_LOCK)
        (acts,) = file.parent.glob("edits-*")
        soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (acts.stat().st_size + 9, hard))
        try:
            with pytest.raises(OutputError, match="make room for it there"):
                await directing.edit(_LOCK)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        assert directing.version == 1
        await directing.undo()

    acting(tmp_path, lock_thrice)
    again = acting(tmp_path, _nothing)
    assert (again.version, again.can_redo) == (2, True)


def test_an_act_on_a_plan_that_was_thrown_away_says_so(tmp_path: Path) -> None:
    file = put_plan(tmp_path, "six", SIX)

    async def throw_away(directing: Directing) -> None:
        guide = await directing.saying.guide([0.01, 0.01, 0.02, 0.02])
        file.parent.rename(tmp_path / "away")
        for act in (directing.undo(), directing.edit(_LOCK), directing.saying.take_out(guide)):
            with pytest.raises(InputError, match="that plan is there no more; look in the trash"):
                await act
        (tmp_path / "away").rename(file.parent)
        assert directing.version == 1

    acting(tmp_path, throw_away)


def test_an_edit_that_cannot_be_is_refused_and_not_kept(tmp_path: Path) -> None:
    put_plan(tmp_path, "six", SIX)

    async def act(directing: Directing) -> None:
        for sent in ({"kind": "lock", "strokes": [99]}, {"kind": "paint"}, {"kind": "lock", "strokes": None}):
            with pytest.raises(InputError):
                await directing.edit(sent)
        with pytest.raises(InputError, match="beyond the sheet"):
            await directing.edit({"kind": "move", "strokes": [10], "by": [1.0, 0.0], "turn": 0})
        for points in ([], [0.01, 0.01], [0.0] * 3 * 30_000):
            with pytest.raises(InputError, match="points"):
                await directing.draw(0, points)

    assert acting(tmp_path, act).version == 0


def test_acts_belong_to_the_painting_that_they_were_made_on(tmp_path: Path) -> None:
    file = put_plan(tmp_path, "six", SIX)

    async def lock(directing: Directing) -> None:
        await directing.edit(_LOCK)

    acting(tmp_path, lock)
    planned = file.read_bytes()
    write_edited(file, (json.dumps(_REMOVE),), file)  # as a plan that went on has others
    assert acting(tmp_path, _nothing).version == 0
    file.write_bytes(planned)
    assert acting(tmp_path, _nothing).version == 1


async def _nothing(directing: Directing) -> None:
    pass


def test_what_is_chosen_is_said_in_words() -> None:
    red, blue = ShownPaint("#a02010", "#a02010", "marker", ()), ShownPaint("#0000ff", "sky #0000ff", "round", ())
    assert chosen_in_words(3, [red], 0) == "3 strokes: #a02010, marker"
    assert chosen_in_words(1, [red], 1) == "1 stroke: #a02010, marker; locked"
    assert chosen_in_words(4, [red, blue], 2) == "4 strokes: #a02010, marker and sky #0000ff, round; 2 locked"
    assert chosen_in_words(9, [red] * 4, 0) == "9 strokes of 4 paints"
    assert chosen_in_words(0, [], 0).startswith("Nothing is chosen")


@pytest.mark.parametrize(
    ("title", "others", "next_one"),
    [
        ("Cat", ["Cat", "Dog, version 7"], "Cat, version 2"),
        ("Cat, version 2", ["Cat", "Cat, version 2"], "Cat, version 3"),
        ("Cat", ["Cat", "Cat, version 4"], "Cat, version 5"),
        ("C" * 80, ["C" * 80], "C" * 64 + ", version 2"),
        ("C" * 80, ["C" * 80, "C" * 64 + ", version 2"], "C" * 64 + ", version 3"),
    ],
)
def test_a_version_has_the_next_number(title: str, others: list[str], next_one: str) -> None:
    assert version_title(title, others) == next_one
    assert clean_title(next_one) == next_one, "nothing is cut off where it is kept"
