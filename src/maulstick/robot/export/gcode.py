"""Motions as lines of G-code, for GRBL or Marlin: millimetres with three decimals, feeds in millimetres a minute.

On the wire a place is a whole number of micrometres within the limits, whatever it was before.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from maulstick.robot.easel import Pen
from maulstick.robot.limits import Limits
from maulstick.storage.arrays import Floats

Dialect = Literal["grbl", "marlin"]

_MM = 1e3
_MICROMETRES = 1e6
_NEAR = 1e-4  # what a limit, as written, may miss a whole last digit by and still mean it: within the limits' SLACK
_SLOWEST = 1.0  # mm/min; slower is an error to GRBL
_STRAIGHT = 1e-12  # metres
_LONGEST_MESSAGE = 60  # characters, of what Marlin keeps of a line


@dataclass(frozen=True)
class Gcode:
    """Writes motions within the limits as lines without their ends; the caller knows where the tip is.

    pen: how its servo lifts it; without one it is lifted by height.
    Each motion raises InputError where it leaves the limits.
    """

    dialect: Dialect
    limits: Limits
    pen: Pen | None = None

    def rounded(self, path: Floats) -> Floats:
        """The path (..., 3) in metres as it is written, rounded towards the inside at the limits."""
        lower = np.ceil(np.array(self.limits.lower) * _MICROMETRES - _NEAR)
        upper = np.floor(np.array(self.limits.upper) * _MICROMETRES + _NEAR)
        return np.asarray(np.clip(np.rint(np.asarray(path) * _MICROMETRES), lower, upper) / _MICROMETRES + 0.0)

    def begin(self) -> list[str]:
        """Millimetres, absolute places."""
        return ["G21", "G90"] if self.dialect == "marlin" else ["G21", "G90", "G94", "G54"]

    def travel(self, start: Floats, place: Floats) -> list[str]:
        """Straight from where the tip is, (3,), to a place (3,), the pen lifted, as fast as may be."""
        self.limits.check_path(place[None])
        return [self._straight(start, place, self.limits.speed)]

    def draw(self, start: Floats, path: Floats, speed: Floats) -> list[str]:
        """Lower the pen from `start` (3,) to the path (n, 3), and follow it at most at speed (n,) metres a second."""
        self.limits.check_path(path)
        self.limits.check_speed(speed)
        if self.pen is None:
            lowered = [self._straight(start, path[0], self.limits.speed)]
        else:
            lowered = self._servo(self.pen.down, self.pen.seconds)
        feeds = np.minimum(speed[:-1], speed[1:])
        lines = [self._straight(*ends) for ends in zip(path[:-1], path[1:], feeds, strict=True)]
        return [*lowered, *lines]

    def lift(self, place: Floats) -> list[str]:
        """Raise the pen straight up to a place (3,)."""
        self.limits.check_path(place[None])
        if self.pen is not None:
            return self._servo(self.pen.up, self.pen.seconds)
        return [f"G1 Z{_MM * self.rounded(place)[2]:.3f} F{_feed(min(self.limits.speed, self.limits.climb)):.1f}"]

    def pause(self, message: str) -> list[str]:
        """Wait until the operator lets the machine go on, and tell why."""
        said = "".join(filter(_is_harmless, message))[:_LONGEST_MESSAGE]
        return [f"M0 {said}"] if self.dialect == "marlin" else [f"({said})", "M0"]

    def _straight(self, start: Floats, place: Floats, speed: float) -> str:
        step = place - start
        climbing = abs(step[2]) / max(float(np.sqrt((step**2).sum())), _STRAIGHT)
        x, y, z = _MM * self.rounded(place)
        if self.pen is not None:
            return f"G1 X{x:.3f} Y{y:.3f} F{_feed(speed):.1f}"
        speed = min(speed, self.limits.climb / max(climbing, _STRAIGHT))
        return f"G1 X{x:.3f} Y{y:.3f} Z{z:.3f} F{_feed(speed):.1f}"

    def _servo(self, target: float, seconds: float) -> list[str]:
        if self.dialect == "marlin":  # its servo does not wait for motions that were sent before
            return ["M400", f"M280 P0 S{target:g}", f"G4 P{np.ceil(1e3 * seconds):.0f}"]
        return [f"M3 S{target:g}", f"G4 P{seconds:.3f}"]


def _is_harmless(letter: str) -> bool:
    """Whether it ends no comment, and Grbl does not take it for a command that may come at any time, as 0x84 is."""
    return letter.isascii() and letter.isprintable() and letter not in "();?!~"


def _feed(speed: float) -> float:
    """A speed in metres a second in mm/min, not rounded up."""
    return max(float(np.floor(600 * _MM * speed + _NEAR)) / 10, _SLOWEST)
