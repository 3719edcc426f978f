"""Plans with several brushes, from the command to the paper."""

from pathlib import Path

import pytest

from maulstick.painting.brush import load_brush
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import read_painting
from tests.cli.conftest import Ran, paint, run

BOTH = ("--size", "100x80mm", "--brush", "marker,wash", "--paints", "3")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Ran]:
    out = tmp_path_factory.mktemp("brushes")
    return out, paint(out, *BOTH)


@pytest.fixture(scope="module")
def painting(made: tuple[Path, Ran]) -> Painting:
    return read_painting(made[0] / "painting.json")


def test_several_brushes_share_the_paints_that_are_asked_for(made: tuple[Path, Ran], painting: Painting) -> None:
    assert painting.brushes == {"wash": load_brush("wash"), "marker": load_brush("marker")}
    assert len(painting.colours()) <= 3 < len(painting.paints)
    assert "brushes" in made[1].stdout
    assert "strokes (changes: 1)" in made[1].stdout
    assert painting.provenance.options["brush"] == "wash,marker"


def test_a_colour_is_mixed_once_for_all_brushes(made: tuple[Path, Ran], painting: Painting) -> None:
    table = run("mix", made[0] / "painting.json").stdout
    for paint_, metres in painting.colours():
        assert table.count(paint_.hex) == 1
        assert f"{metres:.2f}" in table


def test_the_simulated_easel_changes_brushes_by_itself(made: tuple[Path, Ran]) -> None:
    ran = run("paint", made[0] / "painting.json", "--robot", "sim")
    assert ran.code == 0, ran.stderr
    assert (made[0] / "painting-painted.png").is_file()


def test_a_machines_file_asks_for_each_brush(tmp_path: Path) -> None:
    assert paint(tmp_path, *BOTH, "--robot", "grbl").code == 0
    plan = tmp_path / "painting.json"
    assert run("export", plan, "--format", "gcode").code == 0
    text = (tmp_path / "painting.plot.gcode").read_text()
    for paint_ in read_painting(plan).paints:
        assert f"{paint_.brush} with the paint {paint_.label}" in text


def test_one_tube_is_one_ink_and_drawn_with_one_brush(tmp_path: Path) -> None:
    (tmp_path / "tube.csv").write_text("black,#000000\n")
    ran = run(
        "plan", "--demo", "--brush", "wash,marker", "--paints-from", tmp_path / "tube.csv", "--out", tmp_path / "a"
    )
    assert ran.code == 2
    assert ran.mistake.startswith("--brush wash,marker names several, and ink is drawn with one")


@pytest.mark.parametrize(
    ("words", "fault"),
    [
        (("--brush", "wash,wash"), "the brush wash is named twice; a painting has each brush once"),
        (("--brush", "wash,"), "there is no brush ''; there are: FILE.json, fineliner, "),
        (
            ("--brush", "wash,marker", "--ink", "black"),
            "--brush wash,marker names several, and ink is drawn with one; name one, or paint in colours",
        ),
    ],
)
def test_brushes_that_cannot_be_had_are_one_sentence(tmp_path: Path, words: tuple[str, ...], fault: str) -> None:
    ran = run("plan", "--demo", *words, "--out", tmp_path / "out")
    assert ran.code == 2
    assert fault in ran.mistake
    assert not (tmp_path / "out").exists()
