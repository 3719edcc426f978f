"""Streaming of set-points, for machines that move at once to the last place that they were sent."""

import time
from collections.abc import Callable

import numpy as np

from maulstick.errors import MachineError
from maulstick.robot.robot import StoppedError
from maulstick.robot.stopping import Stopping
from maulstick.robot.timing import Profile
from maulstick.storage.arrays import Floats

_BRAKING = 0.1  # seconds from any speed to rest, along the path
_LATEST = 3  # periods by which a busy computer may be late; a longer delay slows the motion, so set-points never leap
_ARRIVED = 5e-4  # metres from the last set-point at which the tip counts as arrived
_PATIENCE = 1.0  # seconds after the last set-point in which it must arrive


def stream(
    profile: Profile,
    send: Callable[[Floats], None],
    where: Callable[[], Floats],
    period: float,
    stopping: Stopping,
) -> None:
    """Send the place (3,), metres, where the tip should be, every `period` seconds; returns once it is at the end.

    where: asks the machine for the place of its tip, (3,) metres.
    Raises StoppedError, at rest, soon after `stopping` is set; MachineError where the tip does not arrive.
    """
    gone, pace, last = 0.0, 1.0, time.monotonic()
    while gone < profile.seconds and pace > 0:
        time.sleep(max(0.0, last + period - time.monotonic()))
        now = time.monotonic()
        passed, last = min(now - last, _LATEST * period), now
        if stopping.is_set():
            pace = max(pace - passed / _BRAKING, 0.0)
        gone = min(gone + pace * passed, profile.seconds)
        send(profile.at(np.array([gone]))[0])
    goal, ended = profile.points[-1], time.monotonic()
    while not stopping.is_set() and (missing := float(np.linalg.norm(where() - goal))) > _ARRIVED:
        if time.monotonic() - ended > _PATIENCE:
            raise MachineError(f"the arm stands {1e3 * missing:.2g} mm beside where it was sent; see what holds it")
        send(goal)
        time.sleep(period)
    if stopping.is_set():
        raise StoppedError
