"""Lines of one pen in a quick order, without those that are there twice, and joined where their ends meet."""

from collections import deque
from collections.abc import Iterable, Sequence
from math import isfinite

import numpy as np
from scipy.spatial import cKDTree

from maulstick.drawing.lines import SAME
from maulstick.ordering.tour import tour
from maulstick.storage.arrays import Bools, Floats, Ints

_ALIKE = 1e-5  # metres: lines that differ by less at each point are the same
_NONE = -1  # instead of the number of an end
_BEYOND = 1 + 1e-9  # times a distance, which rounding may have made too small
_NOWHERE = 1e-12  # metres, which no one draws: so far beyond a gap of none
_BETWEEN = 0.25  # of that: files end in tenths of it, which then never lie where rounding may go either way


def in_quick_order(lines: Sequence[Floats], start: tuple[float, float]) -> list[Floats]:
    """Return lines (k, 2) in an order of little travel for a pen at `start`, metres; some of them are turned."""
    ends = np.array([line[[0, -1]] for line in lines]).reshape(-1, 2, 2)
    way = tour(ends, np.ones(len(lines), dtype=np.bool_), start)
    return [lines[i][::-1] if turned else lines[i] for i, turned in zip(way.order, way.turned, strict=True)]


def without_repeats(lines: Sequence[Floats]) -> list[Floats]:
    """Return the lines (k, 2) without those that another has drawn before, in either direction."""
    seen: set[bytes] = set()
    found: list[Floats] = []
    for line in lines:
        places = np.round(line / _ALIKE + _BETWEEN).astype(np.int64)
        key = min(places.tobytes(), places[::-1].tobytes())
        if key not in seen:
            seen.add(key)
            found.append(line)
    return found


def joined(lines: Sequence[Floats], gap: float) -> list[Floats]:
    """Return the lines (k, 2), of which those whose ends are at most `gap` metres apart are one, in their order.

    A line goes on with the one whose end is nearest, turned where it has to be, from its last point on and then from
    its first. Closed ones stay alone.
    """
    ends = np.array([line[[0, -1]] for line in lines]).reshape(-1, 2)
    is_open = np.hypot(*(ends[1::2] - ends[::2]).T) > _ALIKE
    free, left, found = _FreeEnds(ends, is_open), np.ones(len(lines), dtype=np.bool_), list[Floats]()
    for first, line in enumerate(lines):
        if not left[first]:
            continue
        parts = deque([line])
        free.take(first)
        for end in (2 * first + 1, 2 * first) if is_open[first] else ():
            at_last = bool(end % 2)
            while (near := free.nearest(end, gap)) is not None:
                row, end = near // 2, near ^ 1
                free.take(row)
                left[row] = False
                forward = lines[row] if bool(near % 2) != at_last else lines[row][::-1]
                (parts.append if at_last else parts.appendleft)(forward)
        found.append(line if len(parts) == 1 else _in_one(parts))
    return found


class _FreeEnds:
    """Ends of lines to which nothing is joined yet: of line i those of number 2 i and 2 i + 1.

    Thousands of lines may meet in one place, or nearly: ends are kept by place, and only places with any are looked at.
    ends: (2 n, 2) metres.  is_open: (n,) whether a line can be joined to others.
    """

    def __init__(self, ends: Floats, is_open: Bools) -> None:
        self._places, place_of = np.unique(ends, axis=0, return_inverse=True)
        self._place_of = place_of.reshape(-1)
        self._free = np.repeat(is_open, 2)
        self._at = [deque[int]() for _ in self._places]
        for end, place in enumerate(self._place_of.tolist()):
            self._at[place].append(end)
        self._first = np.full(len(self._places), _NONE)
        for place in range(len(self._places)):
            self._look_at(place)
        self._plant()

    def take(self, line: int) -> None:
        """Count both ends of a line as joined."""
        self._free[2 * line : 2 * line + 2] = False
        for place in self._place_of[2 * line : 2 * line + 2].tolist():
            self._look_at(place)
        self._until_planted -= 2
        if self._until_planted < 0:
            self._plant()

    def nearest(self, end: int, gap: float) -> int | None:
        """Return the free end that is nearest to an end, of several the first; None where none is within the gap."""
        here = self._places[self._place_of[end]]
        places = self._with_ends(self._tree.query_ball_point(here, min(self._distance(here, gap), gap)))
        if not len(places):
            return None
        places = places[np.argsort(self._first[places])]
        return int(self._first[places[np.hypot(*(self._places[places] - here).T).argmin()]])

    def _distance(self, here: Floats, gap: float) -> float:
        """Return hardly more than the distance of the nearest free end, or than the gap where none is within that."""
        asked, farthest = 2, gap * _BEYOND + _NOWHERE
        while True:
            distances, near = self._tree.query(here, asked, distance_upper_bound=farthest)
            for distance, place in zip(np.asarray(distances).tolist(), np.asarray(near).tolist(), strict=True):
                if not isfinite(distance):
                    return farthest
                if len(self._with_ends([place])):
                    return float(distance) * _BEYOND
            asked *= 2

    def _plant(self) -> None:
        """Leave out of the tree the places that have no free ends any more."""
        self._planted = np.flatnonzero(self._first != _NONE)
        self._tree = cKDTree(self._places[self._planted])
        self._until_planted = len(self._planted) // 2  # ends that may be taken until most places may have none

    def _with_ends(self, planted: Sequence[int]) -> Ints:
        """Return those places that have free ends, by their numbers in the tree."""
        places = self._planted[np.array(planted, dtype=np.int64)]
        left: Ints = places[self._first[places] != _NONE]
        return left

    def _look_at(self, place: int) -> None:
        ends = self._at[place]
        while ends and not self._free[ends[0]]:
            ends.popleft()
        self._first[place] = ends[0] if ends else _NONE


def _in_one(parts: Iterable[Floats]) -> Floats:
    """Return lines (k, 2) one after another as one, in which a point where two meet is there once."""
    points: Floats = np.concatenate(list(parts))
    goes_on: Bools = np.append(True, np.hypot(*np.diff(points, axis=0).T) > SAME)
    return points[goes_on]
