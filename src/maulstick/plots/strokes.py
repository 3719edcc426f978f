"""Plot of strokes: a specimen sheet, like that of a typeface."""

import numpy as np
from matplotlib.collections import LineCollection

from maulstick.plots.rows import Row, largest_scale, rows_of
from maulstick.plots.sheet import ACCENT, FAINT, INK, Plot, length_text
from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import Strokes

_MOST = 240  # strokes on a sheet: of more, each would be too small to be seen
_PROPORTION = 1.4  # width of the plot over its height
_LEAST_HEIGHT = 20e-3  # metres in the height of the plot: small strokes are not enlarged further


def strokes_plot(strokes: Strokes, title: str, px: int) -> bytes:
    """Draw a PNG, `px` pixels high: standardised strokes at one scale, the longest first, in rows.

    Of more than 240 strokes an even selection by length is shown.
    """
    plot = Plot(_PROPORTION * px, px)
    margin, line = plot.margin, plot.line
    wide, high = plot.width - 4 * margin, px - plot.foot - 2 * margin
    order = np.argsort(-strokes.lengths, kind="stable")
    shown = order[np.linspace(0, len(order) - 1, min(len(order), _MOST)).round().astype(int)]
    paths = strokes.trajectories[shown, :, :2]
    gap = 1.6 * line
    widths = np.ptp(paths[..., 0], axis=1)

    def fits(scale: float) -> bool:
        rows = rows_of(widths * scale, wide, gap)
        return sum(sum(_reach(paths * scale, row)) + 0.6 * gap for row in rows) <= high

    scale = largest_scale(fits, min(high / _LEAST_HEIGHT, wide / max(widths.max(initial=0.0), 1e-9)))
    axes = plot.paper(margin, margin, plot.width - 2 * margin, px - plot.foot, 1.0)
    rows = rows_of(widths * scale, wide, gap)
    reaches = [_reach(paths * scale, row) for row in rows]
    free = (high - sum(map(sum, reaches))) / max(len(rows) - 1, 1)
    between = min(free, 3 * gap)
    y = margin
    segments: list[Floats] = []
    starts: list[Floats] = []
    dots: list[Floats] = []
    lines: list[Floats] = []
    for row, (rise, fall) in zip(rows, reaches, strict=True):
        y += rise
        for index, left in zip(row.strokes, row.left, strict=True):
            path = paths[index] * scale
            segments.append(path - [path[:, 0].min(), 0] + [margin + left, y])
            start = segments[-1][0]
            (starts if np.ptp(path, axis=0).any() else dots).append(start)
            lines.append(np.array([start, (start[0] + max(path[-1, 0], 0), start[1])]))
        y += fall + between
    points = plot.points(0.085 * line)
    axes.add_collection(LineCollection(lines, colors=FAINT, linewidths=plot.points(1)))
    for places, size, colour in ((starts, plot.points(0.26 * line), ACCENT), (dots, 3 * points, INK)):
        axes.plot(*np.array(places).reshape(-1, 2).T, "o", ms=size, mfc=colour, mew=0)
    axes.add_collection(LineCollection(segments, colors=INK, linewidths=points, capstyle="round", joinstyle="round"))
    note = "red where a stroke begins, a grey line from there to where it ends" if len(shown) else ""
    plot.caption(title, _caption(strokes, len(shown)), note, scale)
    return plot.png()


def _caption(strokes: Strokes, shown: int) -> str:
    if not len(strokes):
        return "no strokes"
    if len(strokes) == 1:
        return f"1 stroke, {length_text(strokes.lengths[0])}"
    part = f"{shown} of {len(strokes)} strokes" if shown < len(strokes) else f"{shown} strokes"
    longest, shortest, middle = (length_text(f(strokes.lengths)) for f in (np.max, np.min, np.median))
    return f"{part}, longest first: {longest} to {shortest}, median {middle}"


def _reach(paths: Floats, row: Row) -> tuple[float, float]:
    """Height above and depth below the line of the row's strokes, of paths (N, n, 2)."""
    heights = paths[row.strokes, :, 1]
    return -float(heights.min()), float(heights.max())
