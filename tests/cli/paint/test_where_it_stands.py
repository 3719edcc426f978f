"""Where the pen stands when a run begins, on machines that know it only by counting steps."""

import io
import json
from pathlib import Path
from typing import Any

import pytest

from maulstick.painting.brush import load_brush
from maulstick.painting.painting_file import write_painting
from tests.cli.conftest import Ran, run
from tests.cli.paint.test_stops import Person
from tests.support.robot.fake_ebb import POWERED, UNPOWERED, FakeEbb
from tests.support.robot.fake_grbl import SETTINGS, FakeGrbl
from tests.support.robot.small_paintings import line, painting_of

ASKED = "see that the pen stands"
STEPS_PER_MM = 80  # of an AxiDraw
DECIMALS = 1e-3  # of a Grbl's millimetres


@pytest.fixture
def three(tmp_path: Path) -> Path:
    """Three strokes of a pen, the last of which ends in the middle of the sheet."""
    strokes = (line(i, (0.01, 0.01 * i), (0.03, 0.01 * i)) for i in range(1, 4))
    write_painting(painting_of(strokes, [load_brush("fineliner")]), tmp_path / "three.json")
    return tmp_path / "three.json"


def paint(monkeypatch: pytest.MonkeyPatch, said: str, painting: Path, *words: str) -> Ran:
    """Paint, beside a person who types this."""
    monkeypatch.setattr("sys.stdin", io.StringIO(said))
    return run("paint", painting, *words)


def test_a_new_run_that_begins_away_from_home_asks_before_anything_moves(
    three: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with FakeEbb() as device:
        robot = ("--robot", f"axidraw:{device.port}")
        first = paint(monkeypatch, "s\n", three, *robot, "--pause-at", "3")
        assert (first.code, ASKED in first.stderr) == (130, False), "its pen is at home, where it was put"
        device.supply, device.made, device.supply = UNPOWERED, (0, 0), POWERED  # pushed home while it had no power
        moved = len([command for command in device.commands if command.startswith("SM")])
        ran = paint(monkeypatch, "s\n", three, *robot, "--restart")
        assert ran.code == 130
        assert f"{ASKED} 10 mm from the left and 20 mm from the upper edge" in ran.stderr
        assert len([command for command in device.commands if command.startswith("SM")]) == moved
        device.made = device.steps
        again = paint(monkeypatch, "\n", three, *robot, "--restart")
        assert (again.code, again.stderr.count(ASKED)) == (0, 1)
        assert min(first + second for first, second, _ in device.reached) >= 0


def test_one_run_after_another_asks_nothing_since_each_ends_at_home(
    three: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with FakeEbb() as device:
        for _ in range(2):
            assert paint(monkeypatch, "", three, "--robot", f"axidraw:{device.port}", "--restart").code == 0
            assert device.made == (0, 0)


def test_a_grbl_that_homes_by_itself_asks_nothing_and_stays(three: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    homed: dict[str, Any] = {
        "settings": SETTINGS | {22: 1},
        "origin": (-100.0, -100.0, -20.0),
        "start": (-1.0, -1.0, 0.0),
    }
    with FakeGrbl(pace=1000.0, **homed) as device:
        ran = paint(monkeypatch, "", three, "--robot", f"grbl:{device.port}")
        assert (ran.code, ASKED in ran.stderr) == (0, False), ran.stderr
        assert device.place[:2] == pytest.approx((30 - 100, 10 - 100), abs=DECIMALS), "over the end of its last stroke"


def test_a_grbl_that_homes_by_itself_is_to_do_so_where_its_pen_stands_elsewhere_on_the_way(
    three: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    homed: dict[str, Any] = {
        "settings": SETTINGS | {22: 1},
        "origin": (-100.0, -100.0, -20.0),
        "start": (-1.0, -1.0, 0.0),
    }
    with FakeGrbl(pace=1000.0, **homed) as device:
        robot = ("--robot", f"grbl:{device.port}")
        assert paint(monkeypatch, "s\n", three, *robot, "--pause-at", "3").code == 130
        ran = paint(monkeypatch, "\n\n", three, *robot, "--resume")
        assert ran.code == 0, ran.stderr
        assert f"{ASKED} 10 mm from the left" in ran.stderr
        assert "(elsewhere: stop, home it with maulstick machine)" in " ".join(ran.stderr.split())


def test_a_grbl_asks_as_well_and_once_for_all_copies(three: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with FakeGrbl(pace=1000.0, start=(20.0, 10.0, 0.0)) as device:
        ran = paint(monkeypatch, "\n\n\n", three, "--robot", f"grbl:{device.port}", "--copies", "3")
    assert ran.code == 0, ran.stderr
    assert ran.stderr.count(f"{ASKED} 20 mm from the left and 30 mm from the upper edge") == 1
    assert ran.stderr.count(ASKED) == 1


def test_a_plotter_goes_home_while_a_sheet_is_changed_wherever_the_run_began(
    three: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with FakeEbb() as device:
        assert paint(monkeypatch, "s\n", three, "--robot", f"axidraw:{device.port}", "--pause-at", "3").code == 130
        monkeypatch.setattr("sys.stdin", Person(lambda asked: places.append(device.made)))
        places: list[tuple[int, int]] = []
        assert run("paint", three, "--resume", "--copies", "3").code == 0
    paused = 30 * STEPS_PER_MM, -10 * STEPS_PER_MM  # before the third stroke of each copy
    assert places == [paused, paused, (0, 0), paused, (0, 0), paused]


def test_a_plotter_whose_easel_leaves_out_its_home_goes_as_near_as_it_may(
    three: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    limits = {"lower": (0.005, 0.002, 0), "upper": (0.2, 0.2, 0.05), "speed": 0.05, "climb": 0.01, "acceleration": 0.3}
    easel = {"corner": (0, 0.04, 0), "right": (1, 0, 0), "down": (0, -1, 0)}
    three.with_name("easel.json").write_text(json.dumps({**easel, "limits": {**limits, "varies_pressure": False}}))
    with FakeGrbl(pace=1000.0, start=(20.0, 10.0, 0.0)) as device:
        robot = ("--robot", f"grbl:{device.port}", "--easel", three.with_name("easel.json"))
        places: list[tuple[float, float]] = []
        monkeypatch.setattr("sys.stdin", Person(lambda asked: places.append(device.place[:2])))
        ran = run("paint", three, *robot, "--copies", "2")
    assert ran.code == 0, ran.stderr
    assert places == [pytest.approx(place, abs=DECIMALS) for place in ((20, 10), (5, 2))]
