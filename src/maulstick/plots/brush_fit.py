"""Plot of a fitted brush: its width, its profile, its numbers, and how it draws strokes that were held out."""

from collections.abc import Sequence
from math import floor, inf, log10

import numpy as np
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.patches import Rectangle

from maulstick.brush_fit.fit import Fit, HeldOutStroke
from maulstick.painting.brush import Brush
from maulstick.plots.brush import profile_chart, width_chart
from maulstick.plots.rows import Row, largest_scale, rows_of
from maulstick.plots.sheet import ACCENT, FAINT, INK, PAPER, Plot
from maulstick.storage.arrays import Pixels

_WIDTH, _HEIGHT, _LINES = 2016, 1440, 64  # pixels, pixels, and lines of text in the height
_CHART_TOP, _CHART_HIGH = 8.5, 10.0  # lines, as are all that follow
_CHART_WIDE, _BETWEEN = 20.0, 6.0
_NUMBERS_TOP, _NUMBER = 7.7, 1.3
_VIEWS_TOP, _NAMES = 24.0, 6.5
_GAP, _NAME = 0.6, 1.9  # lines: between pictures, and above them for a name
_ROWS = ("photograph", "prediction", "difference")
_DARKER = "#2f6690"  # where the prediction is too dark
_FULL = 0.5  # difference, of 1, that is drawn in full colour
_DIFFERENCE = LinearSegmentedColormap.from_list("difference", [_DARKER, PAPER, ACCENT])
_LENGTHS = ("b_x", "b_y", "alpha", "beta", "lag", "touch")  # fields of a brush in metres


def fit_plot(fit: Fit) -> bytes:
    """Draw a fit as a PNG, of one size for all fits."""
    plot = Plot(_WIDTH, _HEIGHT, _LINES)
    margin, line = plot.margin, plot.line
    right = plot.width - margin
    plot.text(margin, margin + 1.2 * line, fit.brush.name, INK, 1.7, room=right - margin)
    plot.text(margin, margin + 2.9 * line, fit.brush.source, room=right - margin)
    x, y, high, wide = margin + 4 * line, _CHART_TOP * line, _CHART_HIGH * line, _CHART_WIDE * line
    width_chart(plot, fit.brush, x, y, wide, high)
    profile_chart(plot, fit.brush, x + wide + _BETWEEN * line, y, wide, high)
    left = x + 2 * wide + (_BETWEEN + 3.5) * line
    _numbers(plot, fit, left, right - left)
    scale = _views(plot, fit.views, _VIEWS_TOP * line, plot.height - plot.foot - _VIEWS_TOP * line)
    caption = (
        f"mean error of a pixel {fit.l1:.4f}, with the paper's seven numbers {fit.l1_paper:.4f}; "
        f"marks scatter by {1e3 * fit.place_scatter:.2g} mm in place and {fit.ink_scatter:.0%} in darkness"
    )
    note = "difference: red where the prediction is too light, blue where it is too dark"
    plot.caption(f"{len(fit.views)} of {fit.strokes} strokes", caption, note, scale * fit.pixels_per_metre)
    return plot.png()


def measured(fit: Fit) -> dict[str, str]:
    """Fitted numbers by their names, as text with their standard errors, lengths in millimetres."""
    fields = list(Brush.model_fields)
    texts: dict[str, list[str]] = {}
    for key in sorted(fit.errors, key=lambda key: fields.index(key.partition("[")[0])):
        name, _, index = key.partition("[")
        value = getattr(fit.brush, name)
        number = value[int(index.rstrip("]"))] if index else value
        texts.setdefault(name, []).append(_with_error(number, fit.errors[key], 1e3 if name in _LENGTHS else 1.0))
    return {name: ", ".join(each) + (" mm" if name in _LENGTHS else "") for name, each in texts.items()}


def _with_error(value: float, error: float, factor: float) -> str:
    """Format a value and its error: the error with one significant digit, the value with as many decimals."""
    value, error = factor * value, factor * error
    places = min(max(-floor(log10(error)), 0), 6) if 0 < error < inf else 4
    return f"{value:.{places}f} ± {error:.{places}f}"


def _numbers(plot: Plot, fit: Fit, x: float, wide: float) -> None:
    line = plot.line
    for number, (name, value) in enumerate(measured(fit).items()):
        y = (_NUMBERS_TOP + number * _NUMBER) * line
        plot.text(x, y, name)
        plot.text(x + _NAMES * line, y, value, INK, room=wide - _NAMES * line)


def _views(plot: Plot, views: Sequence[HeldOutStroke], y: float, high: float) -> float:
    """Draw the views side by side, three pictures per view below each other, as large as fits; return their scale."""
    line, gap = plot.line, _GAP * plot.line
    left = plot.margin + _NAMES * line
    wide = plot.width - plot.margin - left
    views = sorted(views, key=lambda view: -view.after.shape[0])  # rows of alike heights waste no room
    sizes = np.array([view.after.shape[:2] for view in views], dtype=np.float64)

    def rows_at(scale: float) -> list[tuple[Row, float]]:
        rows = rows_of(scale * sizes[:, 1], wide, gap)
        return [(row, scale * float(sizes[row.strokes, 0].max())) for row in rows]

    def fits(scale: float) -> bool:
        return sum(3 * tall + 3 * gap + _NAME * line for _, tall in rows_at(scale)) <= high

    scale = largest_scale(fits, wide / sizes[:, 1].max())
    for row, tall in rows_at(scale):
        y += _NAME * line
        for part, name in enumerate(_ROWS):
            plot.text(left - line, y + part * (tall + gap) + tall / 2, name, ha="right")
        for x, number in zip(left + row.left, row.strokes, strict=True):
            height, width = scale * sizes[number]
            _draw(plot, views[number], x, y + (tall - height) / 2, width, height, tall + gap)
            plot.text(x, y - 0.5 * line, views[number].name, room=width, size=0.9)
        y += 3 * (tall + gap)
    return scale


def _draw(plot: Plot, view: HeldOutStroke, x: float, y: float, wide: float, high: float, step: float) -> None:
    """Draw the three pictures of a view below each other. step: pixels from one to the next."""
    for part, picture in enumerate((_rgb(view.after), _rgb(view.predicted), _difference(view))):
        axes = plot.axes(x, y + part * step, wide, high, 1.0)
        axes.imshow(picture, extent=(0, wide, high, 0), aspect="auto")
        axes.add_patch(Rectangle((0, 0), wide, high, fill=False, ec=FAINT, lw=plot.points(1), clip_on=False))


def _rgb(picture: Pixels) -> Pixels:
    """Colours (h, w, 3) to show; where only the darkness (h, w, 1) of ink is known, in greys."""
    return picture.clip(0, 1) if picture.shape[2] == 3 else 1 - picture.clip(0, 1).repeat(3, axis=2)


def _difference(view: HeldOutStroke) -> Pixels:
    """Colours (h, w, 4), RGBA, of how much lighter the prediction is than the photograph."""
    lighter = (_rgb(view.predicted) - _rgb(view.after)).mean(axis=2)
    return np.asarray(_DIFFERENCE(0.5 + lighter / 2 / _FULL), dtype=np.float32)
