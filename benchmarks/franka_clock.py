"""The estimate of a routine's time against franky-sim's clock; for benchmarks/robot.py."""

import json
import sys
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1]))  # the tests are not installed
from maulstick.robot.adapters.franka import Franka
from maulstick.robot.duration import seconds_of
from maulstick.robot.routine import Draw, Motion
from maulstick.storage.arrays import Floats
from tests.support.robot.franka_simulator import SECONDS_PER_STEP, FrankaSimulator, moving_seconds

PAPER = 0.35  # metres: height at which the simulated arm draws, in the air
HOVER = PAPER + 5e-3
MIDDLE = 0.5, 0.0  # metres
Drawn = list[tuple[Floats, Floats]]


def both_clocks(strokes: Drawn) -> dict[str, float]:
    """Seconds for strokes, each a path (n, 3) about (0, 0, 0) and its speed (n,), estimated, and simulated.

    The simulated seconds are all those from the first command to the last, moving or not.
    """
    draws = [
        Draw(index, 0, Motion(path + np.array([*MIDDLE, PAPER]), speed, HOVER, HOVER))
        for index, (path, speed) in enumerate(strokes)
    ]
    with FrankaSimulator() as simulator, Franka(simulator.address) as robot:
        estimated = float(seconds_of(draws, robot.limits, robot.place).sum())
        simulator.path()
        for draw in draws:
            robot.move(draw.motion.start)
            robot.stroke(draw.motion.path, draw.motion.speed)
            robot.lift(draw.motion.after)
        path = simulator.path()
    return {
        "estimated_s": estimated,
        "simulated_s": SECONDS_PER_STEP * len(path),
        "moving_s": moving_seconds(path),
    }


def random_strokes(count: int, rng: np.random.Generator) -> Drawn:
    """Curves of 32 points and 10 to 60 mm on an A5, at 10 to 60 mm/s, down to 2 mm deep."""
    strokes = []
    for _ in range(count):
        turning = np.cumsum(rng.normal(0, 0.25, 31)) + rng.uniform(0, 2 * np.pi)
        steps = np.stack([np.cos(turning), np.sin(turning)], axis=1) * rng.uniform(0.01, 0.06) / 31
        path = np.zeros((32, 3))
        path[1:, :2] = np.cumsum(steps, axis=0)
        path[:, :2] += rng.uniform((-0.06, -0.09), (0.06, 0.09))
        path[:, 2] = -2e-3 * np.sin(np.linspace(0, np.pi, 32)) * rng.uniform()
        strokes.append((path, np.full(32, rng.uniform(0.01, 0.06))))
    return strokes


if __name__ == "__main__":
    strokes = random_strokes(20, np.random.default_rng(0))
    print(json.dumps({"name": "franka", "strokes": len(strokes), **both_clocks(strokes)}))
