"""A machine that records its calls, after whatever a test wants to happen at that moment."""

from collections.abc import Callable

import numpy as np

from maulstick.robot.easel import Easel
from maulstick.robot.limits import Limits
from maulstick.robot.robot import Robot
from maulstick.storage.arrays import Floats

LIMITS = Limits(
    lower=(-0.1, -0.2, -0.02), upper=(0.2, 0.1, 0.1), speed=0.2, climb=0.1, acceleration=2.0, varies_pressure=True
)
EASEL = Easel(corner=(0, 0, 0), right=(1, 0, 0), down=(0, -1, 0), deepest=0.008)
Command = tuple[str, Floats]


class Recorder(Robot):
    """Robot that records its calls.

    commands: calls and their paths (n, 3).  down: whether the pen is down.  before: called before each.
    stands: place (3,) of the tip when it is entered.
    """

    def __init__(self, limits: Limits = LIMITS, before: Callable[[str], None] = lambda what: None) -> None:
        super().__init__(limits)
        self.commands: list[Command] = []
        self.down = False
        middle = np.add(limits.lower, limits.upper) / 2
        self.stands: Floats = np.array([*middle[:2], limits.upper[2]])
        self._before = before

    @property
    def said(self) -> list[str]:
        """Names of the calls so far."""
        return [what for what, _ in self.commands]

    def easel(self, width: float, height: float) -> Easel:
        return EASEL

    def _connect(self) -> None:
        pass

    def _open(self) -> Floats:
        self.down = False
        return self.stands

    def _close(self) -> None:
        self._note("close", np.empty((0, 3)))

    def _move(self, place: Floats) -> Floats:
        assert not self.down
        self._note("move", place[None])
        return place

    def _stroke(self, path: Floats, speed: Floats) -> Floats:
        self.down = True
        self._note("stroke", path)
        return path

    def _lift(self, place: Floats) -> Floats:
        self._note("lift", place[None])
        self.down = False
        return place

    def _halt(self) -> None:
        pass

    def _recover(self) -> None:
        self.down = False
        self._note("recover", np.empty((0, 3)))

    def _note(self, what: str, path: Floats) -> None:
        self._before(what)
        self.commands.append((what, path))
