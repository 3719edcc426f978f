"""The sequence in which a machine paints: few changes of paint, then little travel, every overlap as planned."""

from collections.abc import Iterator

import numpy as np
import shapely
from numpy.typing import NDArray

from maulstick.ordering.layers import runs
from maulstick.ordering.succession import drawn_by
from maulstick.ordering.tour import tour
from maulstick.painting.brush import Brush
from maulstick.painting.painting import Painting, Stroke
from maulstick.painting.refined import refined
from maulstick.storage.arrays import Bools, Floats, Ints
from maulstick.strokes.strokes import resampled

_PRECISE = 1e-6  # metres: marks that differ by less are the same; a painting's file keeps no more
_SMOOTHED = 0.05  # half-widths: tolerance of a mark's simplified centre line; the mark counts as wider by it


def sequenced(painting: Painting, start: tuple[float, float]) -> Painting:
    """Return the painting with its strokes in a quick order for a pen at `start`, metres; it looks the same.

    Where the painting knows its hand's succession, strokes come as the hand would draw them, at little more travel.
    Strokes keep their ids, and overlapping strokes of different paints keep their order. Strokes of one paint may come
    in any order, as a colour over itself is the same colour. Neither brush nor paint changes more often than before,
    but for a paint that saves a change of brush, which takes a person longer. A stroke may be reversed where its
    pressure is even, it has no speeds of its own, and its mark stays the same.
    A painting that is `literal` stays as it is.
    """
    if painting.literal:
        return painting
    paint_of = np.array([stroke.paint for stroke in painting.strokes], dtype=np.int64)
    ends = np.array([[s.trajectory[0][:2], s.trajectory[-1][:2]] for s in painting.strokes]).reshape(-1, 2, 2)
    may = reversible(painting)
    strokes: list[Stroke] = []
    names = list(painting.brushes)
    brushes = np.array([names.index(paint.brush) for paint in painting.paints], dtype=np.int64)
    for run in runs(paint_of, brushes, _overlaps(refined(painting), paint_of)):
        way = tour(ends[run], may[run], start)
        if painting.succession is not None:
            paths = resampled(np.array(painting.strokes[i].trajectory) for i in run)[..., :2]
            way = drawn_by(painting.succession, paths, may[run], way)
        strokes += [
            _turned(painting.strokes[run[i]]) if turned else painting.strokes[run[i]]
            for i, turned in zip(way.order, way.turned, strict=True)
        ]
        start = strokes[-1].trajectory[-1][:2]
    return painting.model_copy(update={"strokes": tuple(strokes)})


def _turned(stroke: Stroke) -> Stroke:
    return stroke.model_copy(update={"trajectory": stroke.trajectory[::-1]})


def reversible(painting: Painting) -> Bools:
    """Return whether each stroke, (N,), leaves the same mark when drawn backwards, and has no speeds of its own."""
    return np.concatenate([_reversible(part) for part in painting.parts()])


def _reversible(painting: Painting) -> Bools:
    trajectories = painting.trajectories()
    even = np.ptp(trajectories[..., 2], axis=1) == 0
    hasty = np.array([stroke.speed is not None for stroke in painting.strokes], dtype=np.bool_)
    paths = trajectories[..., :2]
    backwards = _marks(painting, paths[:, ::-1])[:, ::-1]
    same = np.abs(backwards - _marks(painting, paths)).max(axis=(1, 2), initial=0) < _PRECISE
    return np.asarray(even & ~hasty & same)


def _marks(painting: Painting, paths: Floats) -> Floats:
    """Return the centre lines (N, n, 2) of the marks that commanded paths (N, n, 2) leave, metres."""
    marks = np.empty_like(paths)
    for brush, rows in _brushes(painting):
        marks[rows] = brush.mark(paths[rows])
    return marks


def _widest(painting: Painting, pressure: Floats) -> Floats:
    """Return the half-widths (N,) of marks with pressure (N, n) at their widest place and direction, metres."""
    widest = np.empty(len(pressure))
    for brush, rows in _brushes(painting):
        widest[rows] = brush.half_width(pressure[rows].max(axis=1)) * (1 + np.hypot(*brush.nib))
    return widest.clip(min=0)


def _brushes(painting: Painting) -> Iterator[tuple[Brush, Ints]]:
    """Yield each brush and the indices of the strokes that it draws."""
    names = np.array([painting.paints[stroke.paint].brush for stroke in painting.strokes], dtype=np.str_)
    for name, brush in painting.brushes.items():
        yield brush, np.flatnonzero(names == name)


def _lines(painting: Painting) -> tuple[NDArray[np.object_], Floats]:
    """Return the marks' centre lines (N,), simplified, and how far from them the marks reach, (N,), metres."""
    trajectories = painting.trajectories()
    widest = _widest(painting, trajectories[..., 2])
    marks = _marks(painting, trajectories[..., :2])
    closed = np.concatenate([marks, marks[:, -1:]], axis=1)  # a line has two points at least
    lines = shapely.simplify(shapely.linestrings(closed), _SMOOTHED * widest, preserve_topology=False)
    return lines, (1 + _SMOOTHED) * widest


def _overlaps(painting: Painting, paint_of: Ints) -> Ints:
    """Return pairs (E, 2) of strokes of different paints whose marks may overlap, the earlier one first."""
    pairs = np.zeros((0, 2), dtype=np.int64)
    if len(paints := np.unique(paint_of)) < 2:
        return pairs
    lines, reach = (np.concatenate(each) for each in zip(*map(_lines, painting.parts()), strict=True))
    west, north, east, south = shapely.bounds(lines).T
    boxes = shapely.box(west - reach, north - reach, east + reach, south + reach)
    for paint in paints[:-1]:
        ours, others = np.flatnonzero(paint_of == paint), np.flatnonzero(paint_of > paint)
        one, other = shapely.STRtree(boxes[ours]).query(boxes[others])[::-1]
        one, other = ours[one], others[other]
        near = shapely.dwithin(lines[one], lines[other], reach[one] + reach[other])
        pairs = np.concatenate([pairs, np.sort(np.stack([one[near], other[near]], axis=1), axis=1)])
    return pairs
