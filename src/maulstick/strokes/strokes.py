"""Strokes as arrays: resampled by arc length, standardised, and placed again (paper: Motion Capture ... Processing)."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np

from maulstick.errors import InputError
from maulstick.storage.arrays import Bools, Floats, Ints, read_arrays, write_arrays
from maulstick.strokes.ink import Ink

POINTS = 32
"""Points of a standardised trajectory, the paper's n."""

KIND = "strokes"
"""Kind of a file of arrays that holds strokes."""

_CLOSED = 0.02  # chord / length: below it a stroke counts as closed (see `standardise`)


@dataclass(frozen=True)
class Strokes:
    """N standardised strokes of one hand.

    trajectories: (N, n, 3) of x, y in metres and pressure in [0, 1]; pressure is NaN where it was not recorded.
    times: (N, n) seconds since each stroke began; NaN where they were not recorded.
    poses: (N, 3) (dx, dy, dθ), which put each stroke back where it was drawn.
    Raises InputError where an array has another shape or values that are not allowed.
    """

    trajectories: Floats
    times: Floats
    poses: Floats

    def __post_init__(self) -> None:
        shape = self.trajectories.shape
        if len(shape) != 3 or shape[1] < 2 or shape[2] != 3:
            raise InputError(f"trajectories have shape {shape}; it must be (N, n, 3) with n of at least 2")
        if self.times.shape != shape[:2] or self.poses.shape != (shape[0], 3):
            raise InputError(
                f"times have shape {self.times.shape} and poses {self.poses.shape} for {shape} trajectories"
            )
        if not (np.isfinite(self.trajectories[..., :2]).all() and np.isfinite(self.poses).all()):
            raise InputError("a point or a pose of a stroke is not a finite number")
        pressure = self.trajectories[..., 2]
        if ((pressure < 0) | (pressure > 1)).any():
            raise InputError.of_range("pressure", f"{np.nanmin(pressure):g} to {np.nanmax(pressure):g}", "in [0, 1]")
        for name, values in (("times", self.times), ("pressure", pressure)):
            known = np.isfinite(values)
            if np.isinf(values).any() or (known.any(axis=1) != known.all(axis=1)).any():
                raise InputError(f"the {name} of a stroke must be known at all of its points, or NaN at all of them")
        if self.trajectories[:, 0, :2].any():
            raise InputError("a stroke does not begin at the origin; standardise it, and put its place into its pose")

    @classmethod
    def of(cls, ink: Ink, n: int = POINTS) -> Self:
        """Return the strokes of the ink, each resampled to n points by arc length and standardised."""
        raw = [np.concatenate([stroke[:, 1:4], stroke[:, :1] - stroke[0, 0]], axis=1) for stroke in ink.strokes()]
        paths = np.array([resample(stroke, n) for stroke in raw]).reshape(-1, n, 4)
        standard, poses = standardise(paths[..., :2])
        return cls(np.concatenate([standard, paths[..., 2:3]], axis=-1), paths[..., 3], poses)

    def __len__(self) -> int:
        return len(self.poses)

    def __getitem__(self, rows: Ints | Bools | slice) -> Self:
        """Return the strokes of these rows, in their order."""
        return type(self)(self.trajectories[rows], self.times[rows], self.poses[rows])

    @property
    def lengths(self) -> Floats:
        """Arc length of each stroke, (N,), metres."""
        return path_lengths(self.trajectories[..., :2])

    def placed(self) -> Floats:
        """Return the trajectories (N, n, 3) where they were drawn, metres and pressure."""
        return np.concatenate([place(self.trajectories[..., :2], self.poses), self.trajectories[..., 2:]], axis=-1)


def write_strokes(strokes: Strokes, path: str | Path) -> None:
    """Write the strokes to a file. Raises OutputError where that fails; what was at `path` is then still there."""
    arrays = {"trajectories": strokes.trajectories, "times": strokes.times, "poses": strokes.poses}
    write_arrays(path, KIND, arrays)


def read_strokes(path: str | Path) -> Strokes:
    """Return the strokes in the file at `path`. Raises InputError where there are none."""
    arrays = read_arrays(path, KIND, ("trajectories", "times", "poses"))
    try:
        return Strokes(*(array.astype(np.float64) for array in arrays.values()))
    except (InputError, ValueError, TypeError) as error:
        raise InputError(f"{path} is not a file of {KIND}: {error}") from error


def path_lengths(paths: Floats) -> Floats:
    """Arc lengths (...) of polylines (..., n, 2), in the unit of their points."""
    steps = np.diff(paths, axis=-2)
    lengths: Floats = np.hypot(steps[..., 0], steps[..., 1]).sum(axis=-1)
    return lengths


def resample(path: Floats, n: int = POINTS) -> Floats:
    """Return n points (n, k) at equal distances along the polyline `path`, (m, k) with x and y first.

    Further columns are interpolated likewise. The ends stay in place. A path without length gives n times its first
    point. Raises InputError where `path` has another shape.
    """
    path = np.asarray(path, dtype=np.float64)
    if path.ndim != 2 or path.shape[0] < 1 or path.shape[1] < 2:
        raise InputError(f"a path has shape {path.shape}; it must be (m, 2 or more) with m of at least 1")
    steps = np.hypot(*np.diff(path[:, :2], axis=0).T)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    keep = np.concatenate([[True], steps > 0])
    places = np.linspace(0, along[-1], n)
    return np.stack([np.interp(places, along[keep], column[keep]) for column in path.T], axis=1)


def resampled(paths: Iterable[Floats]) -> Floats:
    """Return paths (N, 32, 3), each (m, 3): those of 32 points as they are, others resampled."""
    even = [path if len(path) == POINTS else resample(path) for path in paths]
    return np.array(even, dtype=np.float64).reshape(-1, POINTS, 3)


def standardise(paths: Floats) -> tuple[Floats, Floats]:
    """Return paths (N, n, 2) that start at the origin and end on the positive x-axis, and poses (N, 3) (dx, dy, dθ).

    The chord of a closed stroke (shorter than a fiftieth of its length) gives no reliable direction: such a stroke is
    turned until the mean of its points lies on the positive x-axis instead.
    """
    paths = np.asarray(paths, dtype=np.float64)
    start = paths[:, 0]
    chord = paths[:, -1] - start
    closed = np.hypot(chord[:, 0], chord[:, 1]) < _CLOSED * path_lengths(paths)
    towards = np.where(closed[:, None], paths.mean(axis=1) - start, chord)
    angle = np.arctan2(towards[:, 1], towards[:, 0])
    poses = np.concatenate([start, angle[:, None]], axis=1)
    return _rotate(paths - start[:, None], -angle), poses


def place(paths: Floats, poses: Floats) -> Floats:
    """Return standardised paths (N, n, 2) placed on the canvas: R(dθ)(x, y) + (dx, dy), with poses (N, 3)."""
    return _rotate(np.asarray(paths), poses[:, 2]) + poses[:, None, :2]


def _rotate(paths: Floats, angles: Floats) -> Floats:
    cos, sin = np.cos(angles)[:, None], np.sin(angles)[:, None]
    x, y = paths[..., 0], paths[..., 1]
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)
