"""A machine in a world with power cuts: it paints six strokes by a journal, and is cut off at its Nth moment.

python -m tests.support.robot.mortal_painter N FOLDER [FIRST]: by a SIGKILL.  What is painted stays in FOLDER/world.txt.
"""

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from unittest.mock import patch

from maulstick.painting.painting_file import read_painting, write_painting
from maulstick.robot.execute import execute
from maulstick.robot.journal import Journal, journal_of
from maulstick.robot.routine import routine
from maulstick.storage.arrays import Floats
from tests.support.robot.recorder import EASEL, Recorder
from tests.support.robot.small_paintings import SIX


class PowerCutError(BaseException):
    """Power cut: nothing that is still to be done is done."""


class Cut:
    """Power supply, which is cut at the Nth moment, never for 0.  moments: number of calls so far."""

    def __init__(self, at: int, power: Callable[[], None]) -> None:
        self.moments = 0
        self._at, self._power = at, power

    def __call__(self) -> None:
        self.moments += 1
        if self.moments == self._at:
            self._power()


class World:
    """Sheet in the world: the strokes that are really on it, each as often as it was drawn."""

    def __init__(self, folder: Path) -> None:
        self._file = folder / "world.txt"

    def painted(self) -> list[int]:
        return [int(word) for word in self._file.read_text().split()] if self._file.exists() else []

    def take(self, path: Floats) -> None:
        with self._file.open("a") as file:
            file.write(f"{row_of(path)}\n")


def row_of(path: Floats) -> int:
    """Return which of the six strokes lies there, from 10."""
    return 9 + round(float(-path[0, 1]) / 0.005)


class Painter(Recorder):
    """A machine in the world, which may be cut off before a stroke's ink and after it."""

    def __init__(self, world: World, cut: Cut) -> None:
        super().__init__()
        self._world, self._cut = world, cut

    def _stroke(self, path: Floats, speed: Floats) -> Floats:
        self._cut()
        self._world.take(path)
        self._cut()
        return path


@contextmanager
def power_cuts(cut: Cut) -> Iterator[None]:
    """Cut the power before, in the middle of, and after each write into a journal, and once it is flushed."""
    write = os.write

    def write_in_halves(file: int, content: bytes) -> int:
        cut()
        half = write(file, content[: len(content) // 2])
        cut()
        whole = half + write(file, content[half:])
        cut()
        return whole

    def flush(_: int) -> None:
        cut()  # and flush nothing, which takes its time: a process that is killed leaves what it has written

    with patch("os.write", write_in_halves), patch("os.fsync", flush):
        yield


def paint(folder: Path, cut: Cut, first: tuple[int, ...] = ()) -> list[int]:
    """Begin painting, or go on; returns the strokes that the operator was asked about."""
    world, painting, asked = World(folder), folder / "painting.json", []
    with power_cuts(cut), Journal.open(journal_of(painting)) as journal:
        if journal.revision is None:
            journal.revise(painting, painted=first)
        if (stroke := journal.unfinished) is not None:
            asked.append(stroke)
            (journal.end if stroke in world.painted() else journal.again)(stroke)
        plan = read_painting(journal.painting())
        with Painter(world, cut) as robot:
            actions = routine(plan, EASEL, robot.limits, done=journal.painted)
            execute(actions, robot, journal, lambda ask: None)
    return asked


def put_painting(folder: Path) -> None:
    """Painting of the six strokes."""
    write_painting(SIX, folder / "painting.json")


if __name__ == "__main__":
    paint(
        Path(sys.argv[2]),
        Cut(int(sys.argv[1]), lambda: os.kill(os.getpid(), signal.SIGKILL)),
        tuple(map(int, sys.argv[3:])),
    )
