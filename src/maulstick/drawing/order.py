"""Lines of one pen in a quick order, without those that are there twice, and joined where their ends meet."""

from collections import deque
from collections.abc import Iterable, Sequence

import numpy as np
from scipy.spatial import cKDTree

from maulstick.drawing.lines import SAME
from maulstick.ordering.tour import tour
from maulstick.storage.arrays import Bools, Floats

_ALIKE = 1e-5  # metres: lines that differ by less at each point are the same
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
    ends = np.array([line[[0, -1]] for line in lines]).reshape(-1, 2)  # of line i the rows 2 i and 2 i + 1
    tree, found = cKDTree(ends), list[Floats]()
    is_open = np.hypot(*(ends[1::2] - ends[::2]).T) > _ALIKE
    free, left = np.repeat(is_open, 2), np.ones(len(lines), dtype=np.bool_)
    for first, line in enumerate(lines):
        if not left[first]:
            continue
        parts = deque([line])
        free[2 * first : 2 * first + 2] = False
        for end in (2 * first + 1, 2 * first) if is_open[first] else ():
            at_last = bool(end % 2)
            while (near := _nearest(tree, end, free, gap)) is not None:
                row, end = near // 2, near ^ 1
                free[2 * row : 2 * row + 2] = left[row] = False
                forward = lines[row] if bool(near % 2) != at_last else lines[row][::-1]
                (parts.append if at_last else parts.appendleft)(forward)
        found.append(line if len(parts) == 1 else _in_one(parts))
    return found


def _nearest(tree: cKDTree, end: int, free: Bools, gap: float) -> int | None:
    """Return which of the ends in the tree that are free is nearest to one of them; None for none within the gap."""
    near = np.sort(tree.query_ball_point(tree.data[end], gap)).astype(np.int64)
    near = near[free[near]]
    return int(near[np.hypot(*(tree.data[near] - tree.data[end]).T).argmin()]) if len(near) else None


def _in_one(parts: Iterable[Floats]) -> Floats:
    """Return lines (k, 2) one after another as one, in which a point where two meet is there once."""
    points: Floats = np.concatenate(list(parts))
    goes_on: Bools = np.append(True, np.hypot(*np.diff(points, axis=0).T) > SAME)
    return points[goes_on]
