import re
from pathlib import Path

import pytest

from maulstick.painting.painting import read_painting
from maulstick.style.cards import style_path
from maulstick.style.store import read_style
from tests.cli.conftest import PORTRAIT, paint, run

PEN = ("--ink", "black", "--brush", "fineliner", "--style", "contour", "--px", "64", "--steps", "20")


def test_a_plan_says_that_its_strokes_give_too_little_ink_and_keeps_the_tones_in_its_file(tmp_path: Path) -> None:
    ran = paint(tmp_path / "out", *PEN, "--strokes", "30")
    assert ran.code == 0, ran.stderr
    note = re.search(r"note: 30 strokes of this length give (\d)% of the ink .* ([\d,]+) strokes would", ran.stderr)
    assert note is not None, ran.stderr
    painting = read_painting(tmp_path / "out" / "painting.json")
    assert len(painting.strokes) == 30, "where ink is short, none is left out"
    metrics = painting.provenance.metrics
    assert 80 < metrics["darkest"] < metrics["lightest"] <= 100.01
    assert metrics["psnr_blurred"] > 10


def test_auto_takes_the_strokes_that_the_ink_of_the_picture_needs(tmp_path: Path) -> None:
    ran = paint(tmp_path / "out", *PEN, "--strokes", "auto", "--steps", "2")
    assert ran.code == 0, ran.stderr
    said = re.search(r"note: ([\d,]+) strokes, chosen for the picture's ink", ran.stderr)
    assert said is not None
    assert "would reach" not in ran.stderr
    wanted = read_painting(tmp_path / "out" / "painting.json").provenance.options["strokes"]
    assert wanted == int(said[1].replace(",", ""))
    assert 300 < int(str(wanted)) < 3000


def test_auto_takes_at_most_ten_thousand_strokes_and_says_how_many_there_should_be(tmp_path: Path) -> None:
    words = (
        "--ink",
        "black",
        "--brush",
        "fineliner",
        "--style",
        "marks",
        "--size",
        "2x2m",
        "--px",
        "48",
        "--steps",
        "1",
    )
    ran = run("plan", PORTRAIT, "--out", tmp_path / "out", *words, "--strokes", "auto")
    assert ran.code == 0, ran.stderr
    assert "note: 10,000 strokes, chosen" in ran.stderr
    assert re.search(r"note: 10,000 strokes of this length give \d+% of the ink", ran.stderr)


@pytest.mark.parametrize("words", [(), ("--style", "loops"), ("--ink", "black")])
def test_auto_without_one_ink_in_a_hand_says_what_it_is_for(tmp_path: Path, words: tuple[str, ...]) -> None:
    ran = run("plan", PORTRAIT, "--out", tmp_path / "out", "--strokes", "auto", *words)
    assert ran.code == 2
    assert ran.mistake.startswith(
        "--strokes is auto, which counts strokes of a hand for one ink; give --style and --ink"
    )
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("size", [0.5, 0.9])
def test_a_hand_is_drawn_smaller_as_a_whole(tmp_path: Path, size: float) -> None:
    ran = paint(tmp_path / "out", *PEN, "--strokes", "40", "--hand-size", str(size))
    assert ran.code == 0, ran.stderr
    painting = read_painting(tmp_path / "out" / "painting.json")
    own = read_style(style_path("contour")).lengths(40).sum().item()
    assert painting.lengths().sum() == pytest.approx(size * own, rel=0.02)
    assert painting.provenance.options["hand_size"] == size


@pytest.mark.parametrize("size", ["0", "-1", "99", "nan"])
def test_a_hand_of_no_size_is_refused(tmp_path: Path, size: str) -> None:
    ran = run("plan", PORTRAIT, "--out", tmp_path / "out", "--hand-size", size)
    assert ran.code == 2
    assert "--hand-size" in ran.mistake
    assert "from 0.02 to 50" in ran.mistake
