"""Stops of a routine: pauses before strokes, and prompts to refill or clean a pen that no tray refills."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, final

import numpy as np

from maulstick.errors import InputError, option
from maulstick.painting.painting import Painting
from maulstick.robot.duration import seconds_of
from maulstick.robot.easel import Easel
from maulstick.robot.limits import Limits
from maulstick.robot.room import check_room
from maulstick.robot.routine import NOTHING, Action, Draw, PaintLoad, Prompt, ways_of

UNKNOWN: Final = PaintLoad(None, float("inf"), float("inf"))
"""Load of a pen that has drawn in an earlier run, nobody knows how much: it has to be refilled first."""


@final
@dataclass(frozen=True)
class Stops:
    """Stops at which the operator is asked, beside those for pens.

    pauses: ids of strokes before which the machine waits, and their numbers for people, counted from 1.
    metres, seconds: of drawing, after which a pen is refilled or cleaned, before the stroke that would be beyond it.
    aside: x and y of the canvas, metres, where the lifted pen moves to be refilled; None stays.
    """

    pauses: Mapping[int, int] = field(default_factory=dict)
    metres: float = float("inf")
    seconds: float = float("inf")
    aside: tuple[float, float] | None = None

    def put_into(
        self,
        actions: Sequence[Action],
        painting: Painting,
        easel: Easel,
        limits: Limits,
        load: PaintLoad = NOTHING,
    ) -> list[Action]:
        """Return the actions of a routine with these stops.

        load: the paint that the machine holds at the beginning, and how much it has drawn with it.
        Raises InputError where the place aside, or the way there, is outside the limits.
        """
        aside = self._aside(easel, limits)
        if not self.pauses and np.isinf([self.metres, self.seconds]).all():
            return list(actions)
        start = next((action.motion.start for action in actions if not isinstance(action, Prompt)), np.zeros(3))
        stopping: list[Action] = []
        for action, seconds in zip(actions, seconds_of(actions, limits, start).tolist(), strict=True):
            if isinstance(action, Prompt):
                load = PaintLoad(action.paint)
            if isinstance(action, Draw):
                if (number := self.pauses.get(action.stroke)) is not None:
                    stopping.append(Prompt(f"do what the pause before stroke {number} is for", action.paint, False))
                if self._is_due(load, action.motion.length, seconds):
                    stopping.append(Prompt(_refilling(painting, action.paint), action.paint, aside=aside))
                    load = PaintLoad(action.paint)
                load = load.after(action.paint, action.motion.length, seconds)
            stopping.append(action)
        if aside is not None:
            check_room(ways_of(stopping), easel, limits)
        return stopping

    def _is_due(self, load: PaintLoad, metres: float, seconds: float) -> bool:
        """Return whether a stroke is beyond what a pen draws; never for one that was just refilled."""
        beyond = load.painted + metres > self.metres or load.seconds + seconds > self.seconds
        return load.painted > 0 and beyond

    def _aside(self, easel: Easel, limits: Limits) -> tuple[float, float, float] | None:
        if self.aside is None:
            return None
        place = easel.canvas_to_machine(np.array([*self.aside, easel.travel]))
        try:
            limits.check_path(place[None])
        except InputError as error:
            raise InputError(f"{option('refill_at')} is where the machine does not go: {error.fault}") from error
        if limits.reach is not None and limits.reach.beyond(place[None]).any():
            raise InputError(f"{option('refill_at')} is where the machine does not go: {limits.reach.fault(place)}")
        x, y, z = place.tolist()
        return x, y, z


def _refilling(painting: Painting, paint: int) -> str:
    wanted = painting.paints[paint]
    return f"refill or clean the {wanted.brush} with the paint {wanted.label}"
