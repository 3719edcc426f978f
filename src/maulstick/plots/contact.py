"""Plot of the pen's height over time, with what was taken for touching: a person sets the threshold by it."""

from math import ceil

import numpy as np
from matplotlib.axes import Axes

from maulstick.plots.sheet import ACCENT, FAINT, INK, QUIET, Plot, round_length
from maulstick.recording.mocap.contact import Frames
from maulstick.recording.mocap.drawing import TakeInk
from maulstick.storage.arrays import Floats

_ROW_SECONDS = (2.0, 5.0, 10.0, 15.0, 20.0, 30.0)  # lengths of a row to choose from
_FEW_ROWS, _MOST_ROWS = 6, 130  # up to which number rows are tall; and most rows, beyond which each takes longer
_TICKS = 5  # steps of time per row
_WIDTH, _LINE = 1600, 16  # pixels: of the plot, and of a line of text
_LEFT, _TOP, _BETWEEN = 4.5, 6.0, 2.2  # lines: beside the rows, above them, and between two
_HIGH, _LOW = 8.0, 4.0  # lines: height of a row where they are few, and where they are many
_HISTOGRAM_WIDE, _HISTOGRAM_HIGH = 9.0, 18.0  # lines: width, and greatest height
_BINS = 150  # of the histogram, over the heights that are shown
_TOUCH, _MERGED, _DROPPED, _OUTSIDE = "#b4e0d7", "#f5c669", "#ec93a6", "#d9d4ca"


def contact_plot(drawing: TakeInk) -> bytes:
    """Draw a PNG of the height in millimetres over time, with a histogram of the heights.

    Time runs in rows, so that a stroke stays wide enough to be seen; heights far above the paper are cut off.
    """
    contact = drawing.contact
    top = max(3.0, 4 * contact.release * 1e3)
    rows, each = rows_of(max(float(drawing.times[-1]), 1.0))
    high = _HIGH if rows <= _FEW_ROWS else _LOW
    lines = _TOP + rows * (high + _BETWEEN) + 2
    plot = Plot(_WIDTH, ceil(lines * _LINE), lines)
    line, margin = plot.line, plot.margin
    histogram = plot.width - margin - _HISTOGRAM_WIDE * line
    left, wide = margin + _LEFT * line, histogram - margin - (margin + _LEFT * line)
    thresholds = f"threshold {contact.threshold * 1e3:.2f} mm, release {contact.release * 1e3:.2f} mm (dashed)"
    plot.text(margin, margin + line, f"Height of the tip over the paper, in mm; {thresholds}", INK, 1.2)
    _legend(plot, drawing, left, (_TOP - 1.2) * line, wide)
    for number in range(rows):
        y = (_TOP + number * (high + _BETWEEN)) * line
        axes = plot.paper(left, y, wide, high * line, 1.0)
        _draw_row(plot, axes, drawing, number * each, (number + 1) * each, wide)
        _finish(plot, axes, drawing, top)
        for share in np.linspace(0, 1, _TICKS + 1).tolist():
            plot.text(left + share * wide, y + (high + 1.2) * line, f"{(number + share) * each:g} s", ha="center")
        for height in (0.0, round_length(top)):
            down = high * line * (top - height) / (1.25 * top)
            plot.text(left - 0.6 * line, y + down + 0.3 * line, f"{height:g}", ha="right", size=0.9)
    tall = min(_HISTOGRAM_HIGH, rows * (high + _BETWEEN) - _BETWEEN)
    axes = plot.paper(histogram, _TOP * line, _HISTOGRAM_WIDE * line, tall * line, 1.0)
    _draw_histogram(axes, drawing.heights * 1e3, top)
    _finish(plot, axes, drawing, top)
    plot.text(histogram, (_TOP + tall + 1.2) * line, "how often (log)")
    return plot.png()


def rows_of(seconds: float) -> tuple[int, float]:
    """Number of rows into which a take of this length, seconds, is cut, and the seconds per row."""
    each = next((each for each in _ROW_SECONDS if seconds <= each * _FEW_ROWS), _ROW_SECONDS[-1])
    each *= ceil(seconds / each / _MOST_ROWS)
    return ceil(seconds / each), each


def _legend(plot: Plot, drawing: TakeInk, x: float, y: float, wide: float) -> None:
    parts = [
        ("strokes", len(drawing.ink), _TOUCH),
        ("merged lifts", len(drawing.contact.merged), _MERGED),
        ("dropped touches", len(drawing.contact.dropped), _DROPPED),
        ("beside the canvas", len(drawing.beside), _OUTSIDE),
    ]
    for number, (name, count, colour) in enumerate(parts):
        left = x + number * wide / len(parts)
        plot.rule(left, y - 0.35 * plot.line, 2 * plot.line, colour, 0.9)
        plot.text(left + 2.6 * plot.line, y, f"{name}: {count}", QUIET)


def _draw_row(plot: Plot, axes: Axes, drawing: TakeInk, start: float, stop: float, wide: float) -> None:
    first, last = np.searchsorted(drawing.times, (start, stop), side="right")
    first = max(0, int(first) - 1)
    for parts, colour in (
        (drawing.contact.touches, _TOUCH),
        (drawing.contact.merged, _MERGED),
        (drawing.contact.dropped, _DROPPED),
        (drawing.beside, _OUTSIDE),
    ):
        _draw_parts(axes, drawing.times, parts[(parts[:, 1] > first) & (parts[:, 0] < last)], colour)
    times, heights = drawing.times[first : last + 1], drawing.heights[first : last + 1] * 1e3
    axes.plot(*_outline(times, heights, round(wide)), color=INK, linewidth=plot.points(1.1))
    axes.set_xlim(start, stop)


def _draw_parts(axes: Axes, times: Floats, parts: Frames, colour: str) -> None:
    starts, ends = times[parts[:, 0]], times[np.minimum(parts[:, 1], len(times) - 1)]
    spans = list(zip(starts.tolist(), (ends - starts).tolist(), strict=True))
    axes.broken_barh(spans, (0, 1), transform=axes.get_xaxis_transform(), color=colour, linewidth=0.5)


def _outline(times: Floats, heights: Floats, columns: int) -> tuple[Floats, Floats]:
    """Points of the curve; where it has many samples per pixel, the lowest and the highest of each pixel instead."""
    many = len(times) // columns
    if many < 3:
        return times, heights
    starts = np.arange(0, len(times), many)
    ends = np.stack([np.fmin.reduceat(heights, starts), np.fmax.reduceat(heights, starts)], axis=1)
    return np.repeat(times[starts], 2), ends.ravel()


def _draw_histogram(axes: Axes, heights: Floats, top: float) -> None:
    edges = np.linspace(-top / 4, top, _BINS)
    counts = np.histogram(heights, edges)[0]
    axes.stairs(np.log1p(counts), edges, orientation="horizontal", fill=True, color=INK)
    axes.set_xlim(0, 1.05 * np.log1p(counts.max(initial=1)))


def _finish(plot: Plot, axes: Axes, drawing: TakeInk, top: float) -> None:
    for height in (0.0, round_length(top)):
        axes.axhline(height, color=FAINT, linewidth=plot.points(1), zorder=1.5)  # under the curve
    axes.axhline(drawing.contact.threshold * 1e3, color=ACCENT, linewidth=plot.points(1.4))
    axes.axhline(drawing.contact.release * 1e3, color=ACCENT, linewidth=plot.points(1.4), linestyle=(0, (4, 3)))
    axes.set_ylim(-top / 4, top)
