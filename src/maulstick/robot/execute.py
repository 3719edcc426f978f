"""Execution of a routine on a machine; the journal has each stroke before and after it is painted."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import final

import numpy as np

from maulstick.robot.duration import seconds_of
from maulstick.robot.journal import Journal
from maulstick.robot.pace import Pace
from maulstick.robot.robot import Robot
from maulstick.robot.routine import NOTHING, Action, Draw, Motion, PaintLoad, Prompt, TrayVisit
from maulstick.storage.arrays import Floats

_GLANCE = 0.05  # seconds between two looks at a pause: shorter than a person notices


@dataclass(frozen=True)
class PaintProgress:
    """Progress of painting, before each action and once at the end.

    action: the action that comes now, or None at the end.  drawn, metres: metres of stroke so far, and in all.
    left: seconds that the machine still needs, without the time for prompts.  next_paint: the paint after this one, if
    any.  took: seconds that the machine has needed for strokes so far, without pauses.
    """

    action: Action | None
    drawn: float
    metres: float
    left: float
    next_paint: int | None
    took: float = 0.0


@final
class Pause:
    """Switch by which another thread, a signal handler or the machine's own button holds it between two actions.

    held: whether the machine is to wait.  tell: called after each press of the machine's button, with `held`.
    """

    def __init__(self, tell: Callable[[bool], None] = lambda held: None) -> None:
        self.held = False
        self._tell = tell

    def toggle(self) -> None:
        """Hold the machine, or let it go on."""
        self.held = not self.held

    def wait(self, robot: Robot) -> None:
        """Wait until painting may go on; raises StoppedError once the machine is stopped."""
        self._look_at_button(robot)
        while self.held:
            time.sleep(_GLANCE)
            self._look_at_button(robot)

    def _look_at_button(self, robot: Robot) -> None:
        if robot.pause_pressed():
            self.toggle()
            self._tell(self.held)


def execute(
    actions: Sequence[Action],
    robot: Robot,
    journal: Journal,
    ask: Callable[[Prompt], None],
    watch: Callable[[PaintProgress], None] = lambda progress: None,
    pause: Pause | None = None,
    load: PaintLoad = NOTHING,
    enough: Callable[[int], bool] = lambda painted: False,
    pace: Pace | None = None,
) -> PaintLoad:
    """Carry out the actions of a `routine` for this machine; returns the paint that the machine holds at the end.

    ask: shows a prompt to the operator, and returns when it is done.  watch: called before each action, and at the end.
    pause: holds the machine before an action.  load: the paint that the machine holds at the beginning.
    enough: called after each stroke with the number painted since the call; where it returns True, painting ends there.
    pace: speed of drawing, which may be changed on the way.
    A stroke is in the journal as begun before the tip is lowered for it, and as painted once it is lifted again.
    Raises whatever stopped it: MachineError, OutputError of the journal, KeyboardInterrupt; the pen is then lifted
    once the machine's context is left.
    """
    seconds = seconds_of(actions, robot.limits, robot.place)
    left = np.concatenate([np.cumsum(seconds[::-1])[::-1], [0.0]])
    following = _next_paints(actions)
    metres, drawn = sum(a.motion.length for a in actions if isinstance(a, Draw)), 0.0
    index, painted = 0, 0
    pace = pace or Pace(robot)
    percent, longer, took = 100, 1.0, 0.0
    _clear_all(actions, robot)
    for index, action in enumerate(actions):
        if pace.percent != percent:
            percent, longer = pace.percent, pace.share_of_time(actions, seconds, index)
        watch(PaintProgress(action, drawn, metres, longer * float(left[index]), following[index], took))
        if pause is not None:
            pause.wait(robot)
        match action:
            case Prompt():
                if action.aside is not None:
                    _step_aside(robot, np.array(action.aside))
                ask(action)
                load = PaintLoad(action.paint) if action.renews else load
            case TrayVisit(motion=motion):
                _perform(motion, robot)
                load = PaintLoad(action.paint) if action.what == "dip" else PaintLoad()
            case Draw(motion=motion):
                begun = time.monotonic()
                _perform(pace.paced(motion), robot, partial(journal.begin, action.stroke))
                took += time.monotonic() - begun
                journal.end(action.stroke)
                drawn, painted = drawn + motion.length, painted + 1
                load = load.after(action.paint, motion.length, float(seconds[index]))
                if enough(painted):
                    break
    watch(PaintProgress(None, drawn, metres, longer * float(left[index + 1]) if actions else 0.0, None, took))
    return load


def _clear_all(actions: Sequence[Action], robot: Robot) -> None:
    """Lift the tip straight up to the highest height of travel, since it may stand in a well."""
    heights = [max(a.motion.above, a.motion.after) for a in actions if not isinstance(a, Prompt)]
    if heights and max(heights) > robot.place[2]:
        robot.lift(max(heights))


def _perform(motion: Motion, robot: Robot, begin: Callable[[], None] = lambda: None) -> None:
    """Move above the start, call `begin`, lower the tip, follow the path and lift again."""
    robot.move(motion.start)
    begin()
    robot.stroke(motion.path, motion.speed)
    robot.lift(motion.after)


def _step_aside(robot: Robot, place: Floats) -> None:
    """Lift the tip at least to the height of a place (3,), metres, and move it above that."""
    height = max(float(robot.place[2]), float(place[2]))
    if height > robot.place[2]:
        robot.lift(height)
    if (robot.place[:2] != place[:2]).any():
        robot.move(np.array([*place[:2], height]))


def _next_paints(actions: Sequence[Action]) -> list[int | None]:
    """Return for each action the paint that follows the one in use, or None where that is the last."""
    found: list[int | None] = []
    for action, after in zip(reversed(actions), [None, *reversed(actions)], strict=False):
        following = found[-1] if found else None
        found.append(following if after is None or after.paint == action.paint else after.paint)
    return found[::-1]
