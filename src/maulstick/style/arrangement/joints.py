"""Joints of a drawing's lines: where one stroke takes up the line of another, lapping over it or leaving a gap."""

import numpy as np
import shapely

from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import path_lengths

_BESIDE = 0.08  # median lengths: strokes no farther apart lie on one line
_AHEAD = 0.5  # median lengths: what begins farther ahead is another line
_ALIKE = np.cos(np.radians(30))  # of the angle between strokes on one line
_GOES_ON = 0.2  # of a stroke's length, that another must go beyond its end
_STEP = 0.05  # median lengths to both sides, over which a stroke's direction is taken


def laps_of(paths: Floats) -> Floats:
    """Return how far strokes go on beside the one that takes up their line, (J,), as shares of their own lengths.

    Below 0 there is a gap; at 1 the other came as far as the stroke is long. Its way up to the stroke's end counts,
    wherever it came from. At most one goes on at each end, the nearest, and where none does there is no joint.

    paths: (N, n, 2).
    """
    lengths, lines = path_lengths(paths), shapely.linestrings(paths)
    unit = float(np.median(lengths))
    ends = np.concatenate([paths[:, -1], paths[:, 0]])
    ways = np.concatenate([_last_ways(paths), _last_ways(paths[:, ::-1])])
    end, other = shapely.STRtree(lines).query(shapely.points(ends), predicate="dwithin", distance=_AHEAD * unit)
    end, other = end[end % len(paths) != other], other[end % len(paths) != other]
    own, way = lengths[end % len(paths)], ways[end]  # a dot has no way, and no joint

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
    laps: Floats = ((behind - ahead)[nearest] / own[nearest]).clip(-1, 1)
    return laps


def _dot(a: Floats, b: Floats) -> Floats:
    return np.asarray((a * b).sum(axis=1))


def _last_ways(paths: Floats) -> Floats:
    """Return which way paths (N, n, 2) go over their last sixth, unit vectors (N, 2)."""
    last = paths[:, -1] - paths[:, -1 - max(1, paths.shape[1] // 6)]
    ways: Floats = last / np.linalg.norm(last, axis=1, keepdims=True).clip(min=1e-12)
    return ways
