"""Editing a plan by hand, and planning the rest again."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import read_painting
from tests.cli.conftest import PORTRAIT, QUICK, RESULTS, run
from tests.support.tolerances import FILE_METRES

DRAWN = {
    "schema_version": 1,
    "size_mm": [200, 160],
    "strokes": [[{"timeStamp": 10 * i, "x": 20 + i, "y": 30, "pressure": 0.4} for i in range(5)]],
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a picture, its plan of 20 strokes in ``plan``, and a drawn line."""
    folder = tmp_path_factory.mktemp("edit")
    shutil.copy(PORTRAIT, folder / "portrait.png")
    words = ("--exact", "--paints", "3", "--style", "loops", "--out", folder / "plan")
    assert run("plan", folder / "portrait.png", *QUICK, *words).code == 0
    (folder / "line.json").write_text(json.dumps(DRAWN))
    return folder


def edited(folder: Path, *words: str | Path) -> Painting:
    ran = run("edit", folder / "plan" / "painting.json", *words, "--out", folder / "edited.json", "--overwrite")
    assert ran.code == 0, ran.stderr
    return read_painting(folder / "edited.json")


def refusal(folder: Path, *words: str | Path) -> str:
    ran = run("edit", folder / "plan" / "painting.json", *words, "--out", folder / "refused.json")
    assert ran.code == 2
    assert not (folder / "refused.json").exists()
    return ran.mistake


def test_strokes_are_edited_and_the_rest_is_planned_again_around_them(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder)
    before = edited(
        folder, "--lock", "1,3-5", "--remove", "7", "--move", "8:2.5,-1", "--turn", "9:30", "--repaint", "10:2",
        "--add", f"1:{folder / 'line.json'}",
    )  # fmt: skip
    locked = {stroke.id: stroke.trajectory for stroke in before.strokes if stroke.locked}
    assert sorted(locked) == [1, 3, 4, 5, 8, 9, 10, 20]
    assert np.abs(np.array(locked[20])[:, :2] - [(0.02 + 0.001 * i, 0.03) for i in range(5)]).max() < FILE_METRES
    ran = run("plan", "--again", "edited.json", "--steps", "3", "--out", "again")
    assert ran.code == 0, ran.stderr
    after = read_painting(folder / "again" / "painting.json")
    assert {stroke.id: stroke.trajectory for stroke in after.strokes if stroke.locked} == locked
    assert after.provenance.options["style"] == "loops"
    assert after.provenance.options["steps"] == 3
    assert len(after.strokes) == 20
    assert sorted(path.name for path in (folder / "again").iterdir()) == RESULTS


def test_what_is_planned_again_is_not_written_over(folder: Path) -> None:
    before = (folder / "plan" / "painting.json").read_bytes()
    ran = run("plan", "--again", folder / "plan" / "painting.json", "--out", folder / "plan", "--overwrite")
    assert ran.mistake == (
        f"{folder / 'plan' / 'painting.json'} is planned again, and the results in {folder / 'plan'} would replace it; "
        "name another --out"
    )
    assert (folder / "plan" / "painting.json").read_bytes() == before


def test_all_strokes_are_locked_at_once(folder: Path) -> None:
    assert all(stroke.locked for stroke in edited(folder, "--lock", "all").strokes)


def test_strokes_that_are_named_by_an_edit_twice_are_all_edited(folder: Path) -> None:
    after = edited(folder, "--lock", "1", "--lock", "2,4", "--remove", "7", "--remove", "8")
    assert [stroke.id for stroke in after.strokes if stroke.locked] == [1, 2, 4]
    assert {7, 8}.isdisjoint(stroke.id for stroke in after.strokes)


def test_strokes_are_unlocked_before_others_are_locked(folder: Path) -> None:
    assert edited(folder, "--lock", "1,3-5").strokes
    after = edited(folder, "--unlock", "all", "--lock", "2")
    assert [stroke.id for stroke in after.strokes if stroke.locked] == [2]


def test_an_edit_says_what_it_wrote(folder: Path) -> None:
    ran = run("edit", folder / "plan" / "painting.json", "--lock", "0-3", "--out", folder / "said.json")
    assert ran.stdout == f"{folder / 'said.json'}: 20 strokes, 4 of them locked\n"
    again = run("edit", folder / "plan" / "painting.json", "--lock", "0-3", "--out", folder / "said.json")
    assert again.mistake == f"{folder / 'said.json'} is already there; choose another --out, or add --overwrite"


def test_strokes_of_a_painting_without_any_cannot_be_named(folder: Path) -> None:
    (folder / "bare.json").unlink(missing_ok=True)
    assert run("edit", folder / "plan" / "painting.json", "--remove", "all", "--out", folder / "bare.json").code == 0
    for words in (("--lock", "all"), ("--remove", "3"), ("--move", "all:1,1")):
        ran = run("edit", folder / "bare.json", *words, "--out", folder / "refused.json")
        assert ran.mistake == (f"{words[0]} names strokes, and there are none in this painting; draw some with --add")


@pytest.mark.parametrize(
    ("words", "text"),
    [
        ((), "there is nothing to change; give --lock, --remove or another edit"),
        (("--lock", "1,x"), "--lock names 'x'; strokes are named by their ids, as in 3,7-12, or a region's name"),
        (("--remove", "9-3"), "--remove names '9-3'; a range goes from a smaller id to a larger one, as in 7-12"),
        (("--remove", "0-99999999"), "there is no stroke 20 in the painting; name strokes by their ids"),
        (("--lock", "9" * 5000), "--lock names '999"),
        (("--add", f"{'9' * 5000}:line.json"), "--add is '999"),
        (("--lock", "99"), "there is no stroke 99 in the painting; name strokes by their ids"),
        (("--repaint", "1"), "--repaint is '1'; it must be like 12,15-20:3"),
        (("--lock", "²"), "--lock names '²'; strokes are named by their ids"),
        (("--add", "²:line.json"), "--add is '²:line.json'; it must be a paint's number and a file"),
        (("--move", "nose:1,1"), "--move names 'nose'; strokes are named by their ids, as in 3,7-12, or a region's"),
        (("--turn", "9-3:30"), "--turn names '9-3'; a range goes from a smaller id to a larger one, as in 7-12"),
        (("--repaint", "1:²"), "--repaint is '1:²'; it must be like 12,15-20:3"),
        (("--repaint", "1:9"), "the paint is 9; it must be from 1 to 3"),
        (("--move", "1:2"), "--move is '1:2'; it must be like 12:2.5,-1"),
        (("--move", "1:900,0"), "stroke 1 reaches "),
        (("--move", "1:nan,0"), "--move is '1:nan,0'; it must be like 12:2.5,-1"),
        (("--turn", "1:right"), "--turn is '1:right'; it must be like 12-14:30"),
        (("--turn", "1:inf"), "--turn is '1:inf'; it must be like 12-14:30"),
        (("--add", "line.json"), "--add is 'line.json'; it must be a paint's number and a file, as in 2:signature"),
        (("--add", "1:nothing.json"), "there is no drawing nothing.json; check its name and folder"),
    ],
)
def test_an_edit_that_cannot_be_made_is_refused(folder: Path, words: tuple[str, ...], text: str) -> None:
    assert refusal(folder, *words).startswith(text)


@pytest.mark.parametrize(
    ("out", "text"),
    [
        ("edited.svg", "--out is edited.svg; a painting is written as JSON, so let its name end in .json"),
        ("no/edited.json", "cannot write no/edited.json: its folder does not exist; make the folder first"),
    ],
)
def test_a_painting_is_not_written_where_nobody_reads_it(
    folder: Path, monkeypatch: pytest.MonkeyPatch, out: str, text: str
) -> None:
    monkeypatch.chdir(folder)
    assert run("edit", "plan/painting.json", "--lock", "all", "--out", out).mistake == text
    assert not Path(out).exists()


def test_a_drawing_that_does_not_say_how_large_it_is_is_added_with_a_note(folder: Path) -> None:
    drawn = '<svg xmlns="http://www.w3.org/2000/svg" {}><path d="M10 10h90"/></svg>'
    notes = []
    for name, size in (("sized", 'width="100mm" height="80mm" viewBox="0 0 100 80"'), ("unsized", "")):
        (folder / f"{name}.svg").write_text(drawn.format(size))
        words = ("--add", f"1:{folder / name}.svg", "--out", folder / f"{name}.json")
        ran = run("edit", folder / "plan" / "painting.json", *words)
        assert ran.code == 0, ran.stderr
        notes.append(ran.stderr)
    assert notes == [
        "",
        "note: unsized.svg does not say how large it was drawn: its longer side is taken to be 150 mm; "
        "say it with maulstick record ink --size, and add that ink\n",
    ]
    words = ("--size", "120x60mm", "--out", folder / "mine.ink.npz")
    assert run("record", "ink", folder / "unsized.svg", *words).code == 0
    ran = run(
        "edit", folder / "plan" / "painting.json", "--add", f"1:{folder}/mine.ink.npz", "--out", folder / "m.json"
    )
    assert (ran.code, ran.stderr) == (0, "")
    lengths = [read_painting(folder / f"{name}.json").lengths().max() for name in ("unsized", "m")]
    assert lengths[0] > lengths[1]


def test_a_drawing_that_is_added_is_not_written_over(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    before = Path("line.json").read_bytes()
    words = ("--add", f"1:{folder / 'line.json'}", "--out", "line.json", "--overwrite")
    ran = run("edit", "plan/painting.json", *words)
    assert (ran.code, ran.mistake) == (2, "--out is line.json, a drawing that --add names; choose another --out")
    assert Path("line.json").read_bytes() == before


def test_it_must_be_said_where_to_write(folder: Path) -> None:
    ran = run("edit", folder / "plan" / "painting.json", "--lock", "1")
    assert ran.mistake == "name the file to write, with --out cat/mine.json"


@pytest.mark.parametrize("words", [("--paints", "4"), ("--pin", "red")])
def test_what_a_painting_has_settled_is_not_said_again(folder: Path, words: tuple[str, str]) -> None:
    ran = run("plan", "--again", folder / "plan" / "painting.json", *words, "--out", folder / "no")
    assert ran.mistake == f"--again keeps the sheet, the paints and the pressure of the painting; leave out {words[0]}"
