"""Places on a map, moved apart so that each can be seen and pointed at."""

from math import sqrt

import numpy as np
from scipy.spatial import KDTree

from maulstick.storage.arrays import Floats

_SHARE = 0.8  # distance to the nearest over the side of a place's share of the map; 1.07 would be the closest packing
_LEAST = 0.99  # of that distance: as good as all of it
_STEPS = 500


def spread_apart(places: Floats, wide: float) -> Floats:
    """Move places (N, 2) in the square of side 1 about the origin apart, by as little as they need.

    wide: width of the map over its height.
    """
    apart = _SHARE * sqrt(wide / len(places))
    half = np.array([wide, 1.0]) / 2
    turns = 2.4 * np.arange(len(places))  # radians, the golden angle: no two the same way
    aside = 1e-3 * apart * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    moved = np.clip(places * [wide, 1.0] + aside, -half, half)
    for _ in range(_STEPS):
        pairs = KDTree(moved).query_pairs(apart * _LEAST, output_type="ndarray")
        if not len(pairs):
            break
        between = moved[pairs[:, 0]] - moved[pairs[:, 1]] + 1e-3 * aside[pairs[:, 0]]  # never nothing
        distance = np.linalg.norm(between, axis=1, keepdims=True)
        push = between / distance * (apart - distance) / 2
        np.add.at(moved, pairs[:, 0], push)
        np.add.at(moved, pairs[:, 1], -push)
        moved = np.clip(moved, -half, half)
    return moved / [wide, 1.0]
