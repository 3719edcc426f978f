"""Time of painting as it is estimated, beside the real Grbl 1.1h's and the fake one's; for robot.py.

name: `firmware_` and one of the dialogues with the real one in tests/support/robot/dialogues; else waves with a servo's
    pen or a Z axis, of 4 mm or 60 mm, and the speed in mm/s.
estimated_s: by `seconds_of`.  simulated_s: by the fake one.  firmware_s: by the real one.
error: of the estimate, beside the realest of the others.
"""

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from maulstick.robot.adapters.grbl import Grbl
from maulstick.robot.duration import seconds_of
from maulstick.robot.easel import Pen
from maulstick.robot.robot import Robot
from maulstick.robot.routine import Draw, Motion
from maulstick.storage.arrays import Floats

sys.path.append(str(Path(__file__).resolve().parents[1]))  # the tests are not installed
from tests.support.robot.dialogue import DIALOGUES, HEIGHT, START, dialogue
from tests.support.robot.fake_grbl import SETTINGS, FakeGrbl

SERVO = Pen(up=500, down=700, seconds=0.2)
FAST = {**SETTINGS, 110: 15_000, 111: 15_000, 112: 3_000, 120: 1_000, 121: 1_000, 122: 500}
SPEEDS = (0.005, 0.04, 0.2)  # metres per second
LENGTHS = {"small": 0.004, "large": 0.06}  # metres, from end to end
STROKES = 40
Row = dict[str, object]


def rows(quick: bool) -> Iterator[Row]:
    """The four dialogues, and where it need not be quick, strokes of two sizes at three speeds, with both pens."""
    for name in DIALOGUES:
        said = dialogue(name)
        motions = said.motions()
        with FakeGrbl(settings=said.settings, pace=1000.0) as device, Grbl(device.port, said.pen) as robot:
            yield _row(f"firmware_{name}", _estimated(motions, robot), _drawn(motions, device, robot), said.seconds)
    for pen_name, pen in () if quick else (("servo", SERVO), ("z", None)):
        for size, length in LENGTHS.items():
            for speed in SPEEDS:
                motions = _curves(length, speed)
                with FakeGrbl(settings=FAST, pace=1000.0) as device, Grbl(device.port, pen) as robot:
                    name = f"{pen_name}_{size}_{1e3 * speed:.0f}"
                    yield _row(name, _estimated(motions, robot), _drawn(motions, device, robot), None)


def _row(name: str, estimated: float, simulated: float, firmware: float | None) -> Row:
    row: Row = {"name": name, "strokes": STROKES, "estimated_s": estimated, "simulated_s": simulated}
    if firmware is not None:
        row["firmware_s"] = firmware
    return {**row, "error": estimated / (firmware or simulated) - 1}


def _estimated(motions: Sequence[Motion], robot: Robot) -> float:
    actions = [Draw(number, 0, motion) for number, motion in enumerate(motions)]
    return float(seconds_of(actions, robot.limits, START).sum())


def _drawn(motions: Sequence[Motion], device: FakeGrbl, robot: Robot) -> float:
    robot.lift(HEIGHT)
    before = device.seconds
    for motion in motions:
        robot.move(motion.start)
        robot.stroke(motion.path, motion.speed)
        robot.lift(motion.after)
    return device.seconds - before


def _curves(length: float, speed: float) -> list[Motion]:
    """Waves of 32 points, each somewhere else on a sheet, drawn with the tip a millimetre deep."""
    rng = np.random.default_rng(0)
    along = np.linspace(0, 1, 32)
    motions = []
    for turn, phase, x, y in rng.uniform((0, 0, 0.08, 0.08), (2 * np.pi, 2 * np.pi, 0.22, 0.14), (STROKES, 4)):
        wave = np.stack([along, 0.15 * np.sin(9 * along + phase)]) * length
        cosine, sine = np.cos(turn), np.sin(turn)
        places: Floats = (np.array([[cosine, -sine], [sine, cosine]]) @ wave).T + np.array([x, y])
        path: Floats = np.column_stack([places, 0 * along])
        motions.append(Motion(path, np.full(len(path), speed), HEIGHT, HEIGHT))
    return motions
