"""Fit of a picture to a sheet of another shape: the picture's place on the canvas."""

from typing import Final

import numpy as np

from maulstick.errors import InputError
from maulstick.painting.picture import scaled
from maulstick.painting.raster import Canvas
from maulstick.storage.arrays import Pixels

FITS: Final = ("contain", "cover")
"""Ways to place a picture on a canvas of another shape, see `lay_out`."""


def lay_out(
    picture: Pixels, canvas: Canvas, fit: str, under: Pixels | None = None, margin: float = 0.0
) -> tuple[Pixels, tuple[float, float, float, float]]:
    """Return the picture (H, W, 3) on the canvas, (height_px, width_px, 3), and its area (x, y, width, height).

    The area is in metres and ends at whole pixels, or at the sheet's edge; with a margin it lies in the sheet's middle,
    less than a pixel from those that show it. `fit` is ``contain`` (the whole picture in
    the middle of the sheet) or ``cover`` (the whole sheet; the picture is cropped evenly on two sides).
    under: the sheet before painting, (height_px, width_px, 3), visible around the picture; white by default.
    margin: metres at each edge of the sheet that count as none of it.
    Raises InputError for another `fit`.
    """
    if fit not in FITS:
        raise InputError.of_choice("fit", fit, FITS)
    height, width = picture.shape[:2]
    if fit == "cover":
        left_px, top_px, right_px, bottom_px = frame_of(canvas, margin)
        across, down = (right_px - left_px) / width, (bottom_px - top_px) / height
        kept = ((right_px - left_px) / max(across, down), (bottom_px - top_px) / max(across, down))
        left, top = (width - kept[0]) / 2, (height - kept[1]) / 2
        box = (max(left, 0.0), max(top, 0.0), min(left + kept[0], width), min(top + kept[1], height))
    else:
        edges = place_of(picture.shape[:2], canvas, fit, margin)
        left_px, top_px, right_px, bottom_px = (int(edge) for edge in edges)
        box = (0.0, 0.0, float(width), float(height))
    target = np.ones((canvas.height_px, canvas.width_px, 3), dtype=np.float32) if under is None else under.copy()
    target[top_px:bottom_px, left_px:right_px] = scaled(picture, (right_px - left_px, bottom_px - top_px), box)
    return target, area_of(picture.shape[:2], canvas, fit, margin)


def area_of(shape: tuple[int, ...], canvas: Canvas, fit: str, margin: float = 0.0) -> tuple[float, float, float, float]:
    """Return the area (x, y, width, height) of a picture of this shape (h, w) on the canvas, as `lay_out` does."""
    inner = canvas.inset(margin)
    if fit == "cover":
        return margin, margin, inner.width, inner.height
    corner = frame_of(canvas, margin)[:2] * 2
    edges = zip(place_of(shape, canvas, fit, margin), corner, strict=True)
    x, y, right, bottom = ((edge - first) / canvas.pixels_per_metre for edge, first in edges)
    wide, high = min(right, inner.width) - x, min(bottom, inner.height) - y
    if margin:  # what stays bare is alike on both sides, where whole pixels are not
        x, y = (inner.width - wide) / 2, (inner.height - high) / 2
    return margin + x, margin + y, wide, high


def place_of(
    shape: tuple[int, ...], canvas: Canvas, fit: str, margin: float = 0.0
) -> tuple[float, float, float, float]:
    """Left, top, right, bottom edge on the canvas of a picture of this shape (h, w), pixels; whole for ``contain``."""
    height, width = shape
    frame = frame_of(canvas, margin)
    free = frame[2] - frame[0], frame[3] - frame[1]
    across, down = free[0] / width, free[1] / height
    if fit == "cover":
        columns, rows = width * max(across, down), height * max(across, down)
        left, top = (free[0] - columns) / 2, (free[1] - rows) / 2
    else:
        columns, rows = max(1, round(width * min(across, down))), max(1, round(height * min(across, down)))
        left, top = (free[0] - columns) // 2, (free[1] - rows) // 2
    return frame[0] + left, frame[1] + top, frame[0] + left + columns, frame[1] + top + rows


def frame_of(canvas: Canvas, margin: float) -> tuple[int, int, int, int]:
    """Return the left, top, right and lower edge of what a margin, metres, leaves of the canvas, whole pixels."""
    inner, corner = canvas.inset(margin), round(margin * canvas.pixels_per_metre)
    right, bottom = min(corner + inner.width_px, canvas.width_px), min(corner + inner.height_px, canvas.height_px)
    return corner, corner, right, bottom
