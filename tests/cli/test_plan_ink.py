import re
from pathlib import Path
from typing import Any

import pytest

from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.prepare import prepare
from maulstick.jobs.plan.request import PlanRequest
from maulstick.painting.painting_file import read_painting
from maulstick.strokes.strokes import write_strokes
from maulstick.style.cards import style_path
from maulstick.style.store import read_style
from tests.cli.conftest import PORTRAIT, paint, run
from tests.support.drawn import as_strokes, hatching

PEN = ("--ink", "black", "--brush", "fineliner", "--style", "contour", "--px", "64", "--steps", "20")


def test_a_plan_says_that_its_strokes_give_too_little_ink_and_keeps_the_tones_in_its_file(tmp_path: Path) -> None:
    ran = paint(tmp_path / "out", *PEN, "--strokes", "30")
    assert ran.code == 0, ran.stderr
    note = re.search(r"note: 30 strokes of this length give (\d)% of the ink .* ([\d,]+) strokes would", ran.stderr)
    assert note is not None, ran.stderr
    painting = read_painting(tmp_path / "out" / "painting.json")
    assert 20 < len(painting.strokes) <= 30, "those that lie astray are left out"
    metrics = painting.provenance.metrics
    assert 80 < metrics["darkest"] < metrics["lightest"] <= 100.01
    assert metrics["psnr_blurred"] > 10
    words = " ".join(ran.stdout.split())
    assert f"beside the picture │ {metrics['psnr']:.1f} dB PSNR" in words
    assert f"in tones │ {metrics['psnr_blurred']:.1f} dB PSNR beside those it was planned in" in words


def test_a_plan_of_which_no_stroke_is_left_says_why_and_what_to_do(tmp_path: Path) -> None:
    ran = paint(tmp_path / "out", *PEN, "--ink", "white", "--strokes", "5")
    assert ran.code == 0, ran.stderr
    assert not read_painting(tmp_path / "out" / "painting.json").strokes
    last = ran.stderr.splitlines()[-1]
    assert last.startswith("note: no stroke is left, for none brings the sheet nearer to what is asked for; take inks")
    assert last.endswith("on its paper, a picture that it does not show yet, or more or larger strokes")
    some = paint(tmp_path / "some", *PEN, "--strokes", "5")
    assert "no stroke is left" not in some.stderr


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
    assert ran.mistake.startswith("--strokes is auto, which counts strokes of a hand for ink; give --style and --ink")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("size", [0.5, 0.9])
def test_a_hand_is_drawn_smaller_as_a_whole(tmp_path: Path, size: float) -> None:
    ran = paint(tmp_path / "out", *PEN, "--strokes", "40", "--exact", "--hand-size", str(size))
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


def test_strokes_that_must_lie_denser_than_the_hands_are_told_and_a_smaller_hand_has_room(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    drawn = tmp_path / "me.strokes.npz"
    write_strokes(as_strokes(hatching(8, seed=0)), drawn)
    assert run("style", "fit", drawn, "--name", "me").code == 0
    words = (*PEN, "--style", "me", "--steps", "3", "--strokes", "300", "--size", "60x48mm")
    ran = paint(tmp_path / "large", *words)
    told = re.search(r"note: 300 strokes lie (\d+) times as densely .* a hand size of (\S+) would", ran.stderr)
    assert told, ran.stderr
    assert float(told[2]) == pytest.approx(int(told[1]) ** -0.5, rel=0.1)
    assert "densely" not in paint(tmp_path / "small", *words, "--hand-size", told[2]).stderr
    assert "densely" not in paint(tmp_path / "unarranged", *words, "--arrange", "0").stderr


def crowded(**asked: Any) -> tuple[str, ...]:
    """Notes of a plan that is not made, in a hand that is arranged."""
    options = PlanOptions(ink="black", brush="fineliner", style="elephant", px=48, device="cpu", **asked)
    return tuple(prepare(PlanRequest(Path(PORTRAIT), options)).notes)


@pytest.mark.parametrize(
    ("strokes", "asked"),
    [
        ("auto", {"size": "60x40mm"}),
        ("auto", {"size": "10x8mm", "hand_size": 50.0}),
        ("auto", {"size": "500x400mm", "hand_size": 1.5}),
        (400, {"size": "60x40mm"}),
    ],
    ids=["ink", "one", "most", "number"],
)
def test_the_hand_size_that_is_told_leaves_the_strokes_just_the_room_that_they_need(
    strokes: int | str, asked: dict[str, Any]
) -> None:
    (note,) = (note for note in crowded(strokes=strokes, **asked) if "densely" in note)
    told = re.search(r"a hand size of (\S+) would leave", note)
    assert told, note
    there = {**asked, "hand_size": float(told[1])}
    assert not [note for note in crowded(strokes=strokes, **there) if "densely" in note]
    larger = {**asked, "hand_size": 2.3 * float(told[1])}
    assert [note for note in crowded(strokes=strokes, **larger) if "densely" in note]


def test_one_stroke_is_told_as_one_and_no_hand_size_is_named_that_is_refused() -> None:
    one = crowded(strokes="auto", size="10x8mm", hand_size=50.0)
    assert "1 stroke, chosen for the picture's ink" in one
    assert any(note.startswith("1 stroke lies ") for note in one)
    (note,) = crowded(strokes=20_000, size="30x20mm")[-1:]
    assert note.endswith("as the hand draws them; no hand size would leave them the room they have there")


@pytest.mark.parametrize("share", ["-0.1", "1.1", "nan"])
def test_a_share_of_arranging_beyond_all_or_nothing_is_refused(tmp_path: Path, share: str) -> None:
    ran = run("plan", PORTRAIT, "--out", tmp_path / "out", "--arrange", share)
    assert ran.code == 2
    assert "--arrange" in ran.mistake
    assert "from 0, not at all, to 1" in ran.mistake


def test_lines_take_less_ink_than_tones(tmp_path: Path) -> None:
    ink = {}
    for drawing in ("lines", "tones"):
        ran = paint(tmp_path / drawing, *PEN, "--strokes", "auto", "--steps", "2", "--drawing", drawing)
        assert ran.code == 0, ran.stderr
        painting = read_painting(tmp_path / drawing / "painting.json")
        assert painting.provenance.options["drawing"] == drawing
        ink[drawing] = painting.lengths().sum()
    assert ink["lines"] < 0.5 * ink["tones"]


def test_a_drawing_that_there_is_not_and_one_without_an_ink_are_refused(tmp_path: Path) -> None:
    ran = run("plan", PORTRAIT, "--out", tmp_path / "out", *PEN, "--drawing", "dots")
    assert (ran.code, ran.mistake) == (2, "there is no drawing 'dots'; there are: both, lines, tones")
    ran = run("plan", PORTRAIT, "--out", tmp_path / "out", "--drawing", "lines")
    assert (ran.code, ran.mistake) == (2, "--drawing lines is for ink; give --ink, or leave it out")


def test_several_inks_are_pens_of_one_kind_in_an_order_from_light_to_dark(tmp_path: Path) -> None:
    ran = paint(tmp_path / "out", *PEN, "--style", "elephant", "--strokes", "60", "--ink", "black, #d2691e")
    assert ran.code == 0, ran.stderr
    assert "note: 60 strokes of this length give" in ran.stderr
    painting = read_painting(tmp_path / "out" / "painting.json")
    assert [paint.hex for paint in painting.paints] == ["#d2691e", "#000000"]
    assert {paint.brush for paint in painting.paints} == {"fineliner"}
    assert {stroke.paint for stroke in painting.strokes} == {0, 1}
    assert painting.succession is not None, "drawn as the hand goes on from stroke to stroke"
    assert painting.provenance.metrics["darkest"] < painting.provenance.metrics["lightest"]


@pytest.mark.parametrize(
    ("inks", "said"),
    [
        ("black,#000000", "--ink black,#000000 names one colour twice; name each once"),
        ("black,pale", "'pale' is not a colour; write a name such as black, or #rrggbb"),
        (
            ",".join(f"#00000{n:x}" for n in range(13)),
            "the number of colours of --ink is 13; it must be at most 12",
        ),
        ("black,", "'' is not a colour; write a name such as black, or #rrggbb"),
    ],
)
def test_inks_that_are_named_twice_or_are_no_colours_are_refused(tmp_path: Path, inks: str, said: str) -> None:
    ran = run("plan", PORTRAIT, "--out", tmp_path / "out", "--ink", inks)
    assert (ran.code, ran.mistake) == (2, said)
    assert not (tmp_path / "out").exists()


def test_lines_of_a_text_are_refused(tmp_path: Path) -> None:
    ran = run("plan", "--text", "a boat", "--ink", "black", "--drawing", "lines", "--out", tmp_path / "out")
    assert (ran.code, ran.mistake) == (2, "--drawing lines draws those of a picture; name one, or leave it out")
