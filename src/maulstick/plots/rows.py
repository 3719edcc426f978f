"""Layout of strokes side by side in rows, like words on a page."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from maulstick.storage.arrays import Floats

_ROUNDS = 30  # of halving: the scale is then exact to 1e-9 of the greatest one
_LAST = 2.0  # gaps: how far apart strokes of the last row may be


class Row(NamedTuple):
    """Row of strokes. strokes: their indices.  left: left edge of each, pixels."""

    strokes: list[int]
    left: Floats


def rows_of(widths: Floats, wide: float, gap: float) -> list[Row]:
    """Lay strokes of these widths (N,) in rows, as many per row as fit, with the free room between them.

    wide: width of a row.  gap: least distance between two strokes.  All in pixels.
    """
    filled: list[list[int]] = []
    used = np.inf
    for index, width in enumerate(widths):
        if used + gap + width > wide:
            filled.append([])
            used = -gap
        filled[-1].append(index)
        used += gap + width
    rows = []
    for number, row in enumerate(filled):
        spread = (wide - widths[row].sum()) / max(len(row) - 1, 1)
        space = min(spread, _LAST * gap) if number + 1 == len(filled) else spread
        rows.append(Row(row, np.cumsum(widths[row] + space) - widths[row] - space))
    return rows


def largest_scale(fits: Callable[[float], bool], most: float) -> float:
    """Find the largest scale up to `most` for which `fits` is true. fits: must be true for all smaller scales too."""
    low, top = 0.0, most
    for _ in range(_ROUNDS):
        scale = (low + top) / 2
        low, top = (scale, top) if fits(scale) else (low, scale)
    return low
