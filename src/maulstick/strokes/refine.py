"""Finer points of strokes: a spline through the points of each, so that long strokes show and drive no corners.

It is the centripetal Catmull-Rom spline; docs/equations.md has the equation, and what speaks for it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Self

import numpy as np

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
    moves = np.hypot(*np.diff(points[:, :2], axis=0).T) > _STILL
    moves[lasts[:-1]] = False
    spline = _Spline.through(points[:, :2], moves)
    pieces = np.ones(len(moves), dtype=np.int64)
    coarse = np.flatnonzero(moves)
    while len(coarse):
        excess = np.sqrt(spline.sagittas(coarse, pieces[coarse]) / SAGITTA)
        coarse, excess = coarse[excess > 1], excess[excess > 1]
        pieces[coarse] = np.maximum((pieces[coarse] * excess).astype(np.int64), pieces[coarse] + 1)
    step, share = _divided(pieces)
    finer = points[step] + share[:, None] * np.diff(points, axis=0)[step]
    finer[:, :2] = spline.at(step, share)
    begins = np.cumsum(pieces)[lasts[:-1]]
    return np.split(np.concatenate([finer, points[-1:]]), begins)


@dataclass(frozen=True)
class _Spline:
    """Cubic over each step between two points: start + linear u + square u² + cube u³, (P - 1, 2), u in [0, 1]."""

    start: Floats
    linear: Floats
    square: Floats
    cube: Floats

    @classmethod
    def through(cls, points: Floats, moves: Bools) -> Self:
        """Return the spline through points (P, 2); moves: (P - 1,) whether a step moves within a stroke."""
        steps = np.diff(points, axis=0)
        spans = np.where(moves, np.hypot(*steps.T) ** 0.5, 1.0)[:, None]
        slopes = _slopes(steps / spans, spans, moves)
        begin, end = spans * slopes[:-1], spans * slopes[1:]
        return cls(points[:-1], begin, 3 * steps - 2 * begin - end, begin + end - 2 * steps)

    def at(self, step: Ints, share: Floats) -> Floats:
        """Return the places (k, 2) after these shares (k,) of steps (k,)."""
        u = share[:, None]
        return self.start[step] + u * (self.linear[step] + u * (self.square[step] + u * self.cube[step]))

    def sagittas(self, steps: Ints, pieces: Ints) -> Floats:
        """Return how far the spline departs, metres, over steps (k,), from equal pieces (k,) of each, made straight.

        That is a bound: the distance of a cubic from its chord is at most 3/4 of that of its control points.
        """
        which, begin = _divided(pieces)
        step, end = steps[which], begin + 1 / pieces[which]
        chords = self.at(step, end) - self.at(step, begin)
        directions = chords / np.maximum(np.hypot(*chords.T), _STILL)[:, None]
        one, other = (np.abs(_cross(directions, self._slope(step, share))) for share in (begin, end))
        return np.maximum.reduceat(np.maximum(one, other), np.cumsum(pieces) - pieces) / (4 * pieces)

    def _slope(self, step: Ints, share: Floats) -> Floats:
        """Return the derivatives (k, 2) by the share."""
        u = share[:, None]
        return self.linear[step] + u * (2 * self.square[step] + 3 * u * self.cube[step])


def _slopes(speeds: Floats, spans: Floats, moves: Bools) -> Floats:
    """Return the spline's derivatives (P, 2) at points from the mean ones (P - 1, 2) over the steps between them.

    spans: (P - 1, 1) of the parameter over each step. Between two steps that move, it is the derivative of the parabola
    through three points; at the other end of a step, the second derivative is 0.
    """
    before, after = spans[:-1], spans[1:]
    inner = np.pad(moves[:-1] & moves[1:], 1)
    slopes = np.pad((after * speeds[:-1] + before * speeds[1:]) / (before + after), ((1, 1), (0, 0)))
    begins, ends = moves & ~inner[:-1], moves & ~inner[1:]
    at_begins = np.where(ends[:, None], speeds, 1.5 * speeds - 0.5 * slopes[1:])
    at_ends = np.where(begins[:, None], speeds, 1.5 * speeds - 0.5 * slopes[:-1])
    slopes[:-1][begins] = at_begins[begins]
    slopes[1:][ends] = at_ends[ends]
    return slopes


def _cross(one: Floats, other: Floats) -> Floats:
    return one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]


def _divided(pieces: Ints) -> tuple[Ints, Floats]:
    """Return the pieces that steps are divided into, as the index of the step and the share of it before the piece."""
    step = np.repeat(np.arange(len(pieces)), pieces)
    within = np.arange(len(step)) - (np.cumsum(pieces) - pieces)[step]
    return step, within / pieces[step]
