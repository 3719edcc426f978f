"""Refined paintings: strokes with as many points as their curves need, as they are previewed, exported and painted."""

import numpy as np

from maulstick.painting.painting import Painting, Sheet, Stroke
from maulstick.storage.arrays import Floats
from maulstick.strokes.refine import refine


def refined(painting: Painting) -> Painting:
    """Return the painting with further points in its strokes, as `refine` finds them; ids, order and paints stay.

    No new point lies further off the sheet than the other points of its stroke, or at most on the sheet's edge.
    A painting that is `literal` has all points that it needs.
    """
    if painting.literal:
        return painting
    paths = refine([_columns(stroke) for stroke in painting.strokes])
    strokes = (_with(stroke, path, painting.sheet) for stroke, path in zip(painting.strokes, paths, strict=True))
    return painting.model_copy(update={"strokes": tuple(strokes)})


def _columns(stroke: Stroke) -> Floats:
    """Return x, y, pressure and speed at the points of a stroke, (n, 4); the speed is 0 where it has none."""
    trajectory = np.array(stroke.trajectory, dtype=np.float64)
    speed = np.zeros(len(trajectory)) if stroke.speed is None else np.array(stroke.speed)
    return np.column_stack([trajectory, speed])


def _with(stroke: Stroke, path: Floats, sheet: Sheet) -> Stroke:
    """Return the stroke with the points (n, 4) instead of its own."""
    if len(path) == len(stroke.trajectory):
        return stroke
    own = np.array(stroke.trajectory)[:, :2]
    path[:, :2] = path[:, :2].clip(own.min(axis=0).clip(max=0), own.max(axis=0).clip(min=(sheet.width, sheet.height)))
    points = tuple(map(tuple, path[:, :3].tolist()))
    speed = None if stroke.speed is None else tuple(path[:, 3].tolist())
    return stroke.model_copy(update={"trajectory": points, "speed": speed})
