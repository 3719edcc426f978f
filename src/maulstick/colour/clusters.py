"""Weighted k-means, step by step as scikit-learn has it, which takes longer to load than to cluster a palette."""

import numpy as np

from maulstick.storage.arrays import Floats, Ints

_MOST_ITERATIONS = 300
_SETTLED = 1e-4  # share of the mean variance that the squared moves of all centres add up to once they stand still


def k_means(points: Floats, weights: Floats, k: int, starts: int, seed: int) -> Floats:
    """Return the centres (k, D) of k clusters of points (N, D) of these weights (N,): the best of several starts."""
    rng = np.random.RandomState(seed)
    mean: Floats = points.mean(axis=0)
    apart = points - mean
    settled = _SETTLED * float(apart.var(axis=0).mean())
    found = [_lloyd(apart, weights, _spread(apart, weights, k, rng), settled) for _ in range(starts)]
    centres, _ = min(found, key=lambda each: each[1])
    return centres + mean


def _spread(points: Floats, weights: Floats, k: int, rng: np.random.RandomState) -> Floats:
    """Return k points to begin with, drawn far from each other (k-means++, Arthur and Vassilvitskii, 2007).

    Each is the best of a few draws.
    """
    draws = 2 + int(np.log(k))
    chosen = [rng.choice(len(points), p=weights / weights.sum())]
    distances = _squared_distances(points, points[chosen])[:, 0]
    while len(chosen) < k:
        masses = np.cumsum(weights * distances)
        drawn = np.searchsorted(masses, rng.uniform(size=draws) * (weights @ distances)).clip(max=len(points) - 1)
        nearest = np.minimum(distances[:, None], _squared_distances(points, points[drawn]))
        best = int(np.argmin(weights @ nearest))
        chosen.append(drawn[best])
        distances = nearest[:, best]
    return points[chosen]


def _lloyd(points: Floats, weights: Floats, centres: Floats, settled: float) -> tuple[Floats, float]:
    """Return the centres where they come to rest, and the weighted sum of squared distances to them."""
    nearest = np.full(len(points), -1)
    for _ in range(_MOST_ITERATIONS):
        before, nearest = nearest, np.argmin(_squared_distances(points, centres), axis=1)
        moved = _means(points, weights, nearest, centres)
        move, centres = float(((moved - centres) ** 2).sum()), moved
        if move <= settled or np.array_equal(nearest, before):
            break
    return centres, float(weights @ _squared_distances(points, centres).min(axis=1))


def _means(points: Floats, weights: Floats, nearest: Ints, centres: Floats) -> Floats:
    """Return the mean of each cluster; the old centre of one that has no points left."""
    masses = np.bincount(nearest, weights, len(centres))[:, None]
    sums = np.column_stack([np.bincount(nearest, weights * column, len(centres)) for column in points.T])
    means: Floats = np.where(masses > 0, sums / np.where(masses > 0, masses, 1), centres)
    return means


def _squared_distances(points: Floats, centres: Floats) -> Floats:
    """Return those of points (N, D) and centres (k, D), (N, k)."""
    distances: Floats = (points**2).sum(axis=1)[:, None] - 2 * points @ centres.T + (centres**2).sum(axis=1)
    return distances.clip(min=0)
