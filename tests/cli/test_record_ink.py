from pathlib import Path

import numpy as np
import pytest

from maulstick.strokes.ink import read_ink
from maulstick.strokes.strokes import read_strokes
from tests.cli.conftest import run

EVENTS = """{"schema_version": 1, "size_mm": [200, 150], "strokes": [
[{"timeStamp": 1000, "x": 20, "y": 40, "pressure": 0.25}, {"timeStamp": 3500, "x": 120, "y": 40, "pressure": 0.5}],
[{"timeStamp": 4000, "x": 20, "y": 40, "pressure": 0.5}]]}"""
SVG = '<svg viewBox="0 0 10 10"><path d="M0 0L10 5M0 0L10 5"/></svg>'


@pytest.fixture
def drawing(tmp_path: Path) -> Path:
    path = tmp_path / "drawing.json"
    path.write_text(EVENTS)
    return path


@pytest.fixture
def vectors(tmp_path: Path) -> Path:
    path = tmp_path / "drawing.svg"
    path.write_text(SVG)
    return path


def test_a_drawing_becomes_ink_and_what_was_read_is_told(drawing: Path) -> None:
    out = drawing.with_name("cat.ink.npz")
    ran = run("record", "ink", drawing, "--out", out)
    told = "pointer events: 2 strokes, 0.1 m drawn on 200 x 150 mm, 3 s, pressure recorded in 1 of them"
    assert ran == (0, f"{told}\n{out}\n", "")
    ink = read_ink(out)
    assert ink.samples[:2] == pytest.approx(np.array([[0, 0.02, 0.04, 0.25], [2.5, 0.12, 0.04, 0.5]]))
    assert (ink.size, ink.source) == ((0.2, 0.15), "drawing.json")


def test_ink_goes_here_under_the_drawings_name(drawing: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    assert run("record", "ink", drawing).stdout.endswith("\ndrawing.ink.npz\n")
    assert len(read_ink("drawing.ink.npz")) == 2
    again = run("record", "ink", drawing)
    assert again.mistake == "drawing.ink.npz is already there; choose another --out, or add --overwrite"


def test_a_folder_that_cannot_be_written_is_refused_before_anything_is_read(drawing: Path) -> None:
    ran = run("record", "ink", drawing.with_name("none.json"), "--out", drawing / "cat.ink.npz")
    assert ran.code == 1
    assert ran.mistake.startswith(f"cannot write into the folder {drawing}: ")


def test_a_folder_that_is_not_there_is_made_and_left_only_with_ink_in_it(drawing: Path) -> None:
    out = drawing.with_name("new") / "cat.ink.npz"
    assert run("record", "ink", drawing.with_name("none.json"), "--out", out).code == 2
    assert not out.parent.exists()
    assert run("record", "ink", drawing, "--out", out).code == 0
    assert len(read_ink(out)) == 2


def test_vectors_without_a_scale_are_150_mm_long(vectors: Path) -> None:
    ran = run("record", "ink", vectors, "--out", vectors.with_name("cat.ink.npz"))
    assert ran.stdout.startswith(
        "SVG: 2 strokes, 0.335 m drawn on 165 x 90 mm, times not recorded, pressure not recorded\n"
    )
    assert ran.stderr == (
        "note: drawing.svg does not say how large it was drawn: its longer side is taken to be 150 mm; say it with "
        "--size or --longest\n"
    )


def test_size_and_longest_set_the_scale(vectors: Path) -> None:
    for words, told in (
        (("--longest", "30cm"), "0.671 m drawn on 330 x 180 mm"),
        (("--longest", "300"), "0.671 m drawn on 330 x 180 mm"),
        (("--size", "A4-landscape"), "0.604 m drawn on 297 x 210 mm"),
    ):
        ran = run("record", "ink", vectors, "--out", vectors.with_name("cat.ink.npz"), "--overwrite", *words)
        assert (ran.code, ran.stderr) == (0, "")
        assert told in ran.stdout


def test_a_name_that_ends_in_strokes_gets_strokes(drawing: Path) -> None:
    out = drawing.with_name("cat.strokes.npz")
    assert run("record", "ink", drawing, "--out", out).code == 0
    assert read_strokes(out).lengths == pytest.approx([0.1, 0])


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("--longest", "9mm", "--size", "A4"), "--size and --longest cannot both be kept; give one of them"),
        (("--longest", "0mm"), "--longest is 0mm; it must be between 1 mm and 50 m"),
        (("--longest", "51m"), "--longest is 51m; it must be between 1 mm and 50 m"),
        (("--longest", "long"), "'long' is not a length; write a number and a unit, as in 139mm, 13.9cm or 5.5in"),
        (
            ("--size", "A1"),
            "'A1' is not a size; write width x height and a unit, as in 200x160mm, or one of A2, A3, A4,",
        ),
    ],
)
def test_options_without_sense_are_refused(drawing: Path, words: tuple[str, ...], text: str) -> None:
    out = drawing.with_name("cat.ink.npz")
    ran = run("record", "ink", drawing, "--out", out, *words)
    assert ran.code == 2
    assert ran.mistake.startswith(text)
    assert not out.exists()


def test_a_file_that_is_there_is_replaced_only_when_told_to(drawing: Path) -> None:
    out = drawing.with_name("cat.ink.npz")
    out.write_bytes(b"before")
    ran = run("record", "ink", drawing, "--out", out)
    assert ran.code == 1
    assert ran.mistake == f"{out} is already there; choose another --out, or add --overwrite"
    assert out.read_bytes() == b"before"
    assert run("record", "ink", drawing, "--out", out, "--overwrite").code == 0
    assert len(read_ink(out)) == 2


def test_a_result_of_another_name_is_refused(drawing: Path) -> None:
    ran = run("record", "ink", drawing, "--out", drawing.with_name("cat.npz"))
    assert ran.code == 2
    assert "let its name end in .ink.npz for the ink, or in .strokes.npz for its strokes" in ran.mistake


def test_a_drawing_that_cannot_be_read_is_one_line_and_leaves_nothing(drawing: Path) -> None:
    drawing.write_text(EVENTS[:-9])
    ran = run("record", "ink", drawing, "--out", drawing.with_name("cat.ink.npz"))
    assert ran.code == 2
    assert ran.mistake.startswith(f"cannot read {drawing} as pointer events: the file: Invalid JSON: EOF while parsing")
    assert [path.name for path in drawing.parent.iterdir()] == ["drawing.json"]
