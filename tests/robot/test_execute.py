import json
import os
import subprocess
import sys
import threading
from pathlib import Path
from typing import NoReturn

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from maulstick.errors import MachineError, OutputError
from maulstick.painting.painting_file import write_painting
from maulstick.robot.duration import seconds_of
from maulstick.robot.execute import PaintProgress, Pause, execute
from maulstick.robot.journal import Journal, journal_of
from maulstick.robot.robot import StoppedError
from maulstick.robot.routine import Draw, PaintLoad, routine
from tests.support.robot.mortal_painter import Cut, PowerCutError, World, paint, put_painting
from tests.support.robot.recorder import EASEL, LIMITS, Recorder
from tests.support.robot.small_paintings import SIX
from tests.support.robot.trays import TRAY

ALL = list(range(10, 16))


@pytest.fixture
def journal_path(tmp_path: Path) -> Path:
    write_painting(SIX, tmp_path / "painting.json")
    return journal_of(tmp_path / "painting.json")


def events(path: Path) -> list[str]:
    """Return the events of the journal, each with its stroke."""
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    return [f"{line['event']} {line['stroke']}" for line in lines if line["event"] != "revision"]


# What is done, and when it is written down.


def test_a_stroke_is_written_down_before_the_tip_is_lowered_and_after_it_is_lifted(journal_path: Path) -> None:
    order: list[str] = []
    robot = Recorder(before=lambda what: order.extend([*new(), what]))

    def new() -> list[str]:
        said = events(journal_path) if journal_path.exists() else []
        return said[sum(word.startswith(("begin", "end")) for word in order) :]

    with Journal.open(journal_path) as journal, robot:
        execute(routine(SIX, EASEL, LIMITS, done=range(10, 14), load=PaintLoad(1)), robot, journal, lambda ask: None)
        order += new()
    assert order == [
        "move", "begin 14", "stroke", "lift", "end 14",
        "move", "begin 15", "stroke", "lift", "end 15", "close",
    ]  # fmt: skip


def test_the_tip_goes_above_a_stroke_down_along_it_and_up(journal_path: Path) -> None:
    robot = Recorder()
    actions = routine(SIX, EASEL, LIMITS, done=range(10, 15), load=PaintLoad(1))
    with Journal.open(journal_path) as journal, robot:
        execute(actions, robot, journal, lambda ask: None)
    (draw,) = [action for action in actions if isinstance(action, Draw)]
    (_, start), (_, path), (_, end) = robot.commands[:3]
    assert np.array_equal(start[0], draw.motion.start)
    assert np.array_equal(path, draw.motion.path)
    assert end[0] == pytest.approx([*path[-1, :2], draw.motion.after])


def test_questions_come_before_their_strokes_and_the_hand_holds_what_was_put_in(journal_path: Path) -> None:
    painted_then: list[tuple[str, int]] = []
    with Journal.open(journal_path) as journal, Recorder() as robot:
        load = execute(
            routine(SIX, EASEL, LIMITS),
            robot,
            journal,
            lambda ask: painted_then.append((ask.message, len(journal.painted))),
        )
        assert journal.painted == set(ALL)
    assert painted_then == [
        ("put in the marker with the paint #cc1a1a", 0),
        ("put in the marker with the paint #1a33b2", 3),
    ]
    assert load == PaintLoad(1, pytest.approx(0.075))


def test_a_dip_fills_the_hand_again_and_a_rinse_empties_it(journal_path: Path) -> None:
    actions = routine(SIX, EASEL, LIMITS, TRAY)
    with Journal.open(journal_path) as journal, Recorder() as robot:
        assert execute(actions[:4], robot, journal, lambda ask: None) == PaintLoad(0, pytest.approx(0.03))
        assert execute(actions[4:6], robot, journal, lambda ask: None) == PaintLoad()
        assert execute(actions[6:], robot, journal, lambda ask: None) == PaintLoad(1, pytest.approx(0.03))
        assert journal.painted == set(ALL)


def test_progress_counts_metres_up_and_seconds_down(journal_path: Path) -> None:
    seen: list[PaintProgress] = []
    with Journal.open(journal_path) as journal, Recorder() as robot:
        actions, place = routine(SIX, EASEL, LIMITS), robot.place
        execute(actions, robot, journal, lambda ask: None, seen.append)
    assert [progress.action for progress in seen] == [*actions, None]
    assert [progress.drawn for progress in seen] == pytest.approx([0, 0, 0.005, 0.015, 0.03, 0.03, 0.05, 0.075, 0.105])
    assert [progress.metres for progress in seen] == pytest.approx([0.105] * len(seen))
    total = seconds_of(actions, LIMITS, place).sum()
    assert seen[0].left == pytest.approx(total)
    assert np.all(np.diff([progress.left for progress in seen]) <= 0)
    assert seen[-1].left == 0
    assert [progress.next_paint for progress in seen] == [1] * 4 + [None] * 5


def test_a_pause_holds_the_machine_between_two_strokes(journal_path: Path) -> None:
    pause, held = Pause(), threading.Event()

    def watch(progress: PaintProgress) -> None:
        if isinstance(progress.action, Draw) and progress.action.stroke == 14:
            pause.toggle()
            held.set()

    robot = Recorder()

    def go_on() -> None:
        assert held.wait(20)
        told = len(robot.commands)
        assert not threading.Event().wait(0.2)
        assert len(robot.commands) == told
        assert not robot.down
        pause.toggle()

    other = threading.Thread(target=go_on)
    other.start()
    with Journal.open(journal_path) as journal, robot:
        execute(routine(SIX, EASEL, LIMITS), robot, journal, lambda ask: None, watch, pause)
        assert journal.painted == set(ALL)
    other.join(20)
    assert not pause.held


class Buttoned(Recorder):
    """Recorder whose button is pressed at these looks at it, counted from 0."""

    def __init__(self, *pressed: int) -> None:
        super().__init__()
        self.looks, self._at = 0, pressed

    def _pressed(self) -> bool:
        self.looks += 1
        return self.looks - 1 in self._at


def test_the_machines_button_holds_it_after_a_stroke_until_it_is_pressed_again(journal_path: Path) -> None:
    robot, told = Buttoned(3, 8), list[tuple[bool, int, int, bool]]()
    pause = Pause(lambda held: told.append((held, robot.looks, robot.said.count("stroke"), robot.down)))
    with Journal.open(journal_path) as journal, robot:
        execute(routine(SIX, EASEL, LIMITS), robot, journal, lambda ask: None, pause=pause)
        assert journal.painted == set(ALL)
    assert told == [(True, 4, 2, False), (False, 9, 2, False)]
    assert not pause.held


def test_a_stop_ends_a_pause(journal_path: Path) -> None:
    robot = Buttoned(2)
    pause = Pause(lambda held: robot.stop())
    with Journal.open(journal_path) as journal, robot, pytest.raises(StoppedError):
        execute(routine(SIX, EASEL, LIMITS), robot, journal, lambda ask: None, pause=pause)


# Bad days.


def test_a_machine_that_fails_in_a_stroke_leaves_that_one_to_be_asked_about(journal_path: Path) -> None:
    robot = Recorder(before=lambda what: fail() if what == "lift" and robot.said.count("lift") == 2 else None)

    def fail() -> NoReturn:
        raise MachineError("the cable is off")

    with Journal.open(journal_path) as journal:
        with pytest.raises(MachineError, match="the cable is off"), robot:
            execute(routine(SIX, EASEL, LIMITS), robot, journal, lambda ask: None)
        assert (journal.painted, journal.unfinished) == ({10, 11}, 12)
    assert not robot.down


def test_a_stop_between_strokes_leaves_nothing_to_be_asked_about(journal_path: Path) -> None:
    robot = Recorder()

    def watch(progress: PaintProgress) -> None:
        if isinstance(progress.action, Draw) and progress.action.stroke == 12:
            robot.stop()

    with Journal.open(journal_path) as journal:
        with pytest.raises(StoppedError), robot:
            execute(routine(SIX, EASEL, LIMITS), robot, journal, lambda ask: None, watch)
        assert (journal.painted, journal.unfinished) == ({10, 11}, None)


@pytest.mark.parametrize("at", range(1, 13))
def test_a_disk_that_is_full_stops_the_machine_and_no_stroke_is_lost(tmp_path: Path, at: int) -> None:
    put_painting(tmp_path)
    appends = 0

    def write(file: int, content: bytes) -> int:
        nonlocal appends
        appends += 1
        if appends == at:
            raise OSError(28, "No space left on device")
        return real(file, content)

    real = os.write
    path = journal_of(tmp_path / "painting.json")
    with Journal.open(path) as journal:
        journal.revise(tmp_path / "painting.json")
        robot = Recorder()
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("os.write", write)
            with (
                robot,
                pytest.raises(
                    OutputError,
                    match=r"No space left on device; mend that; then go on with paint\(\.\.\., resume=True\)$",
                ),
            ):
                execute(routine(SIX, EASEL, LIMITS), robot, journal, lambda ask: None)
    assert not robot.down
    strokes = robot.said.count("lift")
    with Journal.open(path) as journal:
        asked = [] if journal.unfinished is None else [journal.unfinished]
        assert sorted([*journal.painted, *asked]) == ALL[:strokes]
        assert bool(asked) == (at % 2 == 0)  # it was on the paper when its end was to be written


@pytest.mark.parametrize("what", ["stroke", "lift"])
def test_a_fault_lifts_the_pen_as_high_as_it_travels(journal_path: Path, what: str) -> None:
    def fail(called: str) -> None:
        if called == "recover":
            heights.append(float(robot.place[2]))
        elif called == what and "stroke" in robot.said:
            raise MachineError("the cable is off")

    robot, heights = Recorder(before=fail), list[float]()
    with Journal.open(journal_path) as journal, pytest.raises(MachineError, match="the cable is off"), robot:
        execute(routine(SIX, EASEL, LIMITS), robot, journal, lambda ask: None)
    assert heights == [pytest.approx(EASEL.travel)]


# Power cuts: whatever the moment, every stroke is painted once in the end, and at most one was asked about.


def cut_off() -> NoReturn:
    raise PowerCutError


def finish(folder: Path, first: tuple[int, ...] = ()) -> None:
    asked = paint(folder, Cut(0, cut_off), first)
    assert len(asked) <= 1
    assert sorted(World(folder).painted()) == ALL[len(first) :]


def is_cut_off(folder: Path, at: int, first: tuple[int, ...] = ()) -> bool:
    try:
        paint(folder, Cut(at, cut_off), first)
    except PowerCutError:
        return True
    return False


def moments_of(folder: Path) -> int:
    cut = Cut(0, cut_off)
    put_painting(folder)
    paint(folder, cut)
    return cut.moments


@pytest.fixture(scope="module")
def moments(tmp_path_factory: pytest.TempPathFactory) -> int:
    """Count the moments of painting: one for the journal's name, four for each of its 13 lines, two for each stroke."""
    return moments_of(tmp_path_factory.mktemp("whole"))


def test_after_a_power_cut_at_any_moment_every_stroke_is_painted_once(
    tmp_path_factory: pytest.TempPathFactory, moments: int
) -> None:
    assert moments == 1 + 13 * 4 + 6 * 2
    for at in range(1, moments + 1):
        folder = tmp_path_factory.mktemp("cut")
        put_painting(folder)
        assert is_cut_off(folder, at)
        finish(folder)


def test_what_counts_as_painted_does_so_after_a_power_cut_at_any_moment(
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    for at in range(1, 9):
        folder = tmp_path_factory.mktemp("cut")
        put_painting(folder)
        assert is_cut_off(folder, at, first=(10, 11))
        finish(folder, first=(10, 11))


@settings(max_examples=40, deadline=None)
@given(st.lists(st.integers(1, 40), min_size=2, max_size=6))
def test_power_may_be_cut_again_and_again(tmp_path_factory: pytest.TempPathFactory, cuts: list[int]) -> None:
    folder = tmp_path_factory.mktemp("cuts")
    put_painting(folder)
    for at in cuts:
        is_cut_off(folder, at)
    finish(folder)


@pytest.mark.parametrize("at", [1, 2, 4, 7, 10, 64])
def test_after_a_kill_every_stroke_is_painted_once(tmp_path: Path, at: int) -> None:
    put_painting(tmp_path)
    command = [sys.executable, "-m", "tests.support.robot.mortal_painter", str(at), tmp_path]
    assert subprocess.run(command, timeout=60, check=False).returncode == -9
    finish(tmp_path)


def test_whatever_part_of_a_journal_reached_the_disk_it_says_what_had_happened(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    put_painting(tmp_path)
    paint(tmp_path, Cut(0, cut_off))
    monkeypatch.setattr("os.fsync", lambda file: None)
    path = journal_of(tmp_path / "painting.json")
    whole = path.read_bytes()
    for size in range(len(whole) + 1):
        path.write_bytes(whole[:size])
        said = whole[: whole[:size].rfind(b"\n") + 1].decode()
        with Journal.open(path) as journal:
            assert len(journal.painted) == said.count('"end"')
            assert len(journal.painted) + (journal.unfinished is not None) == said.count('"begin"')
