"""How long strokes take by `seconds_of`, and by clocks that share no code with it; for robot.py."""

import sys
from collections.abc import Sequence
from pathlib import Path

from maulstick.painting.painting import Painting
from maulstick.robot.adapters.franka import Franka
from maulstick.robot.adapters.grbl import Grbl
from maulstick.robot.duration import seconds_of
from maulstick.robot.easel import Easel, Pen
from maulstick.robot.robot import Robot
from maulstick.robot.routine import Action, Draw, routine

sys.path.append(str(Path(__file__).resolve().parents[1]))  # the tests are not installed
from tests.support.robot.fake_grbl import FakeGrbl
from tests.support.robot.franka_simulator import SECONDS_PER_STEP, FrankaSimulator

SPEED = 0.05  # metres per second
SERVO = Pen(up=500, down=700, seconds=0.2)
BEFORE_AN_ARM = Easel(corner=(0.42, 0.08, 0.35), right=(1, 0, 0), down=(0, -1, 0), deepest=2e-3)


def on_grbl(painting: Painting, strokes: int, pen: Pen | None) -> tuple[float, float]:
    """Seconds for the first so many strokes, estimated, and simulated by a Grbl that steps its motion at 1 kHz."""
    with FakeGrbl(pace=1000.0) as device, Grbl(device.port, pen) as robot:
        place = robot.easel(painting.sheet.width, painting.sheet.height).model_copy(update={"deepest": 2e-3})
        actions, estimated = _actions(painting, strokes, place, robot)
        opened = device.seconds
        _draw(actions, robot)
        return estimated, device.seconds - opened


def on_franka(painting: Painting, strokes: int) -> tuple[float, float]:
    """Seconds for the first so many strokes, estimated, and by the steps of franky-sim."""
    with FrankaSimulator() as simulator, Franka(simulator.address) as robot:
        actions, estimated = _actions(painting, strokes, BEFORE_AN_ARM, robot)
        simulator.path()
        _draw(actions, robot)
        return estimated, SECONDS_PER_STEP * len(simulator.path())


def _actions(painting: Painting, strokes: int, easel: Easel, robot: Robot) -> tuple[list[Action], float]:
    few = painting.model_copy(update={"strokes": painting.strokes[:strokes]})
    actions = routine(few, easel, robot.limits, speed=SPEED)
    return actions, float(seconds_of(actions, robot.limits, robot.place).sum())


def _draw(actions: Sequence[Action], robot: Robot) -> None:
    for action in actions:
        if isinstance(action, Draw):
            robot.move(action.motion.start)
            robot.stroke(action.motion.path, action.motion.speed)
            robot.lift(action.motion.after)
