"""Fills that are hatched by a hand: its strokes laid end to end along rows, in its directions, and cut at the edge."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.random import Generator
from shapely.geometry.base import BaseGeometry

from maulstick.drawing.lines import cut, lengths
from maulstick.drawing.regions import rows_through
from maulstick.errors import InputError
from maulstick.storage.arrays import Floats
from maulstick.strokes.refine import refine

_MOST_STROKES = 200_000  # in one shape: weeks of drawing
_SHORTEST = 0.5  # of the spacing: a shorter piece at the edge is a speck
_NARROWEST = 1e-4  # metres along a row that each stroke takes at least: keeps a dot from filling a row without end


@dataclass(frozen=True)
class HatchingHand:
    """Strokes of a hand, for hatching.

    paths: (M, n, 2) metres.  angle: direction in which the hand leans, radians, None where it is unknown.
    turns: (T,) by how much single strokes turn from it, radians.
    """

    paths: Floats
    angle: float | None
    turns: Floats

    def levelled(self) -> Self:
        """Return the same hand with the principal axis of each path along x, and its middle at the origin."""
        away = self.paths - self.paths.mean(axis=1, keepdims=True)
        x, y = away[..., 0], away[..., 1]
        axes = np.arctan2(2 * (x * y).sum(axis=1), (x * x - y * y).sum(axis=1)) / 2
        level = np.stack([_turned(path, -axis) for path, axis in zip(away, axes, strict=True)])
        middles = (level.min(axis=1) + level.max(axis=1)) / 2
        return type(self)(level - middles[:, None], self.angle, self.turns)


def hatched_by_hand(
    hand: HatchingHand, region: BaseGeometry, spacing: float, angle: float, rng: Generator
) -> list[Floats]:
    """Return lines (k, 2), metres, of a hand that fill a region with as much ink as lines so far apart would.

    hand: levelled.  angle: of the rows, radians. Rows of strokes that wind lie further apart than those of straight
    ones. Raises InputError where that would take too many strokes.
    """
    spans = np.ptp(hand.paths[..., 0], axis=1).clip(min=_NARROWEST)
    wound = float(lengths(list(hand.paths)).sum() / spans.sum())
    rows = rows_through(region, spacing * max(wound, 1.0), angle)
    if sum(float(np.hypot(*(row[-1] - row[0]))) for row in rows) > _MOST_STROKES * float(spans.mean()):
        raise InputError(f"its hatching takes over {_MOST_STROKES} strokes in one shape; hatch wider")
    laid: list[Floats] = []
    for row in rows:
        laid += _along(row, hand, spans, rng)
    pieces = [piece for each in cut(refine(laid), region) for piece in each] if laid else []
    return [piece for piece, length in zip(pieces, lengths(pieces), strict=True) if length >= _SHORTEST * spacing]


def _along(row: Floats, hand: HatchingHand, spans: Floats, rng: Generator) -> Sequence[Floats]:
    """Return strokes laid end to end along a row (2, 2), the first of them begun somewhere before it."""
    step = row[-1] - row[0]
    whole = float(np.hypot(*step))
    along, angle = step / max(whole, _NARROWEST), float(np.arctan2(step[1], step[0]))
    found: list[Floats] = []
    place = None
    while place is None or place < whole:
        chosen = int(rng.integers(len(spans)))
        place = -rng.uniform() * spans[chosen] if place is None else place
        turn = float(hand.turns[rng.integers(len(hand.turns))])
        middle = row[0] + (place + spans[chosen] / 2) * along
        found.append(_turned(hand.paths[chosen], angle + turn) + middle)
        place += spans[chosen]
    return found


def _turned(path: Floats, angle: float) -> Floats:
    cos, sin = np.cos(angle), np.sin(angle)
    turned: Floats = path @ np.array([[cos, sin], [-sin, cos]])
    return turned
