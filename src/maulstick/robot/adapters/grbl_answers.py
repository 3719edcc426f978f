"""Answers of Grbl 1.1: its status, its settings as limits, and sentences for its error and alarm codes."""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, Self

import numpy as np

from maulstick.errors import Remedy
from maulstick.robot.easel import Pen
from maulstick.robot.limits import Limits
from maulstick.storage.arrays import Floats

_MM = 1e-3  # metres
_MM_PER_MINUTE = 1e-3 / 60  # metres per second
_MILLISECONDS = 1e-3  # seconds
_ALWAYS_ON = 255  # as $1: the motors are held, and nothing waits until they are let go
_ANSWER = 5e-3, 4e-3  # seconds from the end of a motion, or of lifting a servo, to its answer: tests/robot/dialogues
_NUMBER = r"-?\d+(?:\.\d+)?"
_PLACE = rf"({_NUMBER},{_NUMBER},{_NUMBER})(?:,{_NUMBER})*"  # some boards have more axes, which we never move

ERRORS: Final = {
    1: "a word of G-code has no letter",
    2: "a number is missing or cannot be read",
    3: "it does not know that $ command",
    4: "a number is negative that must not be",
    5: "homing is switched off; set $22=1 if it has limit switches",
    6: "its step pulses are shorter than 3 microseconds; set $0 to 3 or more",
    7: "it could not read its memory and took the factory settings; check $$",
    8: "it takes that $ command only when idle",
    9: "it takes no G-code while it is locked",
    10: "soft limits need homing; set $22=1 or $20=0",
    11: "a line was too long for it",
    12: "a setting asks for more steps per second than it can make",
    13: "its safety door is open; close it",
    14: "a start-up line was too long for its memory",
    15: "a jog would leave its travel",
    16: "a jog command is malformed",
    17: "laser mode needs a spindle with PWM; set $32=0",
    20: "it does not support a command of G-code",
    21: "two commands of one line exclude each other",
    22: "no feed has been set",
    23: "a command needs a whole number",
    24: "two commands of one line both use axes",
    25: "a word is repeated in a line",
    26: "a command needs axes and has none",
    27: "a line number is out of range",
    28: "a command lacks a value",
    29: "it has only the work coordinates G54 to G59",
    30: "G53 goes with G0 and G1 only",
    31: "there are axes that no command uses",
    32: "an arc needs an axis in its plane",
    33: "the target of a motion is invalid",
    34: "the radius of an arc is invalid",
    35: "an arc needs an offset in its plane",
    36: "there are values that no command uses",
    37: "a tool length offset is for another axis",
    38: "the number of a tool is too large",
}

ALARMS: Final = {
    1: "a limit switch was hit and its position is lost",
    2: "a motion would leave its travel; check where its work origin lies",
    3: "it was reset while it moved and its position is lost",
    4: "the probe was not in its first state",
    5: "the probe touched nothing",
    6: "homing was interrupted by a reset",
    7: "the safety door was opened while homing; close it",
    8: "homing could not leave a limit switch; check its wiring, or set a longer pull-off $27",
    9: "homing did not find a limit switch; check its wiring, or set the travels $130 to $132",
}

REMEDIES: Final = {f"ALARM:{code}": Remedy.HOME for code in (1, 3, 6, 7)} | {
    "ALARM:2": Remedy.UNLOCK,
    "error:9": Remedy.UNLOCK,
}
"""What helps after some of them, where each front end says it its own way."""

MOVES: Final = ((110, "speed", "mm/min"), (120, "acceleration", "mm/s²"), (130, "travel", "mm"))
"""Settings by which an axis moves: the number of that of x, before those of y and z, what it is, and its unit."""


@dataclass(frozen=True)
class Status:
    """Status report: the state (Idle, Run, Hold:0 ...) and the place of the tip, (3,) metres.

    of_machine: whether the place is counted from the machine's own origin, not from the work's.
    override: per cent of the commanded speed; None where this report does not say it, as most do not.
    """

    state: str
    tip: Floats
    of_machine: bool
    override: int | None = None

    @classmethod
    def parse(cls, line: str) -> Self | None:
        """Parse a line; returns None where it is no report, or noise has changed it."""
        found = re.fullmatch(rf"<([A-Z][a-z]+(?::\d)?)\|([MW])Pos:{_PLACE}(?:\|[A-Za-z]+:[\w.,-]*)*>", line)
        if found is None:
            return None
        overrides = re.search(r"\|Ov:(\d+),", line)
        return cls(found[1], _triple(found[3]), found[2] == "M", None if overrides is None else int(overrides[1]))


def settings_of(lines: Iterable[str]) -> dict[int, float]:
    """Return the settings in the answer to $$, by their numbers; other lines are left out."""
    found = (re.fullmatch(rf"\$(\d+)=({_NUMBER})", line) for line in lines)
    return {int(setting[1]): float(setting[2]) for setting in found if setting is not None}


def homing_seconds(settings: dict[int, float]) -> float:
    """Return how long finding home takes at most: z, and then x and y, go half as far again as their travels ($130 on).

    Each is sought at $25, and once more at $24 within five times the pull-off $27.
    """
    travel = max(settings[130], settings[131], settings[132])
    return 2 * 60 * (1.5 * travel / settings[25] + 10 * settings[27] / settings[24])


def work_origin(lines: Iterable[str]) -> Floats | None:
    """Return the work's origin in machine coordinates, (3,) metres, from the answer to $#; None where it is missing."""
    told: dict[str, Floats] = {}
    for line in lines:
        if found := re.fullmatch(rf"\[(G54|G92):{_PLACE}\]", line):
            told[found[1]] = _triple(found[2])
        elif found := re.fullmatch(rf"\[TLO:({_NUMBER})\]", line):
            told["TLO"] = np.array([0, 0, _MM * float(found[1])])
    return sum(told.values(), np.zeros(3)) if len(told) == 3 else None


def is_zero_at_switches(lines: Iterable[str]) -> bool:
    """Return whether the answer to $I has the letter Z: each axis is then at 0 where it has found its switch."""
    found = (re.match(r"\[OPT:([^,\]]*)", line) for line in lines)
    return any("Z" in options[1] for options in found if options is not None)


def own_limits(settings: dict[int, float], origin: Floats, pen: Pen | None, zero_at_switches: bool = False) -> Limits:
    """Return the limits of a Grbl with these settings, in coordinates of its work, whose origin (3,) is in metres.

    With homing the travel lies below the machine's own origin, on every axis, unless that is `zero_at_switches`, from
    which an axis in the mask $23 goes up. Without homing, the machine is taken to have been switched on in the lower
    left corner of its travel, as plotters are, the tip on the paper or above it.
    pen: servo of its pen, None where it lifts by height. With a servo nothing moves along z, so that heights are only
    numbers, and what z says of speed and acceleration does not count.
    Grbl waits for $1 at the end of every motion, before it answers and lets go of its motors, unless $1 is 255.
    Raises KeyError where a setting is missing.
    """
    idle = 0.0 if settings[1] == _ALWAYS_ON else _MILLISECONDS * settings[1]
    x, y, z = axes = 0, 1, 2 if pen is None else 0
    rates = [_MM_PER_MINUTE * settings[110 + axis] for axis in axes]
    gains = (_MM * settings[120 + x], _MM * settings[120 + y], _MM * settings[120 + z])
    travel = np.array([_MM * settings[code] for code in (130, 131, 132)])
    if settings[22]:
        rises = [zero_at_switches and int(settings[23]) >> axis & 1 for axis in range(3)]
        upper = travel * rises - origin
        lower = upper - travel
    else:
        lower, upper = travel * (0, 0, -1), travel
    if pen is not None:
        highest = travel[2] or travel[0]  # z of a machine that has none may be as high as any
        lower[2], upper[2] = -highest, highest
    return Limits(
        lower=tuple(lower.tolist()),
        upper=tuple(upper.tolist()),
        speed=min(rates[:2]),
        climb=rates[2],
        acceleration=min(gains),
        axes=gains,
        deviation=_MM * settings[11],
        varies_pressure=pen is None,
        lifting=0.0 if pen is None else pen.seconds + _ANSWER[1],
        settling=idle + _ANSWER[0],
    )


def _triple(numbers: str) -> Floats:
    return np.array([_MM * float(number) for number in numbers.split(",")])
