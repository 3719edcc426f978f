"""The plate of some strokes: a specimen sheet, like that of a typeface."""

from typing import NamedTuple

import numpy as np
from matplotlib.collections import LineCollection

from maulstick.plates.sheet import ACCENT, FAINT, INK, Plate, length_text
from maulstick.strokes import Floats, Strokes

_MOST = 240
_PROPORTION = 1.4
_LEAST_HEIGHT = 20e-3  # metres on the whole plate: what is smaller is not blown up further


class _Row(NamedTuple):
    """Strokes side by side. left: where each begins.  rise, fall: how far they reach over and under their line."""

    strokes: list[int]
    left: list[float]
    rise: float
    fall: float


def strokes_plate(strokes: Strokes, title: str, px: int) -> bytes:
    """A PNG, `px` pixels high: standardised strokes at one scale, the longest first, each on its line.

    Of more than 240 strokes every so-manieth is shown, by length.
    """
    plate = Plate(_PROPORTION * px, px)
    margin, line = plate.margin, plate.line
    wide, high = plate.width - 4 * margin, px - plate.foot - 2 * margin
    order = np.argsort(-strokes.lengths, kind="stable")
    shown = order[np.linspace(0, len(order) - 1, min(len(order), _MOST)).round().astype(int)]
    paths = strokes.trajectories[shown, :, :2]
    gap = 1.6 * line
    scale = _largest_scale(paths, wide, high, gap)
    axes = plate.paper(margin, margin, plate.width - 2 * margin, px - plate.foot, 1.0)
    rows = _rows(paths * scale, wide, gap)
    free = (high - sum(row.rise + row.fall for row in rows)) / max(len(rows) - 1, 1)
    between = min(free, 3 * gap)
    y = margin
    segments: list[Floats] = []
    starts: list[Floats] = []
    dots: list[Floats] = []
    lines: list[Floats] = []
    for row in rows:
        y += row.rise
        for index, left in zip(row.strokes, row.left, strict=True):
            path = paths[index] * scale
            segments.append(path - [path[:, 0].min(), 0] + [margin + left, y])
            start = segments[-1][0]
            (starts if np.ptp(path, axis=0).any() else dots).append(start)
            lines.append(np.array([start, (start[0] + max(path[-1, 0], 0), start[1])]))
        y += row.fall + between
    points = plate.points(0.085 * line)
    axes.add_collection(LineCollection(lines, colors=FAINT, linewidths=plate.points(1)))
    for places, size, colour in ((starts, plate.points(0.26 * line), ACCENT), (dots, 3 * points, INK)):
        axes.plot(*np.array(places).reshape(-1, 2).T, "o", ms=size, mfc=colour, mew=0)
    axes.add_collection(LineCollection(segments, colors=INK, linewidths=points, capstyle="round", joinstyle="round"))
    note = "red where a stroke begins, a grey line from there to where it ends" if len(shown) else ""
    plate.caption(title, _told(strokes, len(shown)), note, scale)
    return plate.png()


def _told(strokes: Strokes, shown: int) -> str:
    if not len(strokes):
        return "no strokes"
    if len(strokes) == 1:
        return f"1 stroke, {length_text(strokes.lengths[0])}"
    part = f"{shown} of {len(strokes)} strokes" if shown < len(strokes) else f"{shown} strokes"
    longest, shortest, middle = (length_text(f(strokes.lengths)) for f in (np.max, np.min, np.median))
    return f"{part}, longest first: {longest} to {shortest}, median {middle}"


def _rows(paths: Floats, wide: float, gap: float) -> list[_Row]:
    """Strokes (N, n, 2) in pixels, as many side by side as there is room for, the room that is left between them."""
    widths = np.ptp(paths[..., 0], axis=1)
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
        space = min(spread, 2.5 * gap) if number + 1 == len(filled) else spread
        left = np.cumsum(widths[row] + space) - widths[row] - space
        heights = paths[row, :, 1]
        rows.append(_Row(row, left.tolist(), -float(heights.min()), float(heights.max())))
    return rows


def _largest_scale(paths: Floats, wide: float, high: float, gap: float) -> float:
    """Pixels a metre at which all strokes find room."""
    widest = np.ptp(paths[..., 0], axis=1).max(initial=0.0)
    low, top = 0.0, min(high / _LEAST_HEIGHT, wide / max(widest, 1e-9))
    for _ in range(30):
        scale = (low + top) / 2
        tall = sum(row.rise + row.fall + 0.6 * gap for row in _rows(paths * scale, wide, gap))
        low, top = (scale, top) if tall <= high else (low, scale)
    return low
