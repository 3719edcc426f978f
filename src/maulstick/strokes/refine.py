"""Finer points of strokes: a spline through the points of each, so that long strokes show and drive no corners.

It is the centripetal Catmull-Rom spline; docs/equations.md has the equation, and what speaks for it.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from maulstick.storage.arrays import Bools, Floats, Ints

SAGITTA: Final = 1e-4
"""Metres that a refined stroke, straight from point to point, departs from its spline at most."""

_STILL = 1e-9  # metres: a shorter step is a rest, after which a stroke may go on in any direction


def refine(strokes: Sequence[Floats]) -> list[Floats]:
    """Return strokes of points (n, 2 or more), x and y in metres first, with further points where they curve.

    All points that were given stay. Between two of them x and y follow the spline, to `SAGITTA`, and further columns
    (pressure, speed) change linearly. A point that is given twice is a corner; elsewhere the spline is smooth.
    """
    sizes = np.array([len(stroke) for stroke in strokes], dtype=np.int64)
    if sizes.sum() < 2:
        return list(strokes)
    points, lasts = np.concatenate(strokes), np.cumsum(sizes) - 1
    steps = np.diff(points[:, :2], axis=0)
    lengths = np.hypot(*steps.T)
    moves = lengths > _STILL
    moves[lasts[:-1]] = False
    spans = np.sqrt(np.where(moves, lengths, 1.0))
    along = np.concatenate([[0.0], np.cumsum(spans)])
    spline = CubicHermiteSpline(along, points[:, :2], _slopes(steps / spans[:, None], spans, moves))
    pieces = np.ones(len(steps), dtype=np.int64)
    coarse = np.flatnonzero(moves)
    while len(coarse):
        excess = np.sqrt(_sagittas(spline, coarse, pieces[coarse]) / SAGITTA)
        coarse, excess = coarse[excess > 1], excess[excess > 1]
        pieces[coarse] = np.maximum((pieces[coarse] * excess).astype(np.int64), pieces[coarse] + 1)
    step, share = _divided(pieces)
    finer = points[step] + share[:, None] * np.diff(points, axis=0)[step]
    finer[:, :2] = spline(along[step] + share * spans[step])
    begins = np.cumsum(pieces)[lasts[:-1]]
    return np.split(np.concatenate([finer, points[-1:]]), begins)


def _slopes(speeds: Floats, spans: Floats, moves: Bools) -> Floats:
    """Return the spline's derivatives (P, 2) at points from the mean ones (P - 1, 2) over the steps between them.

    spans, moves: (P - 1,) of the parameter over each step, and whether it moves. Between two steps that move, it is
    the derivative of the parabola through three points; at the other end of a step, the second derivative is 0.
    """
    before, after = spans[:-1, None], spans[1:, None]
    inner = np.pad(moves[:-1] & moves[1:], 1)
    slopes = np.pad((after * speeds[:-1] + before * speeds[1:]) / (before + after), ((1, 1), (0, 0)))
    slopes[~inner] = 0
    begins, ends = moves & ~inner[:-1], moves & ~inner[1:]
    at_begins = np.where(ends[:, None], speeds, 1.5 * speeds - 0.5 * slopes[1:])
    at_ends = np.where(begins[:, None], speeds, 1.5 * speeds - 0.5 * slopes[:-1])
    slopes[:-1][begins] = at_begins[begins]
    slopes[1:][ends] = at_ends[ends]
    return slopes


def _sagittas(spline: CubicHermiteSpline, steps: Ints, pieces: Ints) -> Floats:
    """Return how far the spline departs, metres, over steps (k,) from so many equal pieces (k,) of each, made straight.

    That is a bound: the distance of a cubic from its chord is at most 3/4 of that of its control points.
    """
    step, share = _divided(pieces)
    spans = np.diff(spline.x)[steps]
    begins = spline.x[steps][step] + share * spans[step]
    ends = begins + (spans / pieces)[step]
    chords = spline(ends) - spline(begins)
    directions = chords / np.maximum(np.hypot(*chords.T), _STILL)[:, None]
    handles = (ends - begins)[:, None] / 3
    one, other = (_across(directions, handles * spline(places, nu=1)) for places in (begins, ends))
    return np.maximum.reduceat(0.75 * np.maximum(one, other), np.cumsum(pieces) - pieces)


def _across(directions: Floats, arrows: Floats) -> Floats:
    """Return the length (k,) of arrows (k, 2) across unit directions (k, 2)."""
    return np.abs(directions[:, 0] * arrows[:, 1] - directions[:, 1] * arrows[:, 0])


def _divided(pieces: Ints) -> tuple[Ints, Floats]:
    """Return the pieces that steps are divided into, as the index of the step and the share of it before the piece."""
    step = np.repeat(np.arange(len(pieces)), pieces)
    within = np.arange(len(step)) - (np.cumsum(pieces) - pieces)[step]
    return step, within / pieces[step]
