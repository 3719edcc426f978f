"""An order of strokes in which a hand would draw them, at little more travel of the lifted pen."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.spatial import cKDTree

from maulstick.ordering.tour import Tour
from maulstick.painting.succession import Succession
from maulstick.storage.arrays import Bools, Floats, Ints
from maulstick.strokes.strokes import path_lengths

TRAVEL = 4.0
"""Nats that a median stroke's length of travel counts as.

Chosen on plans of `held` strokes (benchmarks/order.py), whose travel it lets grow to 1.3 times at most; 2 lets it grow
to 1.6.
"""

_LEAST = 0.01  # median lengths: shorter jumps and distances are one, and ends there have no direction
_SHORTEST = 1e-6  # metres: unit of a painting of dots
_NEAR = 6  # ends near each end that a run of strokes may be joined to
_LONGEST_RUN = 3  # strokes that are moved at once
_PASSES = 20  # at most; the later ones change little
_WORTH = 1e-9  # nats that a change must gain: less is rounding


@dataclass(frozen=True)
class Outlines:
    """N strokes as far as their succession depends on them, in median lengths of a stroke.

    Way 2 i draws stroke i as it is, and way 2 i + 1 draws it backwards.
    ends: (2 N, 2), where each way begins; it ends where the other begins.  chords: (N, 2) and axes: (N, 2), directions.
    centres: (N, 2).  lengths: (N,), logarithms.
    """

    ends: Floats
    chords: Floats
    axes: Floats
    centres: Floats
    lengths: Floats

    @classmethod
    def of(cls, paths: Floats) -> Self:
        """Return those of paths (N, n, 2), metres."""
        lengths = path_lengths(paths)
        unit = max(float(np.median(lengths)), _SHORTEST)
        centres = paths.mean(axis=1)
        x, y = np.moveaxis(paths - centres[:, None], -1, 0)
        angles = np.arctan2(2 * (x * y).sum(axis=1), (x**2 - y**2).sum(axis=1)) / 2
        chords = (paths[:, -1] - paths[:, 0]) / unit
        return cls(
            paths[:, [0, -1]].reshape(-1, 2) / unit,
            chords / np.linalg.norm(chords, axis=1, keepdims=True).clip(min=_LEAST),
            np.stack([np.cos(angles), np.sin(angles)], axis=1),
            centres / unit,
            np.log((lengths / unit).clip(min=_LEAST)),
        )

    def jumps(self, before: Ints, after: Ints) -> Floats:
        """Return the travel (...) from the end of ways `before` (...) to the start of ways `after` (...)."""
        return np.asarray(np.linalg.norm(self.ends[after] - self.ends[before ^ 1], axis=-1))

    def numbers(self, before: Ints, after: Ints) -> Floats:
        """Return the six numbers (..., 6) of `Succession` for ways (...), each drawn after another one (...)."""
        one, other = before // 2, after // 2
        away, axes = self.centres[other] - self.centres[one], self.axes[one]
        along = np.abs((away * axes).sum(axis=-1))
        across = np.abs(away[..., 0] * axes[..., 1] - away[..., 1] * axes[..., 0])
        same_way = (self.chords[one] * self.chords[other]).sum(axis=-1)
        return np.stack(
            [
                np.log(self.jumps(before, after).clip(min=_LEAST)),
                np.log(np.linalg.norm(away, axis=-1).clip(min=_LEAST)),
                (along - across) / (along + across).clip(min=_LEAST),
                2 * (axes * self.axes[other]).sum(axis=-1) ** 2 - 1,
                np.where((before ^ after) & 1, -same_way, same_way),
                np.abs(self.lengths[other] - self.lengths[one]),
            ],
            axis=-1,
        )


def drawn_by(succession: Succession, paths: Floats, reversible: Bools, way: Tour) -> Tour:
    """Return a tour that a hand would rather draw than this one; its first and its last stroke stay.

    Short runs of strokes are moved, and drawn backwards where they may be, while that makes what the hand draws next
    likelier by more than `TRAVEL` for each median length of pen-up travel.
    paths: (N, n, 2), metres.  reversible: (N,).
    """
    if len(paths) < 3:
        return way
    drawn = 2 * way.order + way.turned
    improving = _Improving(Outlines.of(paths), succession.weights, reversible)
    for _ in range(_PASSES):
        if len(moves := improving.moves(drawn)) == 0:
            break
        drawn = _moved(drawn, moves)
    return Tour(drawn // 2, drawn % 2 == 1)


class _Improving:
    """What there is to gain by moving strokes of a tour."""

    def __init__(self, outlines: Outlines, weights: Floats, reversible: Bools) -> None:
        self._outlines, self._weights, self._reversible = outlines, weights, reversible
        ends = outlines.ends
        self._near = np.asarray(cKDTree(ends).query(ends, min(_NEAR + 1, len(ends)))[1])[:, 1:]

    def moves(self, drawn: Ints) -> Ints:
        """Return moves (M, 4) of runs of ways drawn (N,), each of which gains, the best first.

        A run is its first place and its count; it moves behind a place, drawn backwards where the last number is 1.
        """
        links = self._cost(drawn[:-1], drawn[1:])
        back = self._cost(drawn[1:] ^ 1, drawn[:-1] ^ 1)
        found = []
        for count in range(1, min(_LONGEST_RUN, len(drawn) - 2) + 1):
            first = np.arange(1, len(drawn) - count)
            inner = first[:, None] + np.arange(count - 1)
            saved = links[first - 1] + links[first + count - 1]
            found.append(self._best(drawn, links, saved, first, count, turned=False))
            saved += (links[inner] - back[inner]).sum(axis=1)
            free = self._reversible[drawn[first[:, None] + np.arange(count)] // 2].all(axis=1)
            found.append(self._best(drawn, links, saved[free], first[free], count, turned=True))
        gains, moves = (np.concatenate(each) for each in zip(*found, strict=True))
        order = np.argsort(-gains, kind="stable")
        return np.asarray(moves[order[gains[order] > _WORTH]])

    def _best(
        self, drawn: Ints, links: Floats, saved: Floats, first: Ints, count: int, turned: bool
    ) -> tuple[Floats, Ints]:
        """Return gains (m,) and moves (m, 4) of runs of so many strokes to where each is best.

        links: (N - 1,), cost of each stroke after the one before.  saved: (m,), what is gained where a run was.
        """
        last = first + count - 1
        begin, end = (drawn[last] ^ 1, drawn[first] ^ 1) if turned else (drawn[first], drawn[last])
        place = np.empty(len(drawn), dtype=np.int64)
        place[drawn // 2] = np.arange(len(drawn))
        near = np.hstack([self._near[begin], self._near[end ^ 1]])
        at = place[near // 2]
        stays = first[:, None] - 1
        behind = np.hstack([at - (drawn[at] == near), stays])  # before a stroke that begins there, or after it
        possible = (behind >= 0) & (behind < len(links)) & ((behind <= stays) | (behind > last[:, None]))
        behind = np.where(possible, behind, stays)
        after = drawn[np.where(behind == stays, last[:, None], behind) + 1]
        closed = self._cost(drawn[first - 1], drawn[last + 1])[:, None] - links[behind]
        cost = self._cost(drawn[behind], begin[:, None]) + self._cost(end[:, None], after)
        gains = saved[:, None] - cost - np.where(behind == stays, 0, closed)
        best = gains.argmax(axis=1)[:, None]
        gain, to = (np.take_along_axis(each, best, axis=1)[:, 0] for each in (gains, behind))
        return gain, np.stack([first, np.full_like(first, count), to, np.full_like(first, turned)], axis=1)

    def _cost(self, before: Ints, after: Ints) -> Floats:
        """Return how unlikely the hand is to draw ways (...) after others (...), nats, with what their travel counts.

        Lower is better; what all choices have in common is left out.
        """
        travel = TRAVEL * self._outlines.jumps(before, after)
        return np.asarray(travel - self._outlines.numbers(before, after) @ self._weights)


def _moved(drawn: Ints, moves: Ints) -> Ints:
    """Return ways (N,) after those of the moves that do not touch what an earlier one touches."""
    touched = np.zeros(len(drawn), dtype=np.bool_)
    keys = np.arange(len(drawn), dtype=np.float64)  # that they are sorted by
    drawn = drawn.copy()
    for first, count, behind, turned in moves.tolist():
        around, gap = slice(first - 1, first + count + 1), slice(behind, behind + 2)
        if touched[around].any() or touched[gap].any():
            continue
        touched[around] = touched[gap] = True
        run = slice(first, first + count)
        if turned:
            drawn[run] = drawn[run][::-1] ^ 1
        if behind != first - 1:
            keys[run] = behind + np.arange(1, count + 1) / (count + 1)
    return drawn[np.argsort(keys, kind="stable")]
