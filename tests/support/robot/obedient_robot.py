"""A machine of a few lines that keeps every promise, in memory, for tests to break."""

import time

import numpy as np

from maulstick.errors import InputError
from maulstick.robot.easel import Easel
from maulstick.robot.force import FeelsForce
from maulstick.robot.limits import Limits
from maulstick.robot.robot import Robot, StoppedError
from maulstick.robot.timing import Profile
from maulstick.storage.arrays import Floats

LIMITS = Limits(
    lower=(0.2, -0.2, 0.0),
    upper=(0.5, 0.2, 0.3),
    speed=0.5,
    climb=0.5,
    acceleration=5.0,
    deviation=1e-4,
    varies_pressure=True,
)
EASEL = Easel(corner=(0.3, 0.1, 0.02), right=(1, 0, 0), down=(0, -1, 0))


class Obedient(Robot):
    """Robot that takes the time of its strokes, and none for all else."""

    def __init__(self) -> None:
        super().__init__(LIMITS)
        self.at = np.array([0.3, 0.0, 0.1])
        self.lowest = np.inf

    def easel(self, width: float, height: float) -> Easel:
        raise InputError("it stands nowhere")

    def _connect(self) -> None:
        pass

    def _open(self) -> Floats:
        return self.at

    def _close(self) -> None:
        pass

    def _move(self, place: Floats) -> Floats:
        self.at = place
        self.lowest = min(self.lowest, place[2])
        return place

    def _stroke(self, path: Floats, speed: Floats) -> Floats:
        profile, began = Profile.of(path, speed, self.limits), time.monotonic()
        while (passed := time.monotonic() - began) < profile.seconds:
            self.at = profile.at(np.array([passed]))[0]
            if self._stopping.wait(0.01):
                raise StoppedError
        self.at = path[-1]
        return path

    def _lift(self, place: Floats) -> Floats:
        return self._move(place)

    def _halt(self) -> None:
        pass

    def _recover(self) -> None:
        self.at = self.at + np.array([0, 0, 0.02])


class Feeling(Obedient, FeelsForce):
    """Robot with a force sensor: the paper resists by 20 N/mm, and the force is never 0."""

    def __init__(self, paper: float) -> None:
        super().__init__()
        self._paper = paper

    def force(self) -> float:
        return -3.0 + 2e4 * max(self._paper - float(self.at[2]), 0.0)
