"""Pace of a machine: the speed of drawing, which a person may change while it draws."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final, final

import numpy as np

from maulstick.robot.duration import seconds_of
from maulstick.robot.limits import Limits
from maulstick.robot.plotter import OverridesSpeed
from maulstick.robot.robot import Robot
from maulstick.robot.routine import Action, Draw, Motion, Prompt
from maulstick.storage.arrays import Floats

STEP: Final = 10
"""Per cent by which one key changes the pace, as Grbl's coarse steps do."""

_SLOWEST, _FASTEST = 10, 200  # per cent: the range of Grbl's overrides
_SAMPLE = 200  # actions whose time is estimated again when the pace changes: some 0.1 s


@final
class Pace:
    """Pace of a machine in per cent of the planned speed, which another thread may change.

    A machine that changes its speed at once does so in the middle of a stroke; others draw the next stroke so.
    """

    def __init__(self, robot: Robot) -> None:
        self.percent = 100
        self._robot = robot

    def change(self, steps: int) -> None:
        """Draw faster by so many steps of 10 %, or slower where they are negative, from 10 % to 200 %.

        A machine that changes its speed at once may allow less: its travel would leave narrower limits.
        """
        overriding = self._robot if isinstance(self._robot, OverridesSpeed) else None
        most = _FASTEST if overriding is None else min(overriding.highest_override, _FASTEST)
        self.percent = min(max(self.percent + steps * STEP, _SLOWEST), most)
        if overriding is not None:
            overriding.override(self.percent)

    def paced(self, motion: Motion) -> Motion:
        """Return the motion as it is to be sent now: with other speeds, unless the machine changes them itself."""
        return motion if isinstance(self._robot, OverridesSpeed) else _scaled(motion, self.percent, self._robot.limits)

    def share_of_time(self, actions: Sequence[Action], seconds: Floats, index: int) -> float:
        """Return how much longer than `seconds` (k,) the actions from that index on take at this pace.

        Above 1 is longer. It is estimated from 200 of them at most, evenly apart.
        """
        if self.percent == 100:
            return 1.0
        limits = self._robot.limits
        if isinstance(self._robot, OverridesSpeed):  # which slows its travel as well
            slower = min(self.percent / 100, 1.0)
            limits = limits.model_copy(update={"speed": slower * limits.speed, "climb": slower * limits.climb})
        planned = paced = 0.0
        for i in np.unique(np.linspace(index, len(actions) - 1, _SAMPLE).astype(int)).tolist():
            action, before = actions[i], actions[max(i - 1, 0)]
            if isinstance(action, Prompt):
                continue
            if isinstance(action, Draw):
                action = replace(action, motion=_scaled(action.motion, self.percent, limits))
            start = _end(before, action.motion.start)
            planned += float(seconds[i])
            paced += float(seconds_of([action], limits, start)[0])
        return paced / planned if planned > 0 else 1.0


def _scaled(motion: Motion, percent: int, limits: Limits) -> Motion:
    """Return the motion at that pace, within the limits' speed."""
    return replace(motion, speed=(motion.speed * (percent / 100)).clip(max=limits.speed)) if percent != 100 else motion


def _end(action: Action, place: Floats) -> Floats:
    """Return the place (3,) of the lifted tip after an action, metres; `place` where a prompt leaves it."""
    if isinstance(action, Prompt):
        return place if action.aside is None else np.array(action.aside)
    return action.motion.end
