"""Teach Maulstick a new machine, check that it keeps every promise of `ms.Robot`, and paint with it.

python examples/05_new_robot.py photo.jpg --out robot
"""

from argparse import ArgumentParser
from importlib.resources import files
from pathlib import Path

import numpy as np

import maulstick as ms
from maulstick.robot import check, easel, limits, robot


class Scribe(ms.Robot):
    """Machine that prints its moves and takes the time of its strokes; a real one would send them."""

    def __init__(self) -> None:
        box = {"lower": (0, 0, 0), "upper": (0.3, 0.3, 0.02)}  # metres
        super().__init__(limits.Limits(**box, speed=0.4, climb=0.1, acceleration=2, varies_pressure=False))

    def easel(self, width, height):
        """Return the usual place of a sheet: its lower left corner is at the origin."""
        return easel.Easel(corner=(0, height, 0), right=(1, 0, 0), down=(0, -1, 0))

    def _open(self):
        return np.array([0, 0, 0.01])  # where the tip is, with the pen lifted

    def _move(self, place):
        print("move to {:.1f} {:.1f} {:.1f} mm".format(*(1e3 * place)))
        return place

    def _stroke(self, path, speed):
        lengths = np.linalg.norm(np.diff(path, axis=0), axis=1)
        if self._stopping.wait(float((lengths / speed[1:]).sum())):
            raise robot.StoppedError
        print(f"draw {1e3 * lengths.sum():.1f} mm through {len(path)} points")
        return path

    _lift = _move
    _connect = _close = _halt = _recover = lambda self: None  # a real machine has something to do in each


if __name__ == "__main__":
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("picture", nargs="?", default=str(files("skimage.data") / "astronaut.png"))
    parser.add_argument("--out", type=Path, default=Path("example-robot"), help="folder for the results")
    parser.add_argument("--strokes", type=int, default=50)
    parser.add_argument("--steps", type=int, default=100, help="steps of the optimiser; more are finer")
    given = parser.parse_args()
    for promise in check.check_robot(Scribe()):
        print("kept:  " if promise.passed else "BROKEN:", promise.name, "-", promise.finding)
    look = ms.PlanOptions(size="100x80mm", brush="fineliner", ink="black", pressure=0.5)
    painting = ms.plan(given.picture, options=look, strokes=given.strokes, steps=given.steps)
    given.out.mkdir(parents=True, exist_ok=True)
    painting.save(given.out / "painting.json")
    ms.paint(given.out / "painting.json", robot=Scribe(), restart=True, ask=print)
