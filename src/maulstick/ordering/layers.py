"""The order of strokes: what is painted first, and so lies below."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from maulstick.colour.palette import lightness
from maulstick.storage.arrays import Bools, Ints


def light_to_dark(colours: NDArray[np.float64]) -> Ints:
    """Indices (N,) that sort strokes of colours (N, 3) from light to dark."""
    return np.argsort(-lightness(colours), kind="stable")


def by_paint(paint_of: Ints, before: Ints) -> Ints:
    """Indices (N,) that paint all strokes of a paint, (N,), in one go, keeping the order `before`, (N,), within it."""
    return before[np.argsort(paint_of[before], kind="stable")]


def runs(paint_of: Ints, overlaps: Ints) -> list[Ints]:
    """Strokes in runs of one paint each: as few runs as can be found, and never more than there were.

    paint_of: (N,) the paint of each stroke, in painting order.  overlaps: (E, 2) strokes of different paints of which
    the first lies below the second, and stays there. Within a run any order will do.
    """
    changes = _changes_after(len(paint_of), overlaps)
    before = iter(paint_of[np.flatnonzero(np.diff(paint_of, prepend=-1))].tolist())

    def neediest(free: Bools, waiting: Bools) -> int:
        # A paint that can be finished is: it must be taken up once more anyway. Else one stroke counts as much as two
        # above which the paint must change once less often.
        needed = np.bincount(paint_of, free * np.exp2(changes - changes[free].max()))
        finishes = (needed > 0) & (np.bincount(paint_of, waiting, len(needed)) == 0)
        return int(np.argmax(np.where(finishes, np.inf, needed)))

    def as_before(free: Bools, waiting: Bools) -> int:
        return int(next(paint for paint in before if free[paint_of == paint].any()))

    return min((_scheduled(paint_of, overlaps, choose) for choose in (neediest, as_before)), key=len)


def _scheduled(paint_of: Ints, overlaps: Ints, choose: Callable[[Bools, Bools], int]) -> list[Ints]:
    """Each run takes all strokes of the chosen paint that are free: none that must lie below them is still to come."""
    below, above = overlaps.T
    beneath = np.bincount(above, minlength=len(paint_of))
    done = np.zeros(len(paint_of), dtype=np.bool_)
    found = []
    while not done.all():
        free = (beneath == 0) & ~done
        run = free & (paint_of == choose(free, ~free & ~done))
        beneath -= np.bincount(above[run[below]], minlength=len(paint_of))
        done |= run
        found.append(np.flatnonzero(run))
    return found


def _changes_after(count: int, overlaps: Ints) -> Ints:
    """(N,) how often at least the paint must change after each stroke, for what lies above it."""
    below, above = overlaps[np.argsort(overlaps[:, 0], kind="stable")].T
    starts = np.searchsorted(below, np.arange(count + 1))
    changes = np.zeros(count, dtype=np.int64)
    for stroke in range(count - 1, -1, -1):
        over = above[starts[stroke] : starts[stroke + 1]]
        changes[stroke] = 1 + changes[over].max() if len(over) else 0
    return changes
