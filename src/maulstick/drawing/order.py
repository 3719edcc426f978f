"""Lines of one pen in a quick order, and without those that are there twice."""

from collections.abc import Sequence

import numpy as np

from maulstick.ordering.tour import tour
from maulstick.storage.arrays import Floats

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
