"""Plane of the paper, from the heights at which the tip rests while it draws."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from maulstick.errors import InputError
from maulstick.storage.arrays import Floats

_STEADY = 0.01  # metres per second up or down: a faster tip does not draw
_BIN, _BLUR = 1e-4, 1e-3  # metres: bins of the histogram of heights, and its smoothing
_PROMINENT = 0.3  # least height of a peak of the histogram, relative to the highest one
_SCALES = (3e-3, 2e-3, 1.5e-3, 1e-3, 7e-4, 5e-4)  # metres: widths of the weights in the robust fit, one after another
_ROUNDS = 3  # of the fit with each of these widths
_NARROW = 2e-3  # metres: regularises the slope where the places lie closer together than that
_MOST = 50_000  # samples, for speed
_FARTHEST = 0.01  # metres between the paper and the plane of the markers: more is an error in the setup


@dataclass(frozen=True)
class SheetPlane:
    """Plane of the paper in the frame of the canvas, as height over the plane of the markers.

    level: metres, in the middle of the sheet.  slope: (2,), along x and y.  middle: (2,), of the sheet, metres.
    """

    level: float
    slope: Floats
    middle: Floats

    def heights_over(self, places: Floats, heights: Floats) -> Floats:
        """Heights (F,) over the paper, metres, of places (F, 2) with heights (F,) over the plane of the markers."""
        over: Floats = heights - self.level - (places - self.middle) @ self.slope
        return over


def find_paper(times: Floats, places: Floats, heights: Floats, size: tuple[float, float]) -> SheetPlane:
    """Fit the plane of the paper on a sheet of this size (width, height), metres.

    times: (F,), seconds.  places: (F, 2), of the tip, metres.  heights: (F,), over the plane of the markers, metres.

    The tip draws where it neither rises nor sinks, at the lowest height that is frequent. The paper is the plane
    through such places; the fit gives less and less weight to places off the plane, so that lifts do not count. The
    plane differs from that of the markers by the height of their centres and by the error of the pen's length.

    Raises InputError where the tip never rests near the sheet.
    """
    on_sheet = ((places >= 0) & (places <= size)).all(axis=1)
    if not on_sheet.any():
        raise InputError("the tip is never over the canvas; check the pen's length and axis, and the corner")
    steady = on_sheet & (np.abs(np.gradient(heights, times)) < _STEADY)
    chosen = np.flatnonzero(steady if steady.any() else on_sheet)
    chosen = chosen[:: max(1, len(chosen) // _MOST)]
    x, z = places[chosen] - np.array(size) / 2, heights[chosen]
    level = _lowest_mode(z)
    if abs(level) > _FARTHEST:
        raise InputError(
            f"the tip rests {level * 1e3:.1f} mm over the canvas; it must rest within {_FARTHEST * 1e3:g} mm of it: "
            "measure the pen's length again, from its rigid body to the tip, and check its axis"
        )
    slope = np.zeros(2)
    for scale in np.repeat(_SCALES, _ROUNDS):
        weights = np.exp(-(((z - level - x @ slope) / scale) ** 2) / 2) + 1e-300
        mean = np.average(x, axis=0, weights=weights)
        level_there = float(np.average(z, weights=weights))
        apart, rise = x - mean, z - level_there
        normal = (apart.T * weights) @ apart / weights.sum() + _NARROW**2 * np.eye(2)
        slope = np.linalg.solve(normal, (apart.T * weights) @ rise / weights.sum())
        level = level_there - float(mean @ slope)
    return SheetPlane(level, slope, np.array(size) / 2)


def _lowest_mode(heights: Floats) -> float:
    """Lowest peak of the histogram of heights (F,), metres."""
    least, most = float(heights.min()), float(np.percentile(heights, 99.0))
    edges = np.arange(least - 5 * _BLUR, min(most, least + 1.0) + 6 * _BLUR, _BIN)
    density = gaussian_filter1d(np.histogram(heights, edges)[0].astype(np.float64), _BLUR / _BIN)
    peaks = np.flatnonzero((density[1:-1] >= density[:-2]) & (density[1:-1] > density[2:])) + 1
    often = peaks[density[peaks] >= _PROMINENT * density.max()]
    return float(edges[often[0]] + _BIN / 2)
