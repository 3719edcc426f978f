"""The examples run as they stand, with few strokes."""

import runpy
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from PIL import Image

import maulstick as ms
from tests.support.robot.fake_grbl import FakeGrbl

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
Run = Callable[..., tuple[Path, str]]
QUICK = ("--strokes", "8", "--steps", "3")


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """A function that runs an example by its name; returns its folder and what it said."""

    def ran(name: str, *words: str) -> tuple[Path, str]:
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", [name, "--out", "out", *QUICK, *words])
        runpy.run_path(str(EXAMPLES / name), run_name="__main__")
        return tmp_path / "out", capsys.readouterr().out

    return ran


def test_there_are_five_short_examples_that_say_how_to_run_them() -> None:
    paths = sorted(EXAMPLES.glob("*.py"))
    assert [path.name[:2] for path in paths] == ["01", "02", "03", "04", "05"]
    for path in paths:
        text = path.read_text()
        assert f"python examples/{path.name} photo.jpg" in text
        assert text.count("\n") < 60, path.name


def test_a_plan_of_a_picture_of_ones_own(run: Run, tmp_path: Path) -> None:
    Image.new("RGB", (60, 40), "navy").save(tmp_path / "photo.jpg")
    out, said = run("01_plan.py", "photo.jpg")
    painting = ms.read_painting(out / "painting.json")
    assert f"{len(painting.strokes)} strokes" in said
    assert painting.provenance.image == "photo.jpg"
    assert (out / "painting.svg").exists()
    with Image.open(out / "painting.png") as image:
        assert image.height == 1024


def test_a_style_of_ones_own(run: Run, tmp_path: Path) -> None:
    out, said = run("02_your_own_hand.py")
    assert said.startswith("30 strokes")
    painting = ms.read_painting(out / "painting.json")
    assert {stroke.style.name for stroke in painting.strokes if stroke.style} <= {"me"}
    again, said = run("02_your_own_hand.py", "--ink", str(out / "waves.svg"))
    assert ms.read_painting(again / "painting.json") == painting


@pytest.mark.filterwarnings("ignore:libmypaint")  # the note of a machine without it
def test_the_simulated_easel(run: Run) -> None:
    out, said = run("03_simulated_easel.py")
    assert "strokes are on the sheet" in said
    with Image.open(out / "painted.png") as image:
        assert image.convert("L").getextrema()[0] < 200


def test_a_pen_plotter(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("builtins.input", print)
    out, said = run("04_pen_plotter.py", "--size", "60x60mm")
    assert "drawn" not in said
    assert 'width="60mm"' in (out / "drawing.svg").read_text()
    with FakeGrbl() as device:
        out, said = run("04_pen_plotter.py", "--size", "60x60mm", "--port", device.port)
    number = len(ms.read_painting(out / "painting.json").strokes)
    assert f"{number} of {number} strokes are drawn" in said
    assert len(device.reached) > 2 * number


def test_a_new_robot_keeps_every_promise_and_paints(run: Run) -> None:
    out, said = run("05_new_robot.py")
    assert said.count("kept:") == 8
    assert "BROKEN" not in said
    number = len(ms.read_painting(out / "painting.json").strokes)
    assert said.rpartition("kept:")[2].count("draw ") == number
