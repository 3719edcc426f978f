"""Line drawings of pictures: the lines that carry a picture, one pen wide.

A flow-based difference of Gaussians (Kang, Lee and Chui 2007), whose flow is that of the smoothed structure tensor
(Kyprianidis and Döllner 2008): across the flow a difference of Gaussians finds what is darker than around it, along the
flow it is averaged, so that lines hang together. What is left of a line is its middle, as wide as the pen.
"""

import numpy as np
from scipy.ndimage import gaussian_filter, grey_dilation, map_coordinates
from skimage.color import rgb2gray
from skimage.transform import resize

from maulstick.painting.brush import Brush
from maulstick.painting.painting import Sheet
from maulstick.planning.layout import Layout, pixel_size
from maulstick.planning.placement import edges
from maulstick.storage.arrays import Bools, Floats, Image

_LONGEST_PX = 1024  # lines are found at this size at most: finer ones are no picture's, and take minutes
_SCALE = 1 / 320  # of the picture's height: standard deviation of the narrower Gaussian
_WIDER = 1.6  # times as wide is the other Gaussian: near to a Laplacian (Marr and Hildreth 1980)
_SURROUND = 0.99  # weight of the wider Gaussian: a flat grey makes no line
_FLOW = 3.0  # standard deviation along a line, over that across it
_NEARLY = 1.05  # as much darker counts as the middle: a line of two pixels has two, which rounding would tell apart
_STEEP = 80.0  # a difference of 1/80 makes a line three quarters dark


def lines_for(
    picture: Image, sheet: Sheet, brush: Brush, fit: str, margin: float = 0.0, *, light: bool = False
) -> Image:
    """Return the lines of a picture (H, W, 3), as wide as the brush's thinnest on that sheet, black on white.

    light: as in `lines_on`; they are white on black then.
    """
    pen = 2 * brush.finest / (picture.shape[0] * pixel_size(picture, sheet, fit, margin))
    return 1 - line_drawing(1 - picture, pen) if light else line_drawing(picture, pen)


def lines_on(layout: Layout, brush: Brush, *, light: bool = False) -> Image:
    """Return how dark the lines of a layout's picture are, (H, W), 0 where there is none.

    light: whether lines are what is lighter than around, for an ink that is lighter than its paper.
    """
    dark = np.zeros(layout.under.shape[:2], dtype=np.float32)
    if layout.target is not None:
        picture, part = layout.crop(layout.target), layout.crop(dark)
        pen = 2 * brush.finest * layout.canvas.pixels_per_metre / picture.shape[0]
        lines = line_drawing(1 - picture if light else picture, pen)
        part[:] = resize(1 - lines[..., 0], part.shape, anti_aliasing=True)
    return dark


def line_drawing(picture: Image, pen: float) -> Image:
    """Return the lines of a picture (H, W, 3) in [0, 1], black on white, at most 1,024 pixels wide or high.

    pen: width of the lines over the picture's height; they are at least a pixel wide.
    """
    shrunk = min(1.0, _LONGEST_PX / max(picture.shape[:2]))
    size = [max(2, round(shrunk * side)) for side in picture.shape[:2]]
    grey: Floats = resize(rgb2gray(picture), size, anti_aliasing=True).astype(np.float64)
    sigma = max(_SCALE * size[0], 0.5)
    along = _flow(grey, sigma)
    found = _averaged_along(_difference(grey, along, sigma), along, _FLOW * sigma)
    dark = np.tanh(_STEEP * np.maximum(-_middles(found, along), 0))
    radius = max(pen * size[0] / 2, 0.5)
    lines = grey_dilation(dark, footprint=_disc(radius))
    return np.repeat((1 - lines)[..., None], 3, axis=2).astype(np.float32)


def _flow(grey: Floats, sigma: float) -> Floats:
    """Return the direction along edges, (2, H, W): x and y of length 1."""
    angle, _ = edges(gaussian_filter(grey, sigma)[None], 2 * sigma)
    return np.stack([np.cos(angle), np.sin(angle)])


def _difference(grey: Floats, along: Floats, sigma: float) -> Floats:
    """Return the difference of two Gaussians across the flow, below 0 where it is darker than around."""
    steps = np.arange(-int(3 * _WIDER * sigma) - 1, int(3 * _WIDER * sigma) + 2)
    narrow, wide = (np.exp(-(steps**2) / (2 * s**2)) for s in (sigma, _WIDER * sigma))
    taps = narrow / narrow.sum() - _SURROUND * wide / wide.sum()
    row, column = np.indices(grey.shape).astype(np.float64)
    across = -along[1], along[0]
    found = np.zeros(grey.shape)
    for t, tap in zip(steps, taps, strict=True):
        found += tap * _at(grey, row + t * across[1], column + t * across[0])
    return found


def _averaged_along(values: Floats, along: Floats, sigma: float) -> Floats:
    """Return the values averaged along the flow, by a Gaussian of this standard deviation in pixels."""
    total, weights = values.copy(), 1.0
    for way in (1, -1):
        row, column = np.indices(values.shape).astype(np.float64)
        x, y = way * along
        for step in range(1, int(2 * sigma) + 2):
            row, column = row + y, column + x
            weight = float(np.exp(-(step**2) / (2 * sigma**2)))
            total += weight * _at(values, row, column)
            weights += weight
            next_x, next_y = _nearest_to(along, row, column)
            on = np.where(next_x * x + next_y * y < 0, -1, 1)  # a flow has no sign: go on, never back
            x, y = on * next_x, on * next_y
    averaged: Floats = total / weights
    return averaged


def _middles(values: Floats, along: Floats) -> Floats:
    """Return the values where they are least across the flow, else 0."""
    row, column = np.indices(values.shape).astype(np.float64)
    beside = [_at(values, row + side * along[0], column - side * along[1]) for side in (-1, 1)]
    return np.where(_NEARLY * values <= np.minimum(*beside), values, 0.0)


def _at(values: Floats, row: Floats, column: Floats) -> Floats:
    """Return values (H, W) between pixels; beyond the edges, those there."""
    found: Floats = map_coordinates(values, np.stack([row, column]), order=1, mode="nearest")
    return found


def _nearest_to(values: Floats, row: Floats, column: Floats) -> Floats:
    """Return values (C, H, W) of the nearest pixels, (C, ...)."""
    rows, columns = (
        np.floor(each.clip(0, most - 1) + 0.5).astype(np.int64)
        for each, most in zip((row, column), values.shape[1:], strict=True)
    )
    return values[:, rows, columns]


def _disc(radius: float) -> Bools:
    away = np.arange(-int(radius), int(radius) + 1)
    inside: Bools = np.hypot(away[:, None], away) <= radius
    return inside
