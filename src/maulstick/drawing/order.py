"""Lines of one pen in a quick order, without those that are there twice, and joined where their ends meet."""

from collections import deque
from collections.abc import Iterable, Sequence

import numpy as np
from scipy.spatial import cKDTree

from maulstick.drawing.lines import SAME
from maulstick.ordering.tour import tour
from maulstick.storage.arrays import Bools, Floats

_ALIKE = 1e-5  # metres: lines that differ by less at each point are the same
_NONE = -1  # instead of the number of an end
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

    They are kept by place, since thousands of lines may meet in one.
    ends: (2 n, 2) metres.  is_open: (n,) whether a line can be joined to others.
    """

    def __init__(self, ends: Floats, is_open: Bools) -> None:
        places, place_of = np.unique(ends, axis=0, return_inverse=True)
        self._tree, self._place_of = cKDTree(places), place_of.reshape(-1)
        self._free = np.repeat(is_open, 2)
        self._at = [deque[int]() for _ in places]
        for end, place in enumerate(self._place_of.tolist()):
            self._at[place].append(end)
        self._first = np.full(len(places), _NONE)
        for place in range(len(places)):
            self._look_at(place)

    def take(self, line: int) -> None:
        """Count both ends of a line as joined."""
        self._free[2 * line : 2 * line + 2] = False
        for place in self._place_of[2 * line : 2 * line + 2].tolist():
            self._look_at(place)

    def nearest(self, end: int, gap: float) -> int | None:
        """Return the free end that is nearest to an end, of several the first; None where none is within the gap."""
        places = self._tree.data
        here = places[self._place_of[end]]
        near = np.array(self._tree.query_ball_point(here, gap), dtype=np.int64)
        near = near[self._first[near] != _NONE]
        near = near[np.argsort(self._first[near])]
        return int(self._first[near[np.hypot(*(places[near] - here).T).argmin()]]) if len(near) else None

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
