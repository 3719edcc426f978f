"""Strokes side by side in rows, like words on a page."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from maulstick.storage.arrays import Floats

_ROUNDS = 30
_LAST = 2.0  # gaps: how far apart strokes of the last row may be


class Row(NamedTuple):
    """Strokes side by side. strokes: their indices.  left: where each begins."""

    strokes: list[int]
    left: Floats


def rows_of(widths: Floats, wide: float, gap: float) -> list[Row]:
    """Strokes of these widths (N,), as many side by side as there is room for, the room that is left between them.

    wide: of a row.  gap: between two strokes at least.  All in pixels.
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
    """The largest scale up to `most` at which everything fits, which it does at every smaller one as well."""
    low, top = 0.0, most
    for _ in range(_ROUNDS):
        scale = (low + top) / 2
        low, top = (scale, top) if fits(scale) else (low, scale)
    return low
