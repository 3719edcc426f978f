"""Plot of several paintings side by side, all at one scale."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.patches import Rectangle

from maulstick.painting.raster import Canvas
from maulstick.plots.sheet import FAINT, INK, Plot
from maulstick.storage.arrays import Floats, Image

_PROPORTION = 1.6  # width of the plot over its height
_GAP = 2.0  # lines between pictures
_TITLE = 4.2  # lines above a picture


@dataclass(frozen=True)
class Panel:
    """Picture on a plot. size: (width, height), metres.  draw: renders it as (H, W, 3), in [0, 1], on a canvas."""

    name: str
    note: str
    size: tuple[float, float]
    draw: Callable[[Canvas], Image]


def compare_plot(panels: Sequence[Panel], title: str, caption: str, note: str, px: int) -> bytes:
    """Draw a PNG, `px` pixels high: the panels in rows, as large as fits, above a title, a caption and a note."""
    plot = Plot(_PROPORTION * px, px)
    room = plot.width - 2 * plot.margin, px - plot.foot - plot.margin
    gap, above = _GAP * plot.line, _TITLE * plot.line
    scale, rows = _rows(np.array([panel.size for panel in panels]), room, gap, above)
    heights = [scale * max(panels[number].size[1] for number in row) for row in rows]
    y = plot.margin + (room[1] - sum(heights) - len(rows) * (above + gap) + gap) / 2
    for row, height in zip(rows, heights, strict=True):
        widths = [scale * panels[number].size[0] for number in row]
        x = (plot.width - sum(widths) - gap * (len(row) - 1)) / 2
        for number, width in zip(row, widths, strict=True):
            _draw(plot, panels[number], x, y + above, scale)
            x += width + gap
        y += above + height + gap
    plot.caption(title, caption, note, scale)
    return plot.png()


def _rows(sizes: Floats, room: tuple[float, float], gap: float, above: float) -> tuple[float, list[list[int]]]:
    """Largest scale, pixels per metre, at which panels of these sizes (N, 2) fit, and their indices by rows.

    room: (width, height), pixels.  gap: between two panels, pixels.  above: space left free above each, pixels.
    """
    found = []
    for count in range(1, len(sizes) + 1):
        rows = [row.tolist() for row in np.array_split(np.arange(len(sizes)), count)]
        across = min((room[0] - gap * (len(row) - 1)) / sizes[row, 0].sum() for row in rows)
        down = (room[1] - above * count - gap * (count - 1)) / sum(sizes[row, 1].max() for row in rows)
        found.append((float(min(across, down)), rows))
    return max(found, key=lambda each: each[0])


def _draw(plot: Plot, panel: Panel, x: float, y: float, scale: float) -> None:
    """Draw a panel with its upper left corner at (x, y), pixels, and its name above it."""
    width, height = scale * panel.size[0], scale * panel.size[1]
    plot.text(x, y - 2.1 * plot.line, panel.name, INK, 1.4, room=width)
    plot.text(x, y - 0.7 * plot.line, panel.note, room=width)
    axes = plot.axes(x, y, width, height, 1.0)
    image = panel.draw(Canvas(*panel.size, scale))
    axes.imshow(image, extent=(0, width, height, 0), aspect="auto", interpolation="antialiased")
    axes.add_patch(Rectangle((0, 0), width, height, fill=False, ec=FAINT, lw=plot.points(1), clip_on=False))
