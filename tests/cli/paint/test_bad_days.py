import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from maulstick.errors import MachineError
from maulstick.robot.journal import journal_of
from tests.cli.conftest import Ran, run
from tests.cli.paint.conftest import ALL, answers, painted
from tests.robot.test_journal import HOLD
from tests.support.robot.recorder import Recorder


def test_two_runs_of_one_painting_do_not_paint_at_once(begun: Path) -> None:
    path = journal_of(begun)
    with subprocess.Popen([sys.executable, "-c", HOLD, path], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as other:
        assert other.stdout is not None
        assert other.stdout.readline() == b"open\n"
        before = path.read_bytes()
        for words in (["--resume", "--unfinished", "again"], ["--restart"]):
            ran = run("paint", begun, *words)
            assert ran.code == 2
            assert ran.mistake == f"another maulstick paints by {path}; wait until it has finished, or stop it"
        other.kill()
        assert path.read_bytes() == before
    assert run("paint", begun, "--resume", "--unfinished", "again").code == 0


def failing_at(call: int, error: Exception) -> Callable[..., Any]:
    """`os.write`, which fails once."""
    calls, write = 0, os.write

    def fail(file: int, content: bytes) -> int:
        nonlocal calls
        calls += 1
        if calls == call:
            raise error
        return write(file, content)

    return fail


def test_a_full_disk_stops_the_machine_with_one_sentence_and_painting_goes_on_later(
    painting: Path, recorder: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers(monkeypatch, "\n\n\n\n")
    with monkeypatch.context() as patch:
        patch.setattr("os.write", failing_at(5, OSError(28, "No space left on device")))
        ran = run("paint", painting, "--robot", "grbl:/dev/ttyUSB0")
    assert ran.code == 1
    assert ran.stderr.splitlines()[-1] == (
        f"maulstick: cannot write {journal_of(painting)}: No space left on device; mend that; then go on with "
        "maulstick paint ... --resume"
    )
    assert not recorder.down
    ran = run("paint", painting, "--robot", "grbl:/dev/ttyUSB0", "--resume", "--unfinished", "painted")
    assert ran.code == 0, ran.stderr
    assert recorder.said.count("stroke") == 6


def test_on_a_full_disk_a_new_run_has_nothing_to_go_on_with(
    begun: Path, recorder: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patch:
        patch.setattr("os.write", failing_at(1, OSError(28, "No space left on device")))
        ran = run("paint", begun, "--robot", "grbl:/dev/ttyUSB0", "--restart")
    assert ran.code == 1
    assert ran.stderr.splitlines()[-1] == (
        f"maulstick: cannot write {journal_of(begun)}: No space left on device; mend that before painting"
    )
    answers(monkeypatch, "\n\n")
    assert run("paint", begun, "--robot", "grbl:/dev/ttyUSB0").code == 0


def test_a_name_that_is_too_long_for_a_journal_is_named(painting: Path) -> None:
    long = painting.rename(painting.with_name(f"{'a' * 246}.json"))
    ran = run("paint", long)
    assert (ran.code, ran.mistake) == (
        2,
        f"there can be no journal {journal_of(long)}: File name too long; give the painting a shorter name, or "
        "another folder",
    )
    export = run("export", long, "--servo", "30,90")
    assert (export.code, export.mistake) == (
        1, f"cannot write {long.with_suffix('.plot.gcode')}: its name is too long; choose a shorter one",
    )  # fmt: skip


def test_a_machine_that_fails_is_one_sentence_and_painting_goes_on_later(
    painting: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(what: str) -> None:
        if what == "stroke" and robot.said.count("stroke") == 2:
            raise MachineError("the cable is off; plug it in")

    robot = Recorder(before=fail)
    monkeypatch.setattr("maulstick.jobs.paint.setup.machine", lambda spec, easel: robot)
    answers(monkeypatch, "\n\n\n\n")
    ran: Ran = run("paint", painting, "--robot", "grbl:/dev/ttyUSB0")
    assert ran.code == 3
    assert ran.stderr.splitlines()[-1] == "maulstick: the cable is off; plug it in"
    assert len(painted(painting)) == 2
    robot.commands.append(("stroke", np.empty((0, 3))))  # it is mended
    assert run("paint", painting, "--robot", "grbl:/x", "--resume", "--unfinished", "again").code == 0
    assert sorted(painted(painting)) == ALL


def test_a_machine_that_is_not_there_is_one_sentence(painting: Path) -> None:
    ran = run("paint", painting, "--robot", "grbl:/dev/null/none")
    assert ran.code == 2
    assert ran.mistake.startswith("cannot open the port /dev/null/none: ")
    assert not journal_of(painting).exists()


def test_where_the_pen_cannot_be_lifted_the_operator_is_told(painting: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(what: str) -> None:
        if what in ("stroke", "recover"):
            raise MachineError("the cable is off; plug it in")

    robot = Recorder(before=fail)
    monkeypatch.setattr("maulstick.jobs.paint.setup.machine", lambda spec, easel: robot)
    answers(monkeypatch, "\n\n\n\n")
    ran = run("paint", painting, "--robot", "grbl:/dev/ttyUSB0")
    assert ran.code == 3
    assert "stopped, and the pen may still be down: lift it by hand; " in ran.stderr
