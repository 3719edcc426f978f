"""Colour correction from a chart of 24 patches, or from a grey card, laid on the sheet."""

from dataclasses import dataclass

import numpy as np
from skimage.color import deltaE_ciede2000, rgb2lab

from maulstick.calibration.colour import Colours, Whites
from maulstick.colour.srgb import colours_of, light_of
from maulstick.errors import InputError
from maulstick.painting.raster import Canvas
from maulstick.robot.camera.opencv import opencv
from maulstick.storage.arrays import Floats, Image

# The usual sRGB of the 24 patches, rows from dark skin to bluish green and on to black (the maker's data sheet).
_CHART = "735244c29682627a9d576c438580b167bdaad67e2c505ba6c15a635e3c6c9dbc40e0a32e383d96469449af363ce7c71fbb56950885a1"
_GREYS = "f3f3f2c8c8c8a0a0a07a7a79555555343434"
CHART = np.frombuffer(bytes.fromhex(_CHART + _GREYS), dtype=np.uint8).reshape(24, 3) / 255.0
"""Colours (24, 3) of the chart, sRGB in [0, 1], row by row."""

GREY_CARD = 0.4614
"""Grey of a card that reflects 18 % of the light, sRGB in [0, 1]."""

_ACROSS, _DOWN = 6, 4  # patches of the chart
_INNER = 0.4  # side of the part of a patch that is read, in distances between patches: it avoids the borders
_MISREAD = 12.0  # mean CIEDE2000 after correction above which these are not the chart's patches
_FEWEST = 4  # pixels in the part of a patch that is read
_NOT_SEEN = "the chart is too small or reaches beyond the sheet; lay all of it on the sheet"
_DARKEST = 1e-3  # least light, so that no division is by zero
_UNEVEN = 1.5  # times that the bright tenth of a grey card may be as light as its dark tenth: gloss, never an edge
_BARE = 0.05  # share of its light by which bare paper differs from itself: exposure is corrected to 1 %


@dataclass(frozen=True)
class ColourErrors:
    """Errors of colour over the chart: mean and worst CIEDE2000, as photographed and as corrected."""

    before: tuple[float, float]
    after: tuple[float, float]

    def __str__(self) -> str:
        (before, worst_before), (after, worst_after) = self.before, self.after
        return f"CIEDE2000 {before:.1f} (worst {worst_before:.1f}) before, {after:.1f} (worst {worst_after:.1f}) after"


def with_chart(
    colours: Colours, flat: Image, whites: Whites, canvas: Canvas, corners: Floats
) -> tuple[Colours, ColourErrors]:
    """Return the colours with the matrix that corrects the chart's patches, and the errors that remain.

    flat: flat photograph of the canvas (H, W, 3) with the chart on it.  whites: of the same photograph.
    corners: (4, 2) metres: the middles of the patches dark skin, bluish green, black and white. They are asked for, as
    OpenCV's detector finds a chart one time and not the next in the same picture.
    Raises InputError where the patches there are not those of the chart.
    """
    patches = _patches_between(np.asarray(corners, dtype=np.float64), canvas)
    light = _medians(colours.evened(flat, whites), patches)
    matrix = np.linalg.lstsq(light, light_of(CHART.astype(np.float32)).astype(np.float64), rcond=None)[0].T
    errors = ColourErrors(_error(_medians(light_of(flat), patches)), _error(light @ matrix.T))
    if errors.after[0] > _MISREAD:
        raise InputError(
            "what lies there is not the chart; give the middles of its patches dark skin, bluish green, black, white"
        )
    return colours.with_matrix(np.asarray(matrix, dtype=np.float64)), errors


def with_grey_card(
    colours: Colours,
    flat: Image,
    whites: Whites,
    canvas: Canvas,
    area: tuple[float, float, float, float],
    grey: float = GREY_CARD,
) -> Colours:
    """Return the colours with a matrix that makes a grey card as grey and as bright as it really is.

    flat: flat photograph of the canvas (H, W, 3) with the card on it.  whites: of the same photograph.
    area: x, y, width and height of a part of the card, metres.  grey: its sRGB in [0, 1].
    Raises InputError where the area is not on the sheet, and where what lies there is uneven, or the bare sheet.
    """
    x, y, width, height = area
    left, top, right, bottom = (round(edge * canvas.pixels_per_metre) for edge in (x, y, x + width, y + height))
    if not (0 <= left < right <= flat.shape[1] and 0 <= top < bottom <= flat.shape[0]):
        raise InputError("the grey card must lie on the sheet; give x, y, width and height of a part of it")
    card = colours.evened(flat, whites)[top:bottom, left:right].reshape(-1, 3)
    light = np.median(card, axis=0)
    dark, bright = np.quantile(card.mean(axis=1), (0.1, 0.9))
    is_bare = np.allclose(light, colours.paper_light, rtol=_BARE, atol=0)
    if bright > _UNEVEN * max(dark, _DARKEST) or is_bare:
        raise InputError(
            "no grey card is seen where it should lie; lay it over the middle of the sheet, and photograph it again"
        )
    wanted = light_of(np.full(3, grey, dtype=np.float32))
    return colours.with_matrix(np.diag(wanted.astype(np.float64) / np.maximum(light, _DARKEST)))


def _patches_between(corners: Floats, canvas: Canvas) -> Floats:
    """Return the corners (24, 4, 2) of the inner part of each patch, pixels.

    corners: (4, 2) metres, the middles of the corner ones. Raises InputError where they are not four on the canvas.
    """
    if corners.shape != (4, 2) or not np.isfinite(corners).all():
        raise InputError("the chart's corners must be four points: dark skin, bluish green, black and white")
    if not ((corners >= 0) & (corners <= (canvas.width, canvas.height))).all():
        raise InputError(_NOT_SEEN)
    corners = corners * canvas.pixels_per_metre - 0.5
    grid = np.array([[0, 0], [_ACROSS - 1, 0], [_ACROSS - 1, _DOWN - 1], [0, _DOWN - 1]], dtype=np.float32)
    to_picture = opencv().getPerspectiveTransform(grid, corners.astype(np.float32))
    middles = np.stack(np.meshgrid(np.arange(_ACROSS), np.arange(_DOWN)), axis=-1).reshape(-1, 1, 2)
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / 2
    mapped = np.append(middles + square * _INNER, np.ones((24, 4, 1)), axis=-1) @ np.asarray(to_picture).T
    with np.errstate(divide="ignore", invalid="ignore"):  # of corners in no order of a chart's
        return np.asarray(mapped[..., :2] / mapped[..., 2:])


def _medians(light: Image, patches: Floats) -> Floats:
    """Return the median light (24, 3) over each of the patches (24, 4, 2), pixels."""
    cv2 = opencv()
    medians = []
    if not (np.abs(patches) < 2 * max(light.shape)).all():  # which may be infinitely far
        raise InputError(_NOT_SEEN)
    for patch in patches:
        mask = np.zeros(light.shape[:2], dtype=np.uint8)
        cv2.fillConvexPoly(mask, np.round(patch).astype(np.int32), 1)
        if mask.sum() < _FEWEST:
            raise InputError(_NOT_SEEN)
        medians.append(np.median(light[mask > 0], axis=0))
    return np.array(medians, dtype=np.float64)


def _error(light: Floats) -> tuple[float, float]:
    """Return the mean and worst CIEDE2000 between the light of patches (24, 3) and the chart."""
    seen = colours_of(light.astype(np.float32)).astype(np.float64)
    apart = deltaE_ciede2000(rgb2lab(seen[None]), rgb2lab(CHART[None]))
    return float(apart.mean()), float(apart.max())
