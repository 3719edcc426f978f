"""Kinematics of arms from their makers' Denavit-Hartenberg parameters, to say what they truly reach.

Metres and radians. Nothing of Maulstick is used here: it is what `maulstick.robot.adapters.reaches` is compared with.

- UR: "DH parameters for calculations of kinematics and dynamics", universal-robots.com; joints turn by 360 degrees
  either way (user manuals, technical specifications). UR30 as in `config/ur30` of the maker's
  Universal_Robots_ROS2_Description.
- UFACTORY: "Kinematic and dynamic parameters", docs.ufactory.cc; ranges of joints as in the `JOINT_LIMITS` of the
  maker's xarm-python-sdk.
- Franka: "Robot limits" and "Denavit-Hartenberg parameters", frankarobotics.github.io/docs/robot_specifications.html.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from maulstick.storage.arrays import Floats

_TURN = 2 * np.pi
_HALF = np.pi / 2
_STEPS = 60  # of Newton's method per start
_DAMPING = 1e-5
_CLOSE = 1e-4  # metres, and radians: a solution; near a singular pose, the last digits take long


@dataclass(frozen=True)
class Chain:
    """Joints of an arm, one row (a, d, alpha, offset of theta) each, and their ranges (lowest, highest).

    craig: whether the rows are "modified" parameters, whose a and alpha come before the turn.
    flange: metres from the last frame to the flange, along its z.
    """

    rows: tuple[tuple[float, float, float, float], ...]
    ranges: tuple[tuple[float, float], ...]
    craig: bool = False
    flange: float = 0.0

    def poses(self, turns: Floats) -> tuple[Floats, Floats, Floats]:
        """Return axes (n, j, 3) and places (n, j, 3) of the joints, and poses (n, 4, 4) of the flange."""
        pose = np.tile(np.eye(4), (len(turns), 1, 1))
        axes, places = [], []
        for (a, d, alpha, offset), turn in zip(self.rows, turns.T, strict=True):
            link = _turned_x(alpha) @ _moved(a, 0.0)
            if self.craig:
                pose = pose @ link
            axes.append(pose[:, :3, 2])
            places.append(pose[:, :3, 3])
            pose = pose @ _turned_z(turn + offset) @ _moved(0.0, d)
            if not self.craig:
                pose = pose @ link
        return np.stack(axes, axis=1), np.stack(places, axis=1), pose @ _moved(0.0, self.flange)

    def reaches(self, places: Floats, pen: float, starts: int, rng: np.random.Generator) -> Floats:
        """Return (n,) whether a pen of that length can be held to each place (n, 3), pointing down, turned anyhow."""
        lowest, highest = np.array(self.ranges).T
        goals = np.add(places, [0.0, 0.0, pen])
        found = np.zeros(len(places), dtype=bool)
        for _ in range(starts):
            left = np.flatnonzero(~found)
            if not len(left):
                break
            turns = rng.uniform(lowest.clip(min=-np.pi), highest.clip(max=np.pi), (len(left), len(lowest)))
            for _ in range(_STEPS):
                turns = (turns + self._step(turns, goals[left])).clip(lowest, highest)
            pose = self.poses(turns)[2]
            missed = np.linalg.norm(pose[:, :3, 3] - goals[left], axis=1)
            tilted = np.linalg.norm(pose[:, :3, 2] + [0.0, 0.0, 1.0], axis=1)
            found[left] = (missed < _CLOSE) & (tilted < _CLOSE)
        return found

    def _step(self, turns: Floats, goals: Floats) -> Floats:
        axes, places, pose = self.poses(turns)
        tip, pointing = pose[:, None, :3, 3], pose[:, None, :3, 2]
        moves = np.cross(axes, tip - places)
        tilts = np.cross(axes, pointing)
        jacobian = np.concatenate([moves, tilts], axis=2).transpose(0, 2, 1)
        wanted = np.concatenate([goals - tip[:, 0], [0.0, 0.0, -1.0] - pointing[:, 0]], axis=1)
        square = jacobian @ jacobian.transpose(0, 2, 1) + _DAMPING * np.eye(6)
        step = (jacobian.transpose(0, 2, 1) @ np.linalg.solve(square, wanted[..., None]))[..., 0]
        return np.asarray(step.clip(-0.5, 0.5))


def _turned_z(turns: Floats) -> Floats:
    pose = np.tile(np.eye(4), (len(turns), 1, 1))
    pose[:, 0, 0] = pose[:, 1, 1] = np.cos(turns)
    pose[:, 1, 0] = np.sin(turns)
    pose[:, 0, 1] = -pose[:, 1, 0]
    return pose


def _turned_x(turn: float) -> Floats:
    pose = np.eye(4)
    pose[1:3, 1:3] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
    return pose


def _moved(x: float, z: float) -> Floats:
    pose = np.eye(4)
    pose[0, 3], pose[2, 3] = x, z
    return pose


def _ur(d1: float, a2: float, a3: float, d4: float, d5: float, d6: float) -> Chain:
    rows = ((0, d1, _HALF, 0), (-a2, 0, 0, 0), (-a3, 0, 0, 0), (0, d4, _HALF, 0), (0, d5, -_HALF, 0), (0, d6, 0, 0))
    return Chain(rows, ((-_TURN, _TURN),) * 6)


_UPPER = float(np.hypot(0.2845, 0.0535))  # metres: upper arm of xArm 5 and 6
_UPPER_TURN = -float(np.arctan(284.5 / 53.5))
_FORE = float(np.hypot(0.0775, 0.3425))
_FORE_TURN = -float(np.arctan(0.3425 / 0.0775))
_SHOULDER, _ELBOW, _WRIST = (-2.059488, 2.094395), (-3.92699, 0.191986), (-1.692969, np.pi)
_ANY = (-_TURN, _TURN)
_FRANKA = (
    (0, 0.333, 0, 0),
    (0, 0, -_HALF, 0),
    (0, 0.316, _HALF, 0),
    (0.0825, 0, _HALF, 0),
    (-0.0825, 0.384, -_HALF, 0),
    (0, 0, _HALF, 0),
    (0.088, 0, _HALF, 0),
)

CHAINS: Final[dict[str, Chain]] = {
    "UR3": _ur(0.1519, 0.24365, 0.21325, 0.11235, 0.08535, 0.0819),
    "UR3e": _ur(0.15185, 0.24355, 0.2132, 0.13105, 0.08535, 0.0921),
    "UR5": _ur(0.089159, 0.425, 0.39225, 0.10915, 0.09465, 0.0823),
    "UR5e": _ur(0.1625, 0.425, 0.3922, 0.1333, 0.0997, 0.0996),
    "UR10": _ur(0.1273, 0.612, 0.5723, 0.163941, 0.1157, 0.0922),
    "UR10e": _ur(0.1807, 0.6127, 0.57155, 0.17415, 0.11985, 0.11655),
    "UR16e": _ur(0.1807, 0.4784, 0.36, 0.17415, 0.11985, 0.11655),
    "UR20": _ur(0.2363, 0.862, 0.7287, 0.201, 0.1593, 0.1543),
    "UR30": _ur(0.2363, 0.637, 0.5037, 0.201, 0.1593, 0.1543),
    "xArm 5": Chain(
        (
            (0, 0.267, -_HALF, 0),
            (_UPPER, 0, 0, _UPPER_TURN),
            (_FORE, 0, 0, -_UPPER_TURN - _FORE_TURN),
            (0.076, 0, -_HALF, _FORE_TURN),
            (0, 0.097, 0, 0),
        ),
        (_ANY, _SHOULDER, _ELBOW, _WRIST, _ANY),
    ),
    "xArm 6": Chain(
        (
            (0, 0.267, -_HALF, 0),
            (_UPPER, 0, 0, _UPPER_TURN),
            (0.0775, 0, -_HALF, -_UPPER_TURN),
            (0, 0.3425, _HALF, 0),
            (0.076, 0, -_HALF, 0),
            (0, 0.097, 0, 0),
        ),
        (_ANY, _SHOULDER, _ELBOW, _ANY, _WRIST, _ANY),
    ),
    "xArm 7": Chain(
        (
            (0, 0.267, -_HALF, 0),
            (0, 0, _HALF, 0),
            (0.0525, 0.293, _HALF, 0),
            (0.0775, 0, _HALF, 0),
            (0, 0.3425, _HALF, 0),
            (0.076, 0, -_HALF, 0),
            (0, 0.097, 0, 0),
        ),
        (_ANY, _SHOULDER, _ANY, (-0.191986, 3.92699), _ANY, _WRIST, _ANY),
    ),
    "Lite 6": Chain(
        (
            (0, 0.2433, -_HALF, 0),
            (0.2, 0, np.pi, -_HALF),
            (0.087, 0, _HALF, _HALF),
            (0, 0.2276, _HALF, 0),
            (0, 0, -_HALF, 0),
            (0, 0.0615, 0, 0),
        ),
        (_ANY, (-2.617994, 2.617994), (-0.0610865, 5.2359878), _ANY, (-2.1642083, 2.1642083), _ANY),
    ),
    "UFACTORY 850": Chain(
        (
            (0, 0.364, _HALF, 0),
            (0.39, 0, np.pi, _HALF),
            (0.15, 0, -_HALF, _HALF),
            (0, 0.426, -_HALF, 0),
            (0, 0, _HALF, 0),
            (0, 0.09, 0, 0),
        ),
        (_ANY, (-2.3038346, 2.3038346), (-4.2236968, 0.0610865), _ANY, (-2.1642083, 2.1642083), _ANY),
    ),
    "FER": Chain(
        _FRANKA,
        (
            (-2.8973, 2.8973),
            (-1.7628, 1.7628),
            (-2.8973, 2.8973),
            (-3.0718, -0.0698),
            (-2.8973, 2.8973),
            (-0.0175, 3.7525),
            (-2.8973, 2.8973),
        ),
        craig=True,
        flange=0.107,
    ),
    "FR3": Chain(
        _FRANKA,
        (
            (-2.7437, 2.7437),
            (-1.7837, 1.7837),
            (-2.9007, 2.9007),
            (-3.0421, -0.1518),
            (-2.8065, 2.8065),
            (0.5445, 4.5169),
            (-3.0159, 3.0159),
        ),
        craig=True,
        flange=0.107,
    ),
}
