"""Turns of the paints in a run: the order in which they are taken up, and how long each one draws."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from math import ceil

from maulstick.painting.painting import Paint, Painting
from maulstick.robot.duration import seconds_of
from maulstick.robot.limits import Limits
from maulstick.robot.routine import Action
from maulstick.storage.arrays import Floats


@dataclass(frozen=True)
class Turn:
    """Turn of one paint, or of one pen, until the next one is taken up.

    index: of the paint in the painting.  seconds: of the machine, without the time that an operator needs.
    """

    index: int
    paint: Paint
    seconds: float


def turns_of(actions: Sequence[Action], painting: Painting, limits: Limits, place: Floats) -> tuple[Turn, ...]:
    """Return the turns of a routine, in order, for a machine with these limits, whose tip is at `place` (3,)."""
    timed = zip(actions, seconds_of(actions, limits, place).tolist(), strict=True)
    runs = groupby(timed, key=lambda each: each[0].paint)
    return tuple(Turn(index, painting.paints[index], sum(seconds for _, seconds in run)) for index, run in runs)


def in_minutes(seconds: float) -> str:
    """Return a duration for people, in whole minutes and never too short: ``about 4 min``."""
    return "less than 1 min" if seconds < 60 else f"about {ceil(seconds / 60)} min"
