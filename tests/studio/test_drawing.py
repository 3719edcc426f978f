"""Drawing on the sheet, without a page."""

import asyncio
import json
from collections.abc import Callable, Coroutine
from pathlib import Path
from random import Random
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from maulstick.errors import InputError, OutputError
from maulstick.recording.files.ink_files import read_ink_file
from maulstick.strokes.ink import Ink, read_ink, write_ink
from maulstick.studio.state.drawing import USUAL_SHEET, Drawing
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.hands import Hands
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.drawn_sheet import MOST_OF_A_STROKE, DrawnStroke, read_sheet, sheet_json
from maulstick.studio.workers.hand_work import DRAWING, INK, PICTURE, keep_drawing, learn, take_in
from tests.support.tolerances import INK_FILE_METRES

A6 = 0.105, 0.148
LINE = [0.0, 10, 10, 0.2, 5, -5, 8.0, 20, 15, 0.7, 6, -6]


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    for kind in ("hands", "trash"):
        (tmp_path / kind).mkdir()
    return Folder(tmp_path)


def at_the_desk(folder: Folder, work: Callable[[Drawing], Coroutine[None, None, None]]) -> Drawing:
    """Apply the work to a drawing, and return it once all of it is on disk."""

    async def working() -> Drawing:
        desk = Desk()
        drawing = Drawing(folder, desk)
        try:
            await work(drawing)
            await drawing.close()
        finally:
            desk.close()
        return drawing

    return asyncio.run(working())


def drawn(folder: Folder, strokes: int) -> Drawing:
    async def work(drawing: Drawing) -> None:
        for id in range(1000, 1000 + strokes):
            drawing.add(id, LINE)

    return at_the_desk(folder, work)


points = st.tuples(
    st.floats(0, 1e12),
    st.floats(0, 105),
    st.floats(0, 148),
    st.floats(0, 1),
    st.integers(-90, 90),
    st.integers(-90, 90),
)


@given(st.lists(st.lists(points, min_size=1, max_size=5), min_size=1, max_size=5))
@settings(max_examples=30, deadline=None)
def test_a_sheet_is_read_back_as_it_was_written_and_is_ink(
    tmp_path_factory: pytest.TempPathFactory, strokes: list[list[tuple[float, ...]]]
) -> None:
    kept = [DrawnStroke.of([n for point in sorted(stroke) for n in point], A6) for stroke in strokes]
    path = tmp_path_factory.mktemp("sheet") / DRAWING
    path.write_bytes(sheet_json(A6, kept))
    again = read_sheet(path)
    assert again.size == pytest.approx(A6)
    assert [stroke.points.tolist() for stroke in again.strokes] == [stroke.points.tolist() for stroke in kept]
    ink, kind = read_ink_file(path)
    assert kind == "pointer events"
    for seen, stroke in zip(ink.strokes(), kept, strict=True):
        np.testing.assert_allclose(seen[:, 1:3], stroke.points[:, 1:3] * 1e-3, atol=INK_FILE_METRES)


@pytest.mark.parametrize(
    ("numbers", "sentence"),
    [
        ("<script>", "that is no stroke"),
        ([], "that is no stroke"),
        (LINE[:-1], "that is no stroke"),
        (LINE * MOST_OF_A_STROKE, f"the points of a stroke is 20000; it must be at most {MOST_OF_A_STROKE}"),
        ([*LINE[:-1], None], "something that is no number"),
        ([*LINE[:-1], "6"], "something that is no number"),
        ([*LINE[:-1], True], "something that is no number"),
        ([*LINE[:-1], 10**400], "beyond all measure"),
        ([*LINE[:-1], float("nan")], "tiltY of a point of a stroke is nan"),
        ([0, 105.1, 10, 0.5, 0, 0], "x of a point of a stroke is 105.1; it must be from -0.001 to 105.001"),
        ([0, 10, -3, 0.5, 0, 0], "y of a point of a stroke is -3"),
        ([0, 10, 10, 1.5, 0, 0], "pressure of a point of a stroke is 1.5; it must be from 0 to 1"),
        ([*LINE[6:], *LINE[:6]], "the times of a stroke run backwards"),
    ],
)
def test_what_cannot_be_a_stroke_is_refused_with_a_reason(numbers: object, sentence: str) -> None:
    with pytest.raises(InputError) as refused:
        DrawnStroke.of(numbers, A6)
    assert sentence in str(refused.value)


@pytest.mark.parametrize("id", [None, "1", True, -1, 2**53, 1.0])
def test_a_stroke_needs_a_number_of_its_own(folder: Folder, id: object) -> None:
    async def work(drawing: Drawing) -> None:
        drawing.add(1000, LINE)
        for taken in (id, 1000):
            with pytest.raises(InputError, match="has no number of its own"):
                drawing.add(taken, LINE)

    assert list(at_the_desk(folder, work).strokes) == [1000]


def test_a_flood_of_strokes_is_refused_before_any_of_it_is_kept(folder: Folder) -> None:
    async def work(drawing: Drawing) -> None:
        with patch("maulstick.studio.state.drawing.MOST_STROKES", 3):
            for id in range(10):
                if id < 3:
                    drawing.add(1000 + id, LINE)
                else:
                    with pytest.raises(InputError, match="the sheet is full; begin a new one"):
                        drawing.add(1000 + id, LINE)
        with (
            patch("maulstick.studio.state.drawing.MOST_POINTS", 6),
            pytest.raises(InputError, match="the sheet is full"),
        ):
            drawing.add(2000, LINE)

    assert len(at_the_desk(folder, work).strokes) == 3


def test_undoing_all_and_doing_it_again_passes_the_same_sheets(folder: Folder) -> None:
    async def work(drawing: Drawing) -> None:
        rng = Random(7)
        passed = [list(drawing.strokes)]
        for id in range(1000, 1060):
            if drawing.strokes and rng.random() < 0.4:
                drawing.rub_out(rng.choice(list(drawing.strokes)))
            else:
                drawing.add(id, LINE)
            passed.append(list(drawing.strokes))
        for sheet in reversed(passed[:-1]):
            drawing.undo()
            assert list(drawing.strokes) == sheet
        assert not drawing.can_undo
        for sheet in passed[1:]:
            drawing.redo()
            assert list(drawing.strokes) == sheet
        assert not drawing.can_redo
        drawing.undo()
        drawing.add(5000, LINE)
        assert not drawing.can_redo

    at_the_desk(folder, work)


def test_everybody_is_told_of_each_stroke_once(folder: Folder) -> None:
    told: list[tuple[str, int]] = []

    async def work(drawing: Drawing) -> None:
        drawing.added.subscribe(lambda id, stroke: told.append(("added", id)))
        drawing.removed.subscribe(lambda id: told.append(("removed", id)))
        drawing.add(1000, LINE)
        drawing.rub_out(1000)
        drawing.rub_out(1000)
        drawing.rub_out("1000")
        drawing.undo()

    at_the_desk(folder, work)
    assert told == [("added", 1000), ("removed", 1000), ("added", 1000)]


def test_all_that_one_swipe_rubbed_out_is_undone_at_once_and_nothing_is_ever_past_undoing(folder: Folder) -> None:
    async def work(drawing: Drawing) -> None:
        for id in range(1000, 1150):
            drawing.add(id, LINE)
        whole = list(drawing.strokes)
        for id in range(1000, 1120):
            drawing.rub_out(id, 7)
        drawing.rub_out(1130, 8)
        drawing.undo()
        assert len(drawing.strokes) == 30
        drawing.undo()
        assert list(drawing.strokes) == whole
        drawing.redo()
        assert len(drawing.strokes) == 30
        drawing.undo()
        for _ in range(150):
            drawing.undo()
        assert not drawing.strokes
        assert not drawing.can_undo

    at_the_desk(folder, work)


def test_a_drawing_is_there_again_after_a_restart(folder: Folder) -> None:
    async def work(drawing: Drawing) -> None:
        await drawing.rename("My Cat")
        drawing.add(1000, LINE)
        drawing.add(1001, LINE[:6])

    before = at_the_desk(folder, work)
    again = Drawing(folder, Desk())
    assert (again.name, again.title, again.size, again.trouble) == ("my-cat", "My Cat", before.size, "")
    assert [stroke.text for stroke in again.strokes.values()] == [stroke.text for stroke in before.strokes.values()]
    assert not again.can_undo


def test_a_damaged_drawing_is_left_where_it_is_and_told_of(folder: Folder) -> None:
    drawn(folder, 2)
    path = folder.of("hands", "my-hand") / DRAWING
    path.write_text('{"size_mm": [1')
    again = Drawing(folder, Desk())
    assert again.strokes == {}
    assert again.name == "my-hand-2"
    assert "is not a drawing of the studio" in again.trouble
    assert path.read_text() == '{"size_mm": [1'


def test_a_hand_is_never_drawn_over_another_that_took_its_name(folder: Folder) -> None:
    async def work(drawing: Drawing) -> None:
        folder.of("hands", drawing.name).mkdir()
        drawing.add(1000, LINE)

    assert at_the_desk(folder, work).name == "my-hand-2"
    assert len(read_sheet(folder.of("hands", "my-hand-2") / DRAWING).strokes) == 1
    assert list(folder.of("hands", "my-hand").iterdir()) == []


def test_a_hand_that_another_page_threw_away_is_kept_anew_once_one_draws_on(folder: Folder) -> None:
    async def work(drawing: Drawing) -> None:
        drawing.add(1000, LINE)
        await drawing.close()
        folder.throw_away(folder.of("hands", "my-hand"))
        drawing.add(1001, LINE)
        await drawing.close()
        assert drawing.trouble == ""
        folder.throw_away(folder.of("hands", "my-hand"))
        await drawing.rename("cat")
        drawing.add(1002, LINE)

    assert at_the_desk(folder, work).name == "cat"
    assert len(read_sheet(folder.of("hands", "cat") / DRAWING).strokes) == 3


def test_a_full_disk_is_told_of_and_the_sheet_stays(folder: Folder) -> None:
    async def work(drawing: Drawing) -> None:
        with patch("maulstick.studio.state.drawing.atomic_write", side_effect=OutputError("the disk is full")):
            drawing.add(1000, LINE)
            with pytest.raises(OutputError, match="the disk is full"):
                await drawing.begin(A6)
            assert drawing.trouble == "the disk is full"
        assert list(drawing.strokes) == [1000]
        await drawing.close()
        assert drawing.trouble == ""

    at_the_desk(folder, work)
    assert len(read_sheet(folder.of("hands", "my-hand") / DRAWING).strokes) == 1


def test_a_sheet_that_is_put_away_is_a_hand_with_ink_and_can_be_had_again(folder: Folder) -> None:
    async def work(drawing: Drawing) -> None:
        drawing.add(1000, LINE)
        drawing.add(1001, LINE)
        await drawing.begin(A6)
        assert (drawing.name, drawing.size, drawing.strokes) == ("my-hand-2", A6, {})
        card = drawing.hands.card("my-hand")
        assert card is not None
        assert card.strokes == 2
        trashed = await drawing.throw_away("my-hand")
        assert drawing.hands.names() == []
        drawing.hands.take_back(trashed)
        await drawing.open("my-hand")
        assert (drawing.name, drawing.size, len(drawing.strokes)) == ("my-hand", pytest.approx(USUAL_SHEET), 2)

    at_the_desk(folder, work)
    ink = read_ink(folder.of("hands", "my-hand") / INK)
    assert ink.size == pytest.approx(USUAL_SHEET)
    np.testing.assert_allclose(ink.strokes()[1][:, 3], [0.2, 0.7])


def test_a_recording_becomes_a_hand_and_a_broken_one_leaves_nothing(folder: Folder, tmp_path: Path) -> None:
    file, hand = tmp_path / ".incoming", folder.of("hands", "cat")
    file.write_text('<svg xmlns="http://www.w3.org/2000/svg" width="50mm" height="50mm"><path d="M1 1L9 9"/></svg>')
    take_in(file, "cat.svg", None, hand)
    assert len(read_ink(hand / INK)) == 1
    write_ink(Ink.of([np.array([[0.0, 0.01, 0.01, 0.5], [1.0, 0.02, 0.02, 0.5]])], A6), file)
    take_in(file, "dog.ink.npz", None, folder.of("hands", "dog"))
    assert len(read_ink(folder.of("hands", "dog") / INK)) == 1
    for content, called, sentence in (
        ("<svg >", "../../evil.svg", "cannot read ../../evil.svg as SVG"),
        ("", "empty.uim", "the file empty.uim is empty"),
        ("Format Version,1.23", "take.csv", "needs the pen's length"),
        ("hello", "notes.txt", "notes.txt is none of the drawings that can be read"),
    ):
        file.write_text(content)
        with pytest.raises(InputError) as refused:
            take_in(file, called, None, folder.of("hands", "bird"))
        assert sentence in str(refused.value)
        assert str(tmp_path) not in str(refused.value)
    assert folder.names("hands") == ["cat", "dog"]


def test_recordings_of_one_name_that_come_at_once_are_two_hands(folder: Folder, tmp_path: Path) -> None:
    (file := tmp_path / ".incoming").write_text('<svg xmlns="http://www.w3.org/2000/svg"><path d="M1 1L9 9"/></svg>')

    async def work(drawing: Drawing) -> None:
        await asyncio.gather(*(drawing.hands.take_in(file, "cat.svg", None) for _ in range(2)))

    hands = at_the_desk(folder, work).hands
    assert hands.titles() == {"cat": "cat", "cat-2": "cat 2"}


def test_what_is_drawn_stays_where_its_hand_is_opened_twice_at_once(folder: Folder) -> None:
    drawn(folder, 3)

    async def work(drawing: Drawing) -> None:
        await drawing.begin(A6)
        new = iter([2000])
        drawing.renewed.subscribe(lambda: [drawing.add(id, LINE) for id in new])  # once it lies there, and once alone
        await asyncio.gather(drawing.open("my-hand"), drawing.open("my-hand"))

    assert len(at_the_desk(folder, work).strokes) == 4


@pytest.mark.parametrize(
    ("size", "notes"),
    [
        ("", ("cat.svg does not say how large it was drawn: its longer side is taken to be 150 mm",)),
        ('width="5cm" height="5cm"', ()),
    ],
)
def test_the_card_of_a_recording_says_where_its_scale_is_not_known(
    folder: Folder, tmp_path: Path, size: str, notes: tuple[str, ...]
) -> None:
    file = tmp_path / ".incoming"
    file.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 50 50" {size}><path d="M1 1L9 9"/></svg>')
    take_in(file, "cat.svg", None, folder.of("hands", "cat"))
    card = Hands(folder, Desk()).card("cat")
    assert card is not None
    assert card.notes == notes


def test_a_web_pages_drawing_can_be_drawn_on_where_it_fits_the_sheet(folder: Folder, tmp_path: Path) -> None:
    file, line = tmp_path / ".incoming", [{"timeStamp": 9.0 * i, "x": 10 + i, "y": 20, "pressure": 0.4} for i in (0, 1)]
    for name, strokes in {
        "fits": [line] * 3,
        "beside": [[*line, {**line[1], "x": 9000}]],
        "full": [line] * 2001,
    }.items():
        file.write_text(json.dumps({"schema_version": 1, "size_mm": [200, 150], "strokes": strokes}))
        take_in(file, f"{name}.json", None, folder.of("hands", name))
        assert len(read_ink(folder.of("hands", name) / INK)) == len(strokes)

    async def work(drawing: Drawing) -> None:
        assert [name for name in ("fits", "beside", "full") if drawing.hands.is_drawn(name)] == ["fits"]
        await drawing.open("fits")
        drawing.add(1000, LINE)

    drawing = at_the_desk(folder, work)
    assert (drawing.size, len(drawing.strokes)) == (pytest.approx((0.2, 0.15)), 4)


def test_too_few_strokes_make_no_style(folder: Folder) -> None:
    hand = folder.of("hands", "four")
    hand.mkdir()
    write_ink(Ink.of([np.array([[0, 0.01, 0.01, 0.5], [1, 0.02, 0.02, 0.5]])] * 4, A6), hand / INK)
    with pytest.raises(InputError, match=r"^draw at least 5 strokes; there are 4$"):
        learn(hand, "four", "Four")


def test_the_picture_of_a_hand_is_as_fine_as_a_machines(folder: Folder) -> None:
    drawn(folder, 1)
    keep_drawing(hand := folder.of("hands", "my-hand"))
    with Image.open(hand / PICTURE) as picture:
        assert picture.size == (1024, round(1024 * USUAL_SHEET[1] / USUAL_SHEET[0]))
        assert picture.getextrema() == ((30, 255),) * 3


def test_the_file_is_the_documented_one(folder: Folder) -> None:
    drawn(folder, 1)
    record = json.loads((folder.of("hands", "my-hand") / DRAWING).read_text())
    assert record["schema_version"] == 1
    assert record["size_mm"] == [210.0, 148.0]
    first = {"timeStamp": 0.0, "x": 10.0, "y": 10.0, "pressure": 0.2, "tiltX": 5.0, "tiltY": -5.0}
    assert record["strokes"][0][0] == first
