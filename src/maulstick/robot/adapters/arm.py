"""What arms have in common: they stand anywhere, hold their tool as it is turned, and rise to lift the pen."""

from abc import abstractmethod
from contextlib import suppress
from typing import final

import numpy as np

from maulstick.errors import InputError, MachineError, Remedy
from maulstick.robot.easel import Easel
from maulstick.robot.limits import Limits
from maulstick.robot.robot import Robot, StoppedError
from maulstick.robot.stopping import Stopping
from maulstick.robot.timing import Profile
from maulstick.storage.arrays import Floats

_CLEARANCE = 1e-2  # metres, straight up, where nobody knows how high the paper is
_NOISE = 1e-3  # metres that an arm at the edge of its workspace may seem to be outside


class Arm(Robot):
    """A machine with joints: it pressures, and holds its tool as its operator turned it before connecting.

    Turning the tool upright instead would sweep whatever it holds across the easel. The tip is the tool centre point
    that is set at the arm itself.

    An adapter implements what is abstract here. All of it raises MachineError, in a sentence, where the arm fails.
    """

    def __init__(self, machine: Limits, narrower: Limits | None) -> None:
        super().__init__(machine if narrower is None else machine.narrowed(narrower))

    @final
    def easel(self, width: float, height: float) -> Easel:
        """Raise InputError: an arm may stand anywhere, so nobody knows where a sheet of this size, metres, lies."""
        raise InputError("an arm must be told where the sheet lies", Remedy.CALIBRATE_TOUCH)

    @abstractmethod
    def _disconnect(self) -> None:
        """Stand still, and disconnect whatever `_connect` has connected, all of it or nothing."""

    @abstractmethod
    def _where(self) -> Floats:
        """(3,) metres, where the tip is now."""

    @abstractmethod
    def _follow(self, profile: Profile, stopping: Stopping) -> None:
        """Drive the tip along the profile, from near its first point, and stand still at its end.

        Raises StoppedError, standing still, within 0.2 s after `stopping` is set.
        """

    @abstractmethod
    def _make_ready(self) -> None:
        """Stand still, clear what errors may be cleared without a person, and be ready to move."""

    @final
    def _open(self) -> Floats:
        self._rise()
        return self._where()

    @final
    def _close(self) -> None:
        with suppress(MachineError):  # a broken line needs no farewell
            self._disconnect()

    @final
    def _move(self, place: Floats) -> Floats:
        self._travel(place, self._stopping)
        return place

    @final
    def _stroke(self, path: Floats, speed: Floats) -> Floats:
        self._travel(path[0], self._stopping)
        self._follow(Profile.of(path, speed, self.limits), self._stopping)
        return path

    @final
    def _lift(self, place: Floats) -> Floats:
        return self._move(place)

    @final
    def _halt(self) -> None:
        """Nothing: `_follow` looks at `_stopping`, and the locks of an SDK are not for signal handlers."""

    @final
    def _recover(self) -> None:
        self._make_ready()
        self._rise()

    def _travel(self, place: Floats, stopping: Stopping) -> None:
        if stopping.is_set():
            raise StoppedError
        way = np.stack([self._where(), place])
        self._follow(Profile.of(way, np.full(2, self.limits.speed), self.limits), stopping)

    def _rise(self) -> None:
        """Go straight up, even after a stop, by the clearance or as far as the workspace reaches."""
        place = self._where()
        lower, upper = np.array(self.limits.lower), np.array(self.limits.upper)
        within = place.clip(lower, upper)
        if np.abs(place - within).max() > _NOISE:
            raise MachineError(
                f"the tip stands at {_millimetres(place)}, outside the workspace from {_millimetres(lower)} to "
                f"{_millimetres(upper)}; guide the arm back by hand"
            )
        above = within + np.array([0, 0, _CLEARANCE])
        self._travel(above.clip(max=upper), Stopping())


def _millimetres(place: Floats) -> str:
    return f"({', '.join(f'{1e3 * value:.0f}' for value in place)}) mm"
