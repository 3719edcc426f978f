"""The plot by which a person sets the threshold: the tip's height over time, and what was taken for touching."""

import io
from math import ceil

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from maulstick.ink import Floats
from maulstick.recording.contact import Frames
from maulstick.recording.drawing import Drawing

_ROW_SECONDS = (2.0, 5.0, 10.0, 15.0, 20.0, 30.0)
_FEW_ROWS, _MOST_ROWS = 6, 130
_WIDTH, _LEFT, _RIGHT, _CROWD = 14.0, 0.7, 0.2, 1.2  # inches, as are the next two lines
_TOP, _BOTTOM, _GAP = 0.7, 0.5, 0.3
_HIGH, _LOW = 1.2, 0.6  # rows: when they are few, and when they are many
_DPI = 110
_COLUMNS = 1300  # of pixels in a row, about
_BINS, _CROWDED = 150, 2.7  # the latter in inches
_INK, _TOUCH, _MERGED, _DROPPED, _BESIDE = "#22303c", "#b4e0d7", "#f5c669", "#ec93a6", "#d9d4ca"
_LINE = "#c2410c"


def contact_plot(drawing: Drawing) -> bytes:
    """A PNG of the height in millimetres over time, and of how often each height was had.

    Time runs in rows, so that a second stays wide enough to see a stroke; what is far above the paper is cut off.
    """
    contact, seconds = drawing.contact, max(float(drawing.times[-1]), 1.0)
    top = max(3.0, 4 * contact.release * 1e3)
    rows, each = rows_of(seconds)
    row = _HIGH if rows <= _FEW_ROWS else _LOW
    height = _TOP + rows * (row + _GAP) - _GAP + _BOTTOM
    figure = Figure(figsize=(_WIDTH, height), dpi=_DPI)

    def axes_at(left: float, down: float, wide: float, high: float) -> Axes:
        return figure.add_axes((left / _WIDTH, 1 - (down + high) / height, wide / _WIDTH, high / height))

    wide = _WIDTH - _LEFT - 3 * _RIGHT - _CROWD - _LEFT / 2
    for number in range(rows):
        axes = axes_at(_LEFT, _TOP + number * (row + _GAP), wide, row)
        _draw_row(axes, drawing, number * each, (number + 1) * each)
        _finish(axes, drawing, top)
    axes.set_xlabel("seconds")
    crowd = axes_at(_WIDTH - _RIGHT - _CROWD, _TOP, _CROWD, min(_CROWDED, height - _TOP - _BOTTOM))
    _draw_crowd(crowd, drawing.heights * 1e3, top)
    _finish(crowd, drawing, top)
    parts = [
        ("strokes", len(drawing.ink), _TOUCH),
        ("merged lifts", len(contact.merged), _MERGED),
        ("dropped touches", len(contact.dropped), _DROPPED),
        ("beside the canvas", len(drawing.beside), _BESIDE),
    ]
    patches = [Patch(color=colour, label=f"{label}: {number}") for label, number, colour in parts]
    corner = _LEFT / _WIDTH, 1 - _TOP / height
    figure.legend(handles=patches, loc="lower left", bbox_to_anchor=corner, ncols=len(parts), frameon=False)
    lines = f"threshold {contact.threshold * 1e3:.2f} mm, release {contact.release * 1e3:.2f} mm (dashed)"
    figure.text(_LEFT / _WIDTH, 1 - 0.1 / height, f"height of the tip over the paper, in mm; {lines}", va="top")
    file = io.BytesIO()
    FigureCanvasAgg(figure)
    figure.savefig(file, format="png")
    return file.getvalue()


def rows_of(seconds: float) -> tuple[int, float]:
    """Into how many rows so long a take is cut, and the seconds of each."""
    each = next((each for each in _ROW_SECONDS if seconds <= each * _FEW_ROWS), _ROW_SECONDS[-1])
    each *= ceil(seconds / each / _MOST_ROWS)
    return ceil(seconds / each), each


def _draw_row(axes: Axes, drawing: Drawing, start: float, stop: float) -> None:
    first, last = np.searchsorted(drawing.times, (start, stop), side="right")
    first = max(0, int(first) - 1)
    for parts, colour in (
        (drawing.contact.touches, _TOUCH),
        (drawing.contact.merged, _MERGED),
        (drawing.contact.dropped, _DROPPED),
        (drawing.beside, _BESIDE),
    ):
        _draw_parts(axes, drawing.times, parts[(parts[:, 1] > first) & (parts[:, 0] < last)], colour)
    times, heights = _outline(drawing.times[first : last + 1], drawing.heights[first : last + 1] * 1e3)
    axes.plot(times, heights, color=_INK, linewidth=0.7)
    axes.set_xlim(start, stop)


def _draw_parts(axes: Axes, times: Floats, parts: Frames, colour: str) -> None:
    starts, ends = times[parts[:, 0]], times[np.minimum(parts[:, 1], len(times) - 1)]
    spans = list(zip(starts.tolist(), (ends - starts).tolist(), strict=True))
    axes.broken_barh(spans, (0, 1), transform=axes.get_xaxis_transform(), color=colour, linewidth=0.5)


def _outline(times: Floats, heights: Floats) -> tuple[Floats, Floats]:
    """The line itself, or where it has many samples a pixel its lowest and highest there, one after the other."""
    many = len(times) // _COLUMNS
    if many < 3:
        return times, heights
    starts = np.arange(0, len(times), many)
    ends = np.stack([np.fmin.reduceat(heights, starts), np.fmax.reduceat(heights, starts)], axis=1)
    return np.repeat(times[starts], 2), ends.ravel()


def _draw_crowd(axes: Axes, heights: Floats, top: float) -> None:
    edges = np.linspace(-top / 4, top, _BINS)
    counts = np.histogram(heights, edges)[0]
    axes.stairs(counts + 0.5, edges, orientation="horizontal", fill=True, color=_INK)
    axes.set_xscale("log")
    axes.set_xticks([])
    axes.set_xlabel("how often (log)")


def _finish(axes: Axes, drawing: Drawing, top: float) -> None:
    axes.axhline(0, color=_INK, linewidth=0.3)
    axes.axhline(drawing.contact.threshold * 1e3, color=_LINE, linewidth=0.9)
    axes.axhline(drawing.contact.release * 1e3, color=_LINE, linewidth=0.9, linestyle=(0, (4, 3)))
    axes.set_ylim(-top / 4, top)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize="small")
