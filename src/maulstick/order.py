"""The order of strokes: what is painted first, and so lies below."""

import numpy as np
from numpy.typing import NDArray

from maulstick.palette import lightness


def light_to_dark(colours: NDArray[np.float64]) -> NDArray[np.int64]:
    """Indices (N,) that sort strokes of colours (N, 3) from light to dark."""
    return np.argsort(-lightness(colours), kind="stable")


def by_paint(paint_of: NDArray[np.int64], before: NDArray[np.int64]) -> NDArray[np.int64]:
    """Indices (N,) that paint all strokes of a paint, (N,), in one go, keeping the order `before`, (N,), within it."""
    return before[np.argsort(paint_of[before], kind="stable")]
