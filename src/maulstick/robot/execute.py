"""Painting: a routine on a machine, each stroke written down before and after it."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import final

import numpy as np

from maulstick.robot.journal import Journal
from maulstick.robot.robot import Robot
from maulstick.robot.routine import NOTHING, Action, Draw, Motion, PaintLoad, Prompt, TrayVisit, seconds_of

_GLANCE = 0.05  # seconds


@dataclass(frozen=True)
class PaintProgress:
    """Before an action, and once at the end: where painting is.

    action: what comes now, or None at the end.  drawn, metres: of stroke, so far and in all.
    left: seconds of the machine, without what people have to do.  next_paint: the paint after this one, if any.
    """

    action: Action | None
    drawn: float
    metres: float
    left: float
    next_paint: int | None


@final
class Pause:
    """Lets another thread, or a signal handler, hold a machine between two strokes. held: whether it is to wait."""

    def __init__(self) -> None:
        self.held = False

    def toggle(self) -> None:
        """Hold, or go on."""
        self.held = not self.held

    def wait(self) -> None:
        """Return once painting may go on."""
        while self.held:
            time.sleep(_GLANCE)


def execute(
    actions: Sequence[Action],
    robot: Robot,
    journal: Journal,
    ask: Callable[[Prompt], None],
    watch: Callable[[PaintProgress], None] = lambda progress: None,
    pause: Pause | None = None,
    load: PaintLoad = NOTHING,
    enough: Callable[[int], bool] = lambda painted: False,
) -> PaintLoad:
    """Do what a `routine` for this machine says; returns what the machine holds in the end.

    enough: asked after each stroke, with the number painted since the call; once it says so, it returns, and the others
    are counted as still to come.
    ask: shows a person what has to be done, and returns when it is.  watch: is told before each action, and at the end.
    A stroke is in the journal as begun before the tip is lowered for it, and as painted once it is lifted again.
    Raises whatever stopped it: MachineError, OutputError of the journal, KeyboardInterrupt; the pen is then lifted
    once the machine's context is left.
    """
    seconds = seconds_of(actions, robot.limits, robot.place)
    left = np.concatenate([np.cumsum(seconds[::-1])[::-1], [0.0]])
    metres, drawn = sum(a.motion.length for a in actions if isinstance(a, Draw)), 0.0
    index, painted = 0, 0
    _clear_all(actions, robot)
    for index, action in enumerate(actions):
        watch(PaintProgress(action, drawn, metres, float(left[index]), _next_paint(actions, index)))
        if pause is not None:
            pause.wait()
        match action:
            case Prompt():
                ask(action)
                load = PaintLoad(action.paint)
            case TrayVisit(motion=motion):
                _perform(motion, robot)
                load = PaintLoad(action.paint) if action.what == "dip" else PaintLoad()
            case Draw(motion=motion):
                _perform(motion, robot, partial(journal.begin, action.stroke))
                journal.end(action.stroke)
                drawn, painted = drawn + motion.length, painted + 1
                load = PaintLoad(action.paint, load.painted + motion.length)
                if enough(painted):
                    break
    watch(PaintProgress(None, drawn, metres, float(left[index + 1]) if actions else 0.0, None))
    return load


def _clear_all(actions: Sequence[Action], robot: Robot) -> None:
    """Lift the tip straight up to the height of the highest way, since nobody knows what it stands in."""
    heights = [max(a.motion.above, a.motion.after) for a in actions if not isinstance(a, Prompt)]
    if heights and max(heights) > robot.place[2]:
        robot.lift(max(heights))


def _perform(motion: Motion, robot: Robot, begin: Callable[[], None] = lambda: None) -> None:
    """Go above its start; then `begin`; then down, along, and up again."""
    robot.move(motion.start)
    begin()
    robot.stroke(motion.path, motion.speed)
    robot.lift(motion.after)


def _next_paint(actions: Sequence[Action], index: int) -> int | None:
    now = actions[index].paint
    return next((action.paint for action in actions[index:] if action.paint != now), None)
