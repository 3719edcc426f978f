"""Estimate of a run: strokes, metres and seconds."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

from maulstick.jobs.paint.turns import Turn, turns_of
from maulstick.painting.painting import Painting
from maulstick.robot.duration import drawn_metres
from maulstick.robot.limits import Limits
from maulstick.robot.routine import Action, Draw
from maulstick.storage.arrays import Floats


@dataclass(frozen=True)
class Estimate:
    """Estimate of a run.

    strokes, metres, seconds: what is left, without the time that an operator needs.  painted: strokes that are painted
    already.  paints: of the whole painting.  more_sheets: how many copies follow this sheet.
    notes: sentences about what is not drawn as its file says.  turns: of the paints that are left, in their order.
    """

    strokes: int
    metres: float
    seconds: float
    painted: int
    paints: int
    notes: tuple[str, ...] = ()
    more_sheets: int = 0
    turns: tuple[Turn, ...] = ()

    @classmethod
    def of(cls, actions: Sequence[Action], painting: Painting, limits: Limits, place: Floats) -> Self:
        """Return the estimate of a routine for a machine with these limits, whose tip is at `place` (3,)."""
        strokes = sum(isinstance(action, Draw) for action in actions)
        turns = turns_of(actions, painting, limits, place)
        seconds = sum(turn.seconds for turn in turns)
        painted = len(painting.strokes) - strokes
        return cls(strokes, drawn_metres(actions), seconds, painted, len(painting.colours()), turns=turns)
