"""Kills: a painting program that is killed at random moments, and goes on by its journal as a person lets it.

The program is `paint` of maulstick.jobs.paint.session in a process of its own; the machine outlives it.
"""

import multiprocessing
import os
import signal
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path

import numpy as np

from maulstick.errors import InputError, MachineError
from maulstick.jobs.paint.estimate import Estimate
from maulstick.jobs.paint.operator import Operator
from maulstick.jobs.paint.options import PaintOptions
from maulstick.jobs.paint.request import PaintRequest
from maulstick.jobs.paint.session import paint
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import write_painting
from maulstick.robot.easel import write_easel
from maulstick.robot.execute import PaintProgress
from maulstick.robot.journal import Journal, journal_of
from maulstick.robot.robot import Robot, StoppedError
from maulstick.robot.routine import Prompt
from tests.support.robot.mortal_machines import MACHINES, Kill, MortalMachine
from tests.support.robot.small_paintings import SIX

DONE, STOPPED, FAULT, CRASH = 0, 10, 11, 12
STROKES = {stroke.id: np.array(stroke.trajectory)[[0, -1], :2] for stroke in SIX.strokes}
SPEED = 0.1  # metres per second
NEAR = 3e-4  # metres: from an end of a stroke to where a machine of steps and decimals drew it; a third of a line
LATEST = 7  # lines of the journal that are written before a kill, at most: two strokes and three halves
SOON = 0.1  # seconds from then to the kill, at most: about as long as a stroke takes
PATIENCE = 60.0  # seconds until a program that does not end has hung

_FROM = multiprocessing.get_context("forkserver")


@dataclass
class Tally:
    """What kills of one kind did to paintings of one machine.

    lost: strokes that are not on the paper in the end.  doubled: strokes on it twice, of those that were under the
    pen only from end to end.
    stray: lines of the pen beside all strokes.  left_down: kills after which the pen was down although the program
    lived and could reach the machine.
    """

    kills: int = 0
    paintings: int = 0
    lost: int = 0
    doubled: int = 0
    stray: int = 0
    left_down: int = 0


def shares(kills: int) -> Iterator[tuple[str, Kill, int]]:
    """So many kills shared among all machines and all that may happen to each: names, and a number each."""
    pairs = [(name, kill) for name, (kind, _) in MACHINES.items() for kill in kind.kills]
    for i, (name, kill) in enumerate(pairs):
        yield name, kill, (kills + len(pairs) - 1 - i) // len(pairs)


def killed(name: str, kill: Kill, kills: int, rng: np.random.Generator, folder: Path) -> Tally:
    """Paint on that machine until so many kills of that kind are over, and the last painting is whole."""
    _FROM.set_forkserver_preload(["__main__", __name__])  # all programs are forked from one that has loaded everything
    tally = Tally()
    while tally.kills < kills:
        place = folder / f"{name}-{kill}-{tally.paintings}"
        place.mkdir()
        machine = MACHINES[name][1](place)
        try:
            _one_painting(machine, kill, kills, rng, place, tally)
        finally:
            machine.end()
        tally.paintings += 1
    return tally


def _one_painting(
    machine: MortalMachine, kill: Kill, kills: int, rng: np.random.Generator, folder: Path, tally: Tally
) -> None:
    painting = folder / "painting.json"
    write_painting(SIX, painting)
    write_easel(machine.easel, folder / "easel.json")
    under_the_pen = set[int]()
    whole = False
    while not whole:
        program, pipe = _begun(machine, painting)
        if is_killed := tally.kills < kills and _waits_for(rng, program, painting):
            tally.kills += 1
            _strike(machine, program, kill)
        whole, lifted = _ended(program, pipe, is_killed)
        machine.rest()
        if kill in machine.lifts and not whole and not (lifted and not machine.pen_is_down()):
            tally.left_down += 1
        if is_killed and kill in ("cable", "power"):
            machine.mend()
        if (stroke := _unfinished(painting)) is not None:
            under_the_pen.add(stroke)
    times = {stroke: times_on(machine, stroke) for stroke in STROKES}
    tally.lost += sum(wholly == 0 for wholly, _ in times.values())
    tally.doubled += sum(
        wholly > 1 or (at_all > 1 and stroke not in under_the_pen) for stroke, (wholly, at_all) in times.items()
    )
    tally.stray += sum(_stroke_under(track) is None for track in machine.tracks())


def _strike(machine: MortalMachine, program: BaseProcess, kill: Kill) -> None:
    if kill in ("cable", "power"):
        machine.suffer(kill)
    elif program.pid is not None:
        os.kill(program.pid, signal.SIGKILL if kill == "sigkill" else signal.SIGINT)


def times_on(machine: MortalMachine, stroke: int) -> tuple[int, int]:
    """How often a stroke is on the paper: wholly, and wholly or in part."""
    tracks = [track for track in machine.tracks() if _stroke_under(track) == stroke]
    ends = STROKES[stroke]
    whole = sum(bool((np.abs(track[:, None] - ends).max(2).min(0) < NEAR).all()) for track in tracks)
    return whole, sum(bool(np.ptp(track[:, 0]) > NEAR) for track in tracks)


def _stroke_under(track: np.ndarray) -> int | None:
    """The stroke on which a track (n, 2) lies, from its first point to its last; None for one beside all."""
    for stroke, ends in STROKES.items():
        if np.all((track > ends.min(0) - NEAR) & (track < ends.max(0) + NEAR)):
            return stroke
    return None


def _begun(machine: MortalMachine, painting: Path) -> tuple[BaseProcess, Connection]:
    """The program, which has begun or goes on; the strokes that are wholly on the paper are answered as painted."""
    on_paper = {stroke for stroke in STROKES if times_on(machine, stroke)[0]}
    ours, theirs = _FROM.Pipe()
    program = _FROM.Process(target=_program, args=(machine.maker(), painting, on_paper, theirs))
    program.start()
    theirs.close()
    assert ours.poll(PATIENCE)
    ours.recv()
    return program, ours


def _waits_for(rng: np.random.Generator, program: BaseProcess, painting: Path) -> bool:
    """Wait for a random moment; returns whether the program still runs then."""
    journal = journal_of(painting)
    lines = _lines(journal) + int(rng.integers(0, LATEST + 1))
    soon = float(rng.uniform(0, SOON))
    while program.is_alive() and _lines(journal) < lines:
        time.sleep(0.001)
    program.join(soon)
    return program.is_alive()


def _ended(program: BaseProcess, pipe: Connection, is_killed: bool) -> tuple[bool, bool]:
    """Wait for the end of the program; returns whether the painting is whole, and the pen known to be lifted."""
    program.join(PATIENCE)
    if program.is_alive():
        program.kill()
        raise TimeoutError("the program hangs")
    lifted = False
    with pipe, suppress(EOFError):  # one that was killed says nothing
        lifted = pipe.recv()
    if program.exitcode not in ((DONE, STOPPED, FAULT, -signal.SIGKILL) if is_killed else (DONE,)):
        raise RuntimeError(f"the program ended with {program.exitcode}")
    return program.exitcode == DONE, lifted


def _lines(journal: Path) -> int:
    return journal.read_bytes().count(b"\n") if journal.exists() else 0


def _unfinished(painting: Path) -> int | None:
    journal = journal_of(painting)
    return Journal.read(journal).unfinished if _lines(journal) else None


def _program(make: Callable[[], Robot], painting: Path, on_paper: set[int], pipe: Connection) -> None:
    """Begin, or go on, and end with a code; runs in a process of its own."""
    code, robot = CRASH, None
    try:
        pipe.send(None)
        robot = make()
        options = PaintOptions(robot="own:mortal", easel=painting.with_name("easel.json"), speed=SPEED)
        resume = _lines(journal_of(painting)) > 0
        request = PaintRequest(painting, options, resume=resume, robot=robot)
        paint(request, lambda number: _unfinished(painting) in on_paper, lambda setup, done: _Person(setup.robot))
        code = DONE
    except (StoppedError, KeyboardInterrupt):
        code = STOPPED
    except (MachineError, InputError):  # the port may have gone before it was opened
        code = FAULT
    except BaseException:  # whatever else: the one who waits is told by the code
        traceback.print_exc()
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        pipe.send(robot is None or robot.lifted)
        os._exit(code)


class _Person(Operator):
    """Person who does what is asked at once, and whose Ctrl-C stops the machine."""

    def expect(self, estimate: Estimate) -> None:
        pass

    @contextmanager
    def on_duty(self) -> Iterator[None]:
        before = signal.signal(signal.SIGINT, self.interrupt)
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, before)

    def watch(self, progress: PaintProgress) -> None:
        pass

    def ask(self, action: Prompt) -> None:
        pass

    def note(self, sentence: str) -> None:
        pass

    def show(self, photograph: Path) -> None:
        pass

    def expect_plan(self, painting: Painting) -> None:
        pass

    def leave(self, photograph: Path) -> None:
        pass

    def wants_a_look(self) -> bool:
        return False
