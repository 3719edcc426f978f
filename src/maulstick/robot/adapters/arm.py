"""The base of arms: they may stand anywhere, keep the orientation of their tool, and rise to lift the pen."""

from abc import abstractmethod
from contextlib import suppress
from typing import TYPE_CHECKING, final

import numpy as np

from maulstick.errors import InputError, MachineError, Remedy
from maulstick.robot.easel import Easel
from maulstick.robot.limits import Limits
from maulstick.robot.reach import Reach
from maulstick.robot.robot import Robot, StoppedError
from maulstick.robot.stopping import Stopping
from maulstick.robot.timing import Profile
from maulstick.storage.arrays import Floats

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

_CLEARANCE = 1e-2  # metres that the tip rises where the height of the paper is not known
_DOWNWARDS = 0.9  # cosine of 26 degrees: a flange that is tilted more is a long way from what a reach is computed for
_NOISE = 1e-3  # metres: an arm that reports to be so far outside its workspace counts as at its edge


class Arm(Robot):
    """Machine with joints: it varies the pressure, and keeps the orientation that its tool had when it was connected.

    Turning the tool upright instead would sweep whatever it holds across the easel. The tip is the tool centre point
    that is set at the arm itself.

    machine: limits of the arm.  narrower: limits of the easel, if any.
    An adapter implements the abstract methods. All of them raise MachineError, in a sentence, where the arm fails.
    Once it is connected, it says what it `_reaches`, and where it can, it asks its controller in `_accepts`.
    """

    def __init__(self, machine: Limits, narrower: Limits | None) -> None:
        super().__init__(machine if narrower is None else machine.narrowed(narrower))

    @final
    def easel(self, width: float, height: float) -> Easel:
        """Raise InputError: an arm may stand anywhere, so the place of a sheet of this size, metres, is not known."""
        raise InputError("an arm must be told where the sheet lies", Remedy.CALIBRATE_TOUCH)

    @abstractmethod
    def _disconnect(self) -> None:
        """Stop, and disconnect what `_connect` has connected, be it all, a part or nothing."""

    @abstractmethod
    def _where(self) -> Floats:
        """Ask the arm where its tip is now, (3,) metres."""

    @abstractmethod
    def _follow(self, profile: Profile, stopping: Stopping) -> None:
        """Drive the tip along the profile, from near its first point, and stop at its end.

        Raises StoppedError, at rest, within 0.2 s after `stopping` is set.
        """

    @abstractmethod
    def _make_ready(self) -> None:
        """Stop, clear the errors that may be cleared without a person, and make the arm ready to move."""

    @final
    def _reaches(self, reach: Reach, pose: Floats, tool: Floats) -> None:
        """Take over the reach of the model, for a pen that is held as now; none where the flange points aside.

        pose: (4, 4) of the tip in the machine's frame.  tool: (4, 4) of the tip as the flange sees it; metres.
        """
        flange = pose[:3, :3] @ tool[:3, :3].T
        held = reach.holding(flange, tool[:3, 3]) if flange[2, 2] < -_DOWNWARDS else None
        self.limits = self.limits.model_copy(update={"reach": held})

    @final
    def _open(self) -> Floats:
        self._rise()
        return self._where()

    @final
    def _close(self) -> None:
        with suppress(MachineError):  # a broken line cannot be closed in order
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
        """Do nothing: `_follow` looks at `_stopping`, and a signal handler must not wait for the locks of an SDK."""

    @final
    def _recover(self) -> None:
        self._make_ready()
        self._rise()

    def _travel(self, place: Floats, stopping: Stopping) -> None:
        """Move straight from where the tip is to a place (3,). Raises StoppedError once `stopping` is set."""
        if stopping.is_set():
            raise StoppedError
        way = np.stack([self._where(), place])
        self._follow(Profile.of(way, np.full(2, self.limits.speed), self.limits), stopping)

    def _rise(self) -> None:
        """Move straight up by the clearance, or as far as the workspace reaches, even after a stop."""
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


def pose_of(place: Floats, turned: "Rotation") -> Floats:
    """Return the pose (4, 4) at a place (3,), metres, turned so."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turned.as_matrix(), place
    return pose


def _millimetres(place: Floats) -> str:
    return f"({', '.join(f'{1e3 * value:.0f}' for value in place)}) mm"
