"""Plot of ink: the sheet as it was drawn on."""

from collections.abc import Iterator, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection, LineCollection

from maulstick.plots.sheet import ACCENT, FOOT, INK, LINES, MARGIN, Plot
from maulstick.storage.arrays import Floats
from maulstick.strokes.ink import Ink
from maulstick.strokes.strokes import path_lengths, resample

_WIDTH = 0.4e-3  # metres: of a stroke without recorded pressure
_WIDTHS = 0.15e-3, 1.2e-3  # metres: at pressure 0 and at pressure 1
_THINNEST, _LEAST_DOT = 0.9, 2.2  # pixels: what is smaller would hardly be seen
_STEP = 1.5  # pixels along a stroke, after which its width may change
_WIDTH_STEP = 0.4  # pixels: smaller differences in width are not seen
_MOST_STARTS = 400  # strokes: of more, the red dots at their starts would hide the ink
_WIDEST, _NARROWEST = 3.0, 0.75  # width of a plot over its height, at most and at least


def ink_plot(ink: Ink, title: str, px: int) -> bytes:
    """Draw a PNG, `px` pixels high: all strokes on their sheet, as wide as their pressure where it was recorded."""
    high, margins = (1 - FOOT / LINES) * px, 2 * MARGIN / LINES * px
    width, height = ink.size
    scale = min(high / height, (_WIDEST * px - margins) / width)
    plot = Plot(max(width * scale + margins, _NARROWEST * px), px)
    x, y = (plot.width - width * scale) / 2, plot.margin + (high - height * scale) / 2
    axes = plot.paper(x, y, width * scale, height * scale, scale)
    thin = max(_WIDTH * scale, _THINNEST)
    segments, weights, dots, sizes = [], [], [], []
    for stroke in ink.strokes():
        pressed = not np.isnan(stroke[0, 3])
        if not np.ptp(stroke[:, 1:3], axis=0).any():
            dots.append(stroke[0, 1:3])
            sizes.append(max(_pixels(stroke[:, 3], scale).max() if pressed else thin, _LEAST_DOT))
        elif pressed:
            for width, run in _runs(stroke, scale):
                segments.append(run)
                weights.append(width)
        else:
            segments.append(stroke[:, 1:3])
            weights.append(thin)
    notes = []
    if 0 < len(ink) <= _MOST_STARTS:
        starts = [stroke[0, 1:3] for stroke in ink.strokes() if np.ptp(stroke[:, 1:3], axis=0).any()]
        _discs(axes, starts, np.full(len(starts), max(2 * thin, 0.28 * plot.line) / scale), ACCENT)
        notes.append("red where a stroke begins")
    points = [plot.points(weight) for weight in weights]
    axes.add_collection(LineCollection(segments, colors=INK, linewidths=points, capstyle="round"))
    _discs(axes, dots, np.array(sizes) / scale, INK)
    if off := sum(bool(((s[:, 1:3] < 0) | (s[:, 1:3] > ink.size)).any()) for s in ink.strokes()):
        notes.append(f"{off} of the strokes run off the sheet")
    plot.caption(title, ink.summary(), "; ".join(notes), scale)
    return plot.png()


def _pixels(pressure: Floats, scale: float) -> Floats:
    """Line width, pixels, at each pressure (n,)."""
    light, deep = _WIDTHS
    return np.maximum(scale * (light + (deep - light) * pressure), _THINNEST)


def _runs(stroke: Floats, scale: float) -> Iterator[tuple[float, Floats]]:
    """Cut a stroke with pressure into polylines (k, 2), each of one width, pixels; steps of width stay invisible."""
    length = float(path_lengths(stroke[:, 1:3]))
    path = resample(stroke[:, 1:4], 2 + min(int(length * scale / _STEP), 8 * len(stroke)))
    widths = _pixels((path[:-1, 2] + path[1:, 2]) / 2, scale)
    steps = np.round((widths - _THINNEST) / _WIDTH_STEP)
    ends = [*np.flatnonzero(np.diff(steps)) + 1, len(steps)]
    for start, end in zip([0, *ends[:-1]], ends, strict=True):
        yield float(widths[start:end].mean()), path[start : end + 1, :2]


def _discs(axes: Axes, places: Sequence[Floats], diameters: Floats, colour: str) -> None:
    discs = EllipseCollection(
        diameters,
        diameters,
        np.zeros(len(places)),
        units="xy",
        offsets=np.array(places).reshape(-1, 2),
        offset_transform=axes.transData,
        facecolors=colour,
        linewidths=0,
    )
    axes.add_collection(discs)
