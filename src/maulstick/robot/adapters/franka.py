"""Franka's arms, FER and FR3: whole paths through franky-control, which sends a thousand set-points per second.

Waypoints are samples of our own profile; each has a time and a velocity, so that the arm neither waits at them nor
plans a motion of its own between them.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Final, final

import numpy as np

from maulstick.errors import InputError, MachineError, how_to_add
from maulstick.robot.adapters.arm import Arm
from maulstick.robot.adapters.reaches import FRANKA_REACH
from maulstick.robot.force import FeelsForce
from maulstick.robot.limits import Limits
from maulstick.robot.robot import StoppedError
from maulstick.robot.stopping import Stopping
from maulstick.robot.timing import Profile
from maulstick.storage.arrays import Floats

FRANKA_LIMITS: Final = Limits(
    lower=(0.3, -0.35, -0.1),
    upper=(0.7, 0.35, 0.6),
    speed=0.2,
    climb=0.1,
    acceleration=1.0,
    deviation=2e-4,
    varies_pressure=True,
    lifting=0.03,
)
"""Limits: a box before the arm; franky has no inverse kinematics to ask, so that `reach` alone says what it gets to.

Lifting and lowering take two motions each, and each begins some 15 ms after it is sent (measured in franky-sim).
"""

_STEP: Final = 0.03  # seconds from waypoint to waypoint
_CYCLE: Final = 1e-3  # seconds: a waypoint is left in the cycle after its time
_BRISKNESS: Final = 0.3  # of the arm's own speed, acceleration and jerk, at most, from waypoint to waypoint
_BRAKING: Final = 0.5  # of the same, to stop
_GLANCE: Final = 0.02  # seconds between two looks at the stop flag
_BRAKED: Final = 1.0  # seconds to come to rest in; after that franky's own stop is called


@final
class Franka(Arm, FeelsForce):
    """Franka FER or FR3 at an IP address, with FCI active; the limits narrow FRANKA_LIMITS."""

    def __init__(self, address: str, limits: Limits | None = None) -> None:
        super().__init__(FRANKA_LIMITS, limits)
        self._address = address
        self._arm: Any = None
        self._turned: Any = None

    def force(self) -> float:
        """Return the force along z at the tip, newtons, of which only differences count."""
        with self._line():
            return float(self._arm.state.O_F_ext_hat_K[2])

    def _connect(self) -> None:
        try:
            import franky
        except ImportError as error:
            raise InputError(f"the library for a Franka is not installed; {how_to_add('franka')}") from error
        with self._line(), _scheduling_kept():
            # A kernel without real time works, too: where it is late, the arm stops with an error.
            self._arm = franky.Robot(self._address, realtime_config=franky.RealtimeConfig.Ignore)
        self._make_ready()
        with self._line():
            pose = self._arm.current_pose.end_effector_pose
            self._turned = pose.quaternion
            self._reaches(FRANKA_REACH, pose.matrix, self._arm.state.F_T_EE.matrix)

    def _disconnect(self) -> None:
        if self._arm is not None:
            try:
                self._brake()
            finally:
                self._arm = None

    def _where(self) -> Floats:
        with self._line():
            return np.array(self._arm.current_pose.end_effector_pose.translation, dtype=np.float64)

    def _follow(self, profile: Profile, stopping: Stopping) -> None:
        if profile.seconds == 0:
            return
        with self._line():
            self._arm.move(self._motion(profile), asynchronous=True)
            while not self._arm.join_motion(timeout=_GLANCE):
                if stopping.is_set():
                    self._brake()
        if stopping.is_set():
            raise StoppedError

    def _motion(self, profile: Profile) -> Any:
        import franky

        count = max(round(profile.seconds / _STEP), 1)
        times = np.append(_STEP * np.arange(count), profile.seconds)
        places = profile.at(times)
        velocities = np.gradient(places, times, axis=0)
        velocities[-1] = 0
        waypoints = [
            franky.CartesianWaypoint(
                franky.CartesianState(franky.Affine(place, self._turned), franky.Twist(velocity)),
                minimum_time=franky.Duration(max(round((seconds - _CYCLE) / _CYCLE), 0)),
            )
            for place, velocity, seconds in zip(places[1:], velocities[1:], np.diff(times), strict=True)
        ]
        return franky.CartesianWaypointMotion(waypoints, relative_dynamics_factor=_BRISKNESS)

    def _make_ready(self) -> None:
        self._brake()
        with self._line():
            if self._arm.has_errors and not self._arm.recover_from_errors():
                raise MachineError("the Franka does not recover from its error; see what Desk says")

    def _brake(self) -> None:
        import franky

        with self._line():
            if self._arm.is_in_control:
                self._arm.move(franky.CartesianStopMotion(_BRAKING), asynchronous=True)
                if not self._arm.join_motion(timeout=_BRAKED):
                    self._arm.stop()

    @contextmanager
    def _line(self) -> Iterator[None]:
        """Turn what franky raises into MachineError."""
        import franky

        try:
            yield
        except (franky.NetworkException, RuntimeError) as error:  # the latter from the sockets beneath libfranka
            raise MachineError(
                f"the Franka at {self._address} does not answer ({_one_line(error)}); check the cable, and that FCI is "
                "active in Desk"
            ) from error
        except (franky.ControlException, franky.CommandException) as error:
            raise MachineError(
                f"the Franka stopped: {_one_line(error)}; see that nothing holds it, and that no button is pressed"
            ) from error
        except franky.Exception as error:
            raise MachineError(f"the Franka cannot be driven: {_one_line(error)}") from error


@contextmanager
def _scheduling_kept() -> Iterator[None]:
    """Keep this thread's scheduling: libfranka lets it go before all others, and so would whatever it starts.

    The thread that franky moves the arm in is made urgent by itself.
    """
    policy, parameters = os.sched_getscheduler(0), os.sched_getparam(0)
    try:
        yield
    finally:
        os.sched_setscheduler(0, policy, parameters)


def _one_line(error: BaseException) -> str:
    return " ".join(str(error).removeprefix("libfranka: ").split())
