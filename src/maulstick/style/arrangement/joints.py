"""Joints of a drawing's lines: where one stroke takes up the line of another, lapping over it or leaving a gap."""

import numpy as np
import shapely
from numpy.typing import NDArray

from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import path_lengths

_BESIDE = 0.08  # median lengths: strokes no farther apart lie on one line
_AHEAD = 0.5  # median lengths: what begins farther ahead is another line
_ALIKE = np.cos(np.radians(30))  # of the angle between strokes on one line
_GOES_ON = 0.2  # of a stroke's length, that another must go beyond its end
_STEP = 0.05  # median lengths to both sides, over which a stroke's direction is taken
_JOINED = 0.3  # share of strokes' ends where another goes on: below, few lines are made of several strokes


def laps_of(paths: Floats) -> Floats:
    """Return how far strokes go on beside the one that takes up their line, (J,); none where few do.

    Above 0, shares of their own lengths, at most 0.8, as the other goes on by a fifth at least; below 0, gaps, in
    median lengths. At most one goes on at each end, the nearest, and at one end only if it lies beside both.

    paths: (N, n, 2).
    """
    lengths, lines = path_lengths(paths), shapely.linestrings(paths)
    unit = float(np.median(lengths))
    inwards = np.concatenate([paths[:, ::-1], paths])  # from each end on
    ends, ways = inwards[:, 0], _outward_ways(inwards)
    feelers = shapely.linestrings(np.stack([ends - _BESIDE * unit * ways, ends + _AHEAD * unit * ways], axis=1))
    end, other = shapely.STRtree(lines).query(feelers, predicate="dwithin", distance=_BESIDE * unit)
    stroke = end % len(paths)
    apart = stroke != other
    end, stroke, other = end[apart], stroke[apart], other[apart]
    own, way = lengths[stroke], ways[end]  # a dot has no way, and no joint

    at = shapely.line_locate_point(lines[other], shapely.points(ends[end]))
    before, here, after = (
        shapely.get_coordinates(shapely.line_interpolate_point(lines[other], (at + step).clip(0, lengths[other])))
        for step in (-_STEP * unit, 0, _STEP * unit)
    )
    along = _dot(after - before, way) / np.linalg.norm(after - before, axis=1).clip(min=1e-12)
    offset = here - ends[end]
    ahead, distance = _dot(offset, way), np.linalg.norm(offset, axis=1)
    aside = np.sqrt((distance**2 - ahead**2).clip(min=0))
    behind = np.where(along > 0, at, lengths[other] - at)  # of the other stroke, as far as it came

    on_one_line = (np.abs(along) > _ALIKE) & (aside < _BESIDE * unit) & (ahead > -_BESIDE * unit)
    joined = np.flatnonzero(on_one_line & (lengths[other] - behind > _GOES_ON * own))
    nearest_first = joined[np.lexsort((distance[joined], end[joined]))]
    nearest = nearest_first[np.unique(end[nearest_first], return_index=True)[1]]
    once = nearest[np.unique(stroke[nearest] + len(paths) * other[nearest], return_index=True)[1]]
    if len(once) < _JOINED * len(ends):
        return np.zeros(0)
    laps: Floats = (behind - ahead)[once]
    beside = _beside(inwards[end[once]], lines[other[once]], _BESIDE * unit)
    return np.where(laps > 0, np.minimum(laps / own[once], beside).clip(max=1 - _GOES_ON), laps / unit)


def _beside(inwards: Floats, others: NDArray[np.object_], distance: float) -> Floats:
    """Return what share of each stroke (J, n, 2), from its first point on, is no farther from another one, (J,)."""
    near = shapely.distance(shapely.points(inwards), others[:, None]) <= distance
    shares: Floats = np.minimum.accumulate(near, axis=1).mean(axis=1)
    return shares


def _dot(a: Floats, b: Floats) -> Floats:
    return np.asarray((a * b).sum(axis=1))


def _outward_ways(inwards: Floats) -> Floats:
    """Return which way strokes (N, n, 2) go over their first sixth, backwards: unit vectors (N, 2)."""
    way = inwards[:, 0] - inwards[:, max(1, inwards.shape[1] // 6)]
    ways: Floats = way / np.linalg.norm(way, axis=1, keepdims=True).clip(min=1e-12)
    return ways
