"""A tour: strokes in an order, some of them reversed, with little travel of the lifted pen between them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from maulstick.errors import InputError
from maulstick.ordering import _tour
from maulstick.storage.arrays import Bools, Floats, Ints

_NEIGHBOURS = 8  # points near each end that the search tries to join it to
_DISTURBANCES = 2  # of the search per stroke: more gain little, and take longer than vpype's nearest strokes do
_LEAST = 50  # disturbances, so that a handful of strokes gets its best order


@dataclass(frozen=True)
class Tour:
    """Tour through strokes.

    order: (N,) indices of strokes in the order of drawing.  turned: (N,) whether each of those is drawn backwards.
    """

    order: Ints
    turned: Bools


def tour(ends: Floats, reversible: Bools, start: tuple[float, float]) -> Tour:
    """Return a tour with short pen-up travel, always the same for the same strokes.

    ends: (N, 2, 2) first and last point of each stroke, metres.  reversible: (N,) whether it may be drawn backwards.
    start: place of the pen before the first stroke, metres.
    Raises InputError for ends that are not finite.
    """
    count = len(ends)
    if not np.isfinite(ends).all() or not np.isfinite(start).all():
        raise InputError("a stroke starts or ends, or the pen is, at no place; every x and y must be a finite number")
    points = np.concatenate([np.reshape(ends, (-1, 2)), [start, start]])
    drawn = np.zeros(count, dtype=np.int32)
    if count:
        disturbances = _LEAST + _DISTURBANCES * count
        _tour.shortest(points, reversible.astype(np.uint8), *_near(points, reversible), disturbances, drawn)
    return Tour(drawn.astype(np.int64) // 2, drawn % 2 == 1)


def pen_up(ends: Floats, way: Tour, start: tuple[float, float]) -> float:
    """Return the pen-up travel of a tour, metres: from `start` to its first stroke, and from each to the next."""
    drawn = ends[way.order]
    drawn = np.where(way.turned[:, None, None], drawn[:, ::-1], drawn)
    left = np.concatenate([[start], drawn[:, 1]])[:-1]
    return float(np.linalg.norm(drawn[:, 0] - left, axis=1).sum())


def _near(points: Floats, reversible: Bools) -> tuple[NDArray[np.int32], Floats]:
    """Return for each point (2 N + 2, 2) the K nearest at which another stroke may begin, and their distances."""
    begins = np.column_stack([np.ones_like(reversible), reversible]).ravel().nonzero()[0]
    gaps, rows = cKDTree(points[begins]).query(points, k=range(1, min(_NEIGHBOURS + 2, len(begins)) + 1))
    own = begins[rows] // 2 == np.arange(len(points))[:, None] // 2
    enough = min(_NEIGHBOURS, own.shape[1] - int(own.sum(axis=1).max()))
    others = np.argsort(own, axis=1, kind="stable")[:, :enough]
    near = np.take_along_axis(begins[rows], others, axis=1)
    return near.astype(np.int32), np.take_along_axis(np.asarray(gaps), others, axis=1)
