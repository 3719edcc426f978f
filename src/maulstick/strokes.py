"""Strokes as arrays: resampled by arc length, standardised, and placed again (paper: Motion Capture ... Processing)."""

import numpy as np
from numpy.typing import NDArray

from maulstick.errors import InputError

POINTS = 32
"""Points of a standardised trajectory, the paper's n."""

Floats = NDArray[np.float64]


def resample(path: Floats, n: int = POINTS) -> Floats:
    """N points at equal distances along the polyline `path`, (m, k) with x and y first; further columns follow along.

    The ends stay where they are. A path without length gives n times its first point.
    """
    path = np.asarray(path, dtype=np.float64)
    if path.ndim != 2 or path.shape[0] < 1 or path.shape[1] < 2:
        raise InputError(f"a path has shape {path.shape}; it must be (m, 2 or more) with m of at least 1")
    steps = np.hypot(*np.diff(path[:, :2], axis=0).T)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    keep = np.concatenate([[True], steps > 0])
    places = np.linspace(0, along[-1], n)
    return np.stack([np.interp(places, along[keep], column[keep]) for column in path.T], axis=1)


def standardise(paths: Floats) -> tuple[Floats, Floats]:
    """Paths (N, n, 2) starting at the origin and ending on the positive x-axis, and their poses (N, 3) (dx, dy, dθ).

    A stroke that ends where it starts has no direction of its own: its angle is 0.
    """
    paths = np.asarray(paths, dtype=np.float64)
    start = paths[:, 0]
    end = paths[:, -1] - start
    angle = np.arctan2(end[:, 1], end[:, 0])
    poses = np.concatenate([start, angle[:, None]], axis=1)
    return _rotate(paths - start[:, None], -angle), poses


def place(paths: Floats, poses: Floats) -> Floats:
    """Standardised paths (N, n, 2) put on the canvas: R(dθ)(x, y) + (dx, dy), with poses (N, 3)."""
    return _rotate(np.asarray(paths), poses[:, 2]) + poses[:, None, :2]


def _rotate(paths: Floats, angles: Floats) -> Floats:
    cos, sin = np.cos(angles)[:, None], np.sin(angles)[:, None]
    x, y = paths[..., 0], paths[..., 1]
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)
