import io
import os
import signal
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from maulstick.cli.paint.operator import TerminalOperator
from tests.cli.conftest import run
from tests.cli.paint.conftest import ALL, answers, events, painted
from tests.support.robot.recorder import Recorder
from tests.support.robot.small_paintings import SIX

HEXES = [paint.hex for paint in SIX.paints]


def test_a_machine_with_pens_asks_for_each_and_paints_when_enter_is_pressed(
    painting: Path, recorder: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers(monkeypatch, "\n\n")
    ran = run("paint", painting, "--robot", "grbl:/dev/ttyUSB0")
    assert (ran.code, ran.stdout) == (0, "")
    first, second = (ran.stderr.index(f"put in the marker with the paint {hue}, and press Enter") for hue in HEXES)
    assert first < second
    assert recorder.said == ["move", "stroke", "lift"] * 6 + ["close"]
    assert sorted(painted(painting)) == ALL


def test_the_simulated_easel_asks_for_pens_where_it_stands_for_a_machine_that_does(
    painting: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers(monkeypatch, "\n\n")
    ran = run("paint", painting, "--robot", "sim:pens")
    asked = [line for line in ran.stderr.splitlines() if line.startswith("put in")]
    assert asked == [
        f"put in the marker with the paint {hue}, and press Enter (it draws for less than 1 min); s and Enter stop"
        for hue in HEXES
    ]
    assert sorted(painted(painting)) == ALL


def test_where_nobody_changes_pens_nothing_is_drawn(
    painting: Path, recorder: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers(monkeypatch, "")
    ran = run("paint", painting, "--robot", "grbl:/dev/ttyUSB0")
    assert ran.code == 2
    assert ran.stderr.splitlines()[-1] == (
        f"maulstick: nobody is there to put in the marker with the paint {HEXES[0]}; run it in a terminal"
    )
    assert recorder.said == ["close"]
    assert painted(painting) == []


def test_where_nobody_changes_a_pen_on_the_way_it_is_said_how_to_go_on(
    painting: Path, recorder: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers(monkeypatch, "\n")
    ran = run("paint", painting, "--robot", "grbl:/dev/ttyUSB0")
    assert ran.code == 2
    assert ran.stderr.splitlines()[-2:] == [
        f"stopped, with the pen lifted; maulstick paint {painting} --resume goes on",
        f"maulstick: nobody is there to put in the marker with the paint {HEXES[1]}; run it in a terminal",
    ]
    answers(monkeypatch, "\n\n")
    assert run("paint", painting, "--resume").code == 0
    assert sorted(painted(painting)) == ALL


class Interrupting(io.StringIO):
    """A person who presses Ctrl-C when they are asked for the Nth time."""

    def __init__(self, at: int) -> None:
        super().__init__("\n" * 9)
        self._left = at

    def readline(self, size: int | None = -1, /) -> str:
        self._left -= 1
        if self._left == 0:
            os.kill(os.getpid(), signal.SIGINT)
        return super().readline(-1 if size is None else size)


@pytest.mark.parametrize(("at", "count"), [(1, 0), (2, 3)])
def test_ctrl_c_while_a_pen_is_asked_for_stops_it_between_two_strokes(
    painting: Path, recorder: Recorder, monkeypatch: pytest.MonkeyPatch, at: int, count: int
) -> None:
    monkeypatch.setattr("sys.stdin", Interrupting(at))
    before = signal.getsignal(signal.SIGINT)
    ran = run("paint", painting, "--robot", "grbl:/dev/ttyUSB0")
    assert ran.code == 130
    assert f"stopped, with the pen lifted; maulstick paint {painting} --resume goes on" in ran.stderr
    assert len(painted(painting)) == len([event for event in events(painting) if event.startswith("begin")]) == count
    assert not recorder.down
    assert signal.getsignal(signal.SIGINT) == before


@pytest.mark.parametrize("during", ["move", "stroke", "lift"])
def test_ctrl_c_at_any_command_lifts_the_pen_and_nothing_is_lost(
    painting: Path, monkeypatch: pytest.MonkeyPatch, during: str
) -> None:
    def interrupt(what: str) -> None:
        if what == during and robot.said.count(what) == 2:
            os.kill(os.getpid(), signal.SIGINT)

    robot = Recorder(before=interrupt)
    monkeypatch.setattr("maulstick.jobs.paint.setup.machine", lambda spec, easel: robot)
    answers(monkeypatch, "\n\n\n\n")
    assert run("paint", painting, "--robot", "grbl:/dev/ttyUSB0").code == 130
    assert not robot.down
    assert len(painted(painting)) == (3 if during == "lift" else 2)
    robot.commands.append((during, np.empty((0, 3))))  # nobody interrupts again
    assert run("paint", painting, "--robot", "grbl:/x", "--resume", "--unfinished", "painted").code == 0
    assert sorted(painted(painting)) == ALL


@pytest.mark.parametrize(("before", "stopped"), [(signal.SIG_IGN, False), (signal.SIG_DFL, True)])
def test_a_closed_terminal_stops_a_run_but_not_one_under_nohup(before: signal.Handlers, stopped: bool) -> None:
    earlier = signal.signal(signal.SIGHUP, before)
    try:
        operator = TerminalOperator(Console(file=io.StringIO()), SIX, Recorder(), 0, "")
        with operator.on_duty():
            os.kill(os.getpid(), signal.SIGHUP)
        assert operator.stopped == stopped
        assert signal.getsignal(signal.SIGHUP) == before
    finally:
        signal.signal(signal.SIGHUP, earlier)
