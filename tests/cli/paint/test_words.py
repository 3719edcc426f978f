import os
from pathlib import Path

import pytest

from maulstick.painting.painting_file import write_painting
from tests.cli.conftest import run
from tests.support.nominal import nominal
from tests.support.robot.recorder import LIMITS, Recorder
from tests.support.robot.small_paintings import line, painting_of


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--robot", "simulator"], "there is no machine 'simulator'; there are: sim, sim:pens, sim:real, grbl:"),
        (["--robot", "sim:fast"], "there is no machine 'sim:fast'"),
        (["--robot", "plotter"], "there is no machine 'plotter'"),
        (["--robot", ""], "there is no machine ''; there are: sim"),
        (["--robot", "grbl"], "'grbl' does not say where the machine is"),
        (["--robot", "xarm:192.0.2.1", "--dry-run"], "calibrate touch"),
        (["--easel", "none.json"], "there is no easel none.json"),
        (["--tray", "none.json"], "there is no tray none.json"),
        (["--speed", "0"], "--speed is 0; it must be from 0.1 to 10000 mm/s"),
        (["--speed", "nan"], "--speed is nan; it must be from 0.1 to 10000 mm/s"),
        (
            ["--unfinished", "maybe", "--resume"],
            "there is no answer to --unfinished 'maybe'; there are: again, painted",
        ),
        (["--resume", "--restart"], "--resume knows where to go on; leave out --restart, --from-stroke and --from-pen"),
        (
            ["--resume", "--from-stroke", "2"],
            "--resume knows where to go on; leave out --restart, --from-stroke and --from-pen",
        ),
        (
            ["--unfinished", "again"],
            "--unfinished is about the stroke that an earlier run began; it goes with --resume",
        ),
    ],
)
def test_words_that_make_no_run_are_refused_in_one_line_and_leave_nothing(
    painting: Path, words: list[str], said: str
) -> None:
    ran = run("paint", painting, *words)
    assert ran.code == 2
    assert said in ran.mistake
    assert os.listdir(painting.parent) == ["painting.json"]


def test_a_painting_that_is_not_there_or_has_no_strokes_is_refused(tmp_path: Path) -> None:
    assert run("paint", tmp_path / "none.json").mistake.startswith("there is no painting ")
    write_painting(painting_of([]), tmp_path / "empty.json")
    ran = run("paint", tmp_path / "empty.json")
    assert ran.code == 2
    assert ran.mistake == f"{tmp_path / 'empty.json'} has no strokes; plan it again with more"


def test_a_stroke_that_is_too_fast_is_refused_with_the_option_that_slows_it_down(tmp_path: Path) -> None:
    path = tmp_path / "fast.json"
    write_painting(painting_of([line(1, speed=0.4)]), path)
    ran = run("paint", path, "--robot", "sim:real")
    assert ran.code == 2
    assert ran.mistake.endswith("slow all strokes down with --speed 250")
    assert run("paint", path, "--robot", "sim:real", "--speed", "250").code == 0


def test_pressure_that_a_plotter_does_not_have_is_refused_with_the_option_that_plans_it_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = Recorder(LIMITS.model_copy(update={"varies_pressure": False}))
    monkeypatch.setattr("maulstick.jobs.paint.setup.machine", lambda spec, easel: robot)
    path = tmp_path / "soft.json"
    write_painting(painting_of([line(1, pressure=(0, 1))], [nominal("round")]), path)
    ran = run("paint", path, "--robot", "grbl:/dev/ttyUSB0")
    assert ran.code == 2
    assert ran.mistake.endswith("plan it again with maulstick plan --pressure 0.5")
    assert robot.said == ["close"]
