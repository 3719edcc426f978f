"""The bare mark of docs/equations.md at points of the plane, done plainly; the truth is its mean over each pixel."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def darkness_at(places: Array, points: Array, thickness: Array, falloff: float, plateau: float) -> Array:
    """Return a stroke's darkness at places (M, 2); points: (n, 2), thickness: (n,)."""
    if len(points) == 1:
        points, thickness = points.repeat(2, axis=0), thickness.repeat(2)
    ratio = np.full(len(places), np.inf)
    for u, v, at_u, at_v in zip(points, points[1:], thickness, thickness[1:], strict=False):
        reach = max(at_u, at_v)  # of the segment, beyond which it leaves nothing
        near = ((places > np.minimum(u, v) - reach) & (places < np.maximum(u, v) + reach)).all(axis=1).nonzero()[0]
        along, since = v - u, places[near] - u
        T = (since @ along / max(float(along @ along), 1e-30)).clip(0, 1)
        distance = np.linalg.norm(since - T[:, None] * along, axis=1)
        ratio[near] = np.minimum(ratio[near], distance / (at_u * (1 - T) + at_v * T))
    return np.asarray(((1 - ratio) / (1 - plateau)).clip(0, 1) ** falloff)


def mean_darkness(points: Array, thickness: Array, falloff: float, plateau: float, size: int, finer: int = 16) -> Array:
    """Return the mean over each pixel of a square image (size, size), from `finer` times as many places each way."""
    at = (np.arange(size * finer) + 0.5) / finer
    x, y = np.meshgrid(at, at)
    dark = darkness_at(np.stack([x.ravel(), y.ravel()], axis=1), points, thickness, falloff, plateau)
    return np.asarray(dark.reshape(size, finer, size, finer).mean(axis=(1, 3)))
