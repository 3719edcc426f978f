"""Motions as lines of G-code, for Grbl or Marlin: millimetres with three decimals, feeds in millimetres per minute.

Places are written as whole micrometres, rounded so that they stay within the limits.
"""

import re
from dataclasses import dataclass
from textwrap import wrap
from typing import Literal
from unicodedata import normalize

import numpy as np

from maulstick.errors import InputError
from maulstick.robot.easel import Pen
from maulstick.robot.limits import Limits
from maulstick.storage.arrays import Floats

Dialect = Literal["grbl", "marlin"]

_MM = 1e3  # per metre
_MICROMETRES = 1e6  # per metre
_NEAR = 1e-4  # what a limit, as written, may miss a whole last digit by and still mean it: within the limits' SLACK
_SLOWEST = 1.0  # mm/min: the least feed written; slower is an error to Grbl
_STRAIGHT = 1e-12  # metres: least length, so that no division is by zero
_MOST_SERVO = 65_535  # of 16 bits, in which boards time the pulses of a servo; without an exponent as it is written
_TIME = re.compile(r"([ps])(?= *[-+.\d])", re.IGNORECASE)  # Marlin waits so long, and not for a person: M0 STEP 2
_LONGEST_MESSAGE = 60  # characters, fewer than Marlin keeps of a line, and than senders may put into Grbl's buffer


@dataclass(frozen=True)
class Gcode:
    """Writer of motions within the limits, as lines without line ends; the caller keeps the place of the tip.

    pen: servo of the pen; None where it is lifted by height.
    Raises InputError for a number of the servo that controllers refuse: the pen would stay down. Each motion raises
    InputError where it leaves the limits.
    """

    dialect: Dialect
    limits: Limits
    pen: Pen | None = None

    def __post_init__(self) -> None:
        for number in () if self.pen is None else (self.pen.up, self.pen.down):
            if not 0 <= number <= _MOST_SERVO:
                raise InputError.of_range("a number of the servo", f"{number:g}", f"from 0 to {_MOST_SERVO} in G-code")

    def rounded(self, path: Floats) -> Floats:
        """Return the path (..., 3), metres, as it is written, rounded towards the inside at the limits."""
        lower = np.ceil(np.array(self.limits.lower) * _MICROMETRES - _NEAR)
        upper = np.floor(np.array(self.limits.upper) * _MICROMETRES + _NEAR)
        return np.asarray(np.clip(np.rint(np.asarray(path) * _MICROMETRES), lower, upper) / _MICROMETRES + 0.0)

    def begin(self) -> list[str]:
        """Return the lines that set millimetres and absolute places."""
        return ["G21", "G90"] if self.dialect == "marlin" else ["G21", "G90", "G94", "G54"]

    def travel(self, start: Floats, place: Floats) -> list[str]:
        """Move straight from `start` (3,) to a place (3,), metres, the pen lifted, as fast as the limits allow."""
        self.limits.check_path(place[None])
        return [self._straight(start, place, self.limits.speed)]

    def draw(self, start: Floats, path: Floats, speed: Floats) -> list[str]:
        """Lower the pen from `start` (3,) to the path (n, 3), and follow it; speed: (n,) metres per second at most."""
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
        """Lift the pen straight up to a place (3,), metres; only its height has to be within the limits."""
        self.limits.check_height(float(place[2]))
        if self.pen is not None:
            return self._servo(self.pen.up, self.pen.seconds)
        return [f"G1 Z{_MM * self.rounded(place)[2]:.3f} F{_feed(min(self.limits.speed, self.limits.climb)):.1f}"]

    def pause(self, message: str) -> list[str]:
        """Pause until the operator lets the machine go on, and show the message, without accents.

        Marlin shows the beginning of one that is long; a comment before it has all.
        """
        said = "".join(filter(_is_harmless, normalize("NFD", message.replace("ß", "ss"))))
        if self.dialect == "grbl":
            parts = wrap(said, _LONGEST_MESSAGE, break_on_hyphens=False) or [""]
            return [*(f"({part})" for part in parts), "M0"]
        is_long = len(said) > _LONGEST_MESSAGE
        shown = said[: _LONGEST_MESSAGE - 3] + "..." if is_long else said
        return [*([f"; {said}"] if is_long else []), "M0 " + _TIME.sub(r"\1:", shown)]

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
    """Return whether a letter neither ends a comment or a line nor is a real-time command of Grbl, as ! and 0x84."""
    return letter.isascii() and letter.isprintable() and letter not in "();?!~*"


def _feed(speed: float) -> float:
    """Return a speed in metres per second as mm/min, rounded down to a tenth."""
    return max(float(np.floor(600 * _MM * speed + _NEAR)) / 10, _SLOWEST)
