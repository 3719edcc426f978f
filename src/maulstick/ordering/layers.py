"""Layers of strokes: the order in which paints are used, as strokes that are painted first lie below."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from maulstick.colour.palette import lightness
from maulstick.storage.arrays import Bools, Floats, Ints

_Choose = Callable[[Bools, Bools], int]
"""Choice of the next paint: takes which strokes are free, and which wait for others, (N,) each."""


def light_to_dark(colours: Floats, brush_of: Ints) -> Ints:
    """Return indices (N,) that sort strokes by their brush (N,), and those of each brush from light to dark.

    colours: (N, 3), sRGB in [0, 1].
    """
    return np.lexsort((-lightness(colours), brush_of))


def by_paint(paint_of: Ints, brush_of: Ints, before: Ints) -> Ints:
    """Return indices (N,) that group strokes by their brush (N,), then by their paint (N,).

    Within each paint they are in the order `before`, (N,).
    """
    return before[np.lexsort((paint_of[before], brush_of[before]))]


def runs(paint_of: Ints, brushes: Ints, overlaps: Ints) -> list[Ints]:
    """Return strokes as runs of one paint each: first as few changes of brush as can be found, then as few runs.

    Neither is ever more than before, but for a change of paint that saves one of brush.
    paint_of: (N,) the paint of each stroke, in painting order.  brushes: (k,) the brush of each paint.
    overlaps: (E, 2) strokes of different paints of which the first lies below the second, and stays there. Within a
    run any order will do.
    """
    changes = _changes_after(len(paint_of), overlaps)

    def neediest(free: Bools, waiting: Bools) -> int:
        # A paint that can be finished comes first: it must be taken up once more anyway. Otherwise a stroke counts
        # twice as much for each further change of paint that must follow it.
        needed = np.bincount(paint_of, free * np.exp2(changes - changes[free].max()))
        finishes = (needed > 0) & (np.bincount(paint_of, waiting, len(needed)) == 0)
        return int(np.argmax(np.where(finishes, np.inf, needed)))

    def as_before() -> _Choose:
        left = paint_of[np.flatnonzero(np.diff(paint_of, prepend=-1))].tolist()

        def choose(free: Bools, waiting: Bools) -> int:
            paint = next((paint for paint in left if free[paint_of == paint].any()), int(paint_of[free][0]))
            if paint in left:
                left.remove(paint)
            return int(paint)

        return choose

    ways = [neediest, as_before()]
    if len(np.unique(brushes[paint_of])) > 1:
        ways += [_staying(choose, brushes[paint_of], brushes) for choose in (neediest, as_before())]
    return min(
        (_scheduled(paint_of, overlaps, way) for way in ways), key=lambda found: _price(found, paint_of, brushes)
    )


def _staying(choose: _Choose, brush_of: Ints, brushes: Ints) -> _Choose:
    """Return a choice that keeps to the brush in hand as long as that can go on."""
    held = -1

    def stay(free: Bools, waiting: Bools) -> int:
        nonlocal held
        same = free & (brush_of == held)
        paint = choose(same if same.any() else free, waiting)
        held = int(brushes[paint])
        return paint

    return stay


def _price(found: list[Ints], paint_of: Ints, brushes: Ints) -> tuple[int, int]:
    """Return how often the brush changes, and the paint."""
    held = [int(brushes[paint_of[run[0]]]) for run in found]
    return sum(one != other for one, other in pairwise(held)), len(found)


def _scheduled(paint_of: Ints, overlaps: Ints, choose: _Choose) -> list[Ints]:
    """Return runs; each takes all strokes of the chosen paint that are free: all that must lie below are painted."""
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
    """Return the least number (N,) of changes of paint after each stroke, for the strokes that lie above it."""
    below, above = overlaps[np.argsort(overlaps[:, 0], kind="stable")].T
    starts = np.searchsorted(below, np.arange(count + 1))
    changes = np.zeros(count, dtype=np.int64)
    for stroke in range(count - 1, -1, -1):
        over = above[starts[stroke] : starts[stroke + 1]]
        changes[stroke] = 1 + changes[over].max() if len(over) else 0
    return changes
