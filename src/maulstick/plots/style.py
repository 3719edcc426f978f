"""Plot of a style: strokes of the hand that it was learned from, and below them strokes drawn by the style.

Beside both stands how the strokes lie, where that is known: in the hand's drawing, and as the style arranges them.
"""

import numpy as np
import torch
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from maulstick.planning.spread import spread
from maulstick.plots.rows import largest_scale, rows_of
from maulstick.plots.sheet import ACCENT, INK, Plot, length_text
from maulstick.storage.arrays import Floats, Ints
from maulstick.strokes.strokes import path_lengths
from maulstick.style.arrangement import Arrangement
from maulstick.style.pressure import pressure_along
from maulstick.style.store import Fitted

_MOST = 72  # strokes per half: of more, each would be too small to be seen
_PROPORTION = 1.4  # width of a half over the height of the plot
_ARRANGED = 0.8  # width of arranged strokes beside it, over that height
_GAP = 1.5  # lines between strokes
_LARGEST = 1 / 6  # of the width of a half: the median stroke is enlarged to at most this
_LEAST = 1e-9  # metres: strokes on one line have no height
_WIDTH = 0.09  # lines: of a stroke without recorded pressure
_WIDTHS = 0.04, 0.18  # lines: at pressure 0 and at pressure 1


def style_plot(style: Fitted, title: str, px: int) -> bytes:
    """Draw a PNG, `px` pixels high: strokes of the hand, and as many drawn by the style, all at one scale.

    Beside them, at another scale, all of the hand's strokes where they were drawn, and as many arranged by the style.

    Of more than 72 strokes an even selection by length is shown. Strokes are as wide as their pressure where the
    pressure of the hand was recorded.
    """
    hand, arrangement = style.hand, style.arrangement
    plot = Plot((_PROPORTION + (0 if arrangement is None else _ARRANGED)) * px, px)
    margin, line, wide = plot.margin, plot.line, _PROPORTION * px
    lengths = path_lengths(hand.paths)
    shown = np.argsort(-lengths, kind="stable")[np.linspace(0, len(hand) - 1, min(len(hand), _MOST)).astype(int)]
    codes, knots = style.sample(len(shown), torch.Generator().manual_seed(0))
    drawn = style.decode(codes).double().numpy()
    longest = np.argsort(-path_lengths(drawn), kind="stable")
    pressed = bool(np.isfinite(hand.pressure).any())
    parts = [
        ("by the hand", hand.paths[shown], hand.pressure[shown]),
        ("by the style", drawn[longest], knots.double().numpy()[longest]),
    ]
    high = (px - plot.foot - margin) / 2
    room = wide - 4 * margin, high - 4.2 * line
    widths = np.ptp(np.concatenate([paths[..., 0] for _, paths, _ in parts]), axis=1)

    def fits(scale: float) -> bool:
        return all(_in_rows(paths * scale, room[0], _GAP * line)[2] <= room[1] for _, paths, _ in parts)

    scale = largest_scale(fits, room[0] * min(1 / widths.max(), _LARGEST / max(float(np.median(widths)), 1e-9)))
    for number, (whose, paths, pressure) in enumerate(parts):
        y = margin + number * (high + margin)
        axes = plot.paper(margin, y, wide - 2 * margin, high, 1.0)
        plot.text(2 * margin, y + 1.9 * line, whose)
        places, row, tall = _in_rows(paths * scale, room[0], _GAP * line)
        apart = min((room[1] - tall) / max(row.max(), 1), 1.5 * _GAP * line)
        places += [margin, 2.7 * line + (room[1] - tall - apart * row.max()) / 2]
        places[:, 1] += apart * row
        _draw(plot, axes, paths * scale + places[:, None], pressure if pressed else None)
    if arrangement is not None:
        _draw_arranged(plot, style, arrangement, wide, high)
    count = f"{len(shown)} of {len(hand)} strokes" if len(shown) < len(hand) else f"{len(hand)} strokes"
    middle, least, most = (length_text(f(lengths)) for f in (np.median, np.min, np.max))
    caption = (
        f"{count} of the hand, {least} to {most}, median {middle}; under them as many drawn by the style {style.name}"
    )
    note = "red where a stroke begins" + ("; as wide as it was pressed" if pressed else "; pressure not recorded")
    if arrangement is not None:
        note += "; right, how all of them lie, at another scale"
    plot.caption(title, caption, note, scale)
    return plot.png()


def _draw_arranged(plot: Plot, style: Fitted, arrangement: Arrangement, left: float, high: float) -> None:
    """Draw the hand's drawing and one arranged by the style, right of `left`, each `high`; pixels."""
    width, height = np.ptp(arrangement.paths, axis=(0, 1)).tolist()
    arranged = spread(style, arrangement, width, height)
    parts = [("as the hand lays them", arrangement.paths), ("as the style lays them", arranged)]
    wide, line, margin = plot.width - left - plot.margin, plot.line, plot.margin
    room = np.array([wide - 2 * margin, high - 4.2 * line])
    scale = min(float((room / np.ptp(paths, axis=(0, 1)).clip(min=_LEAST)).min()) for _, paths in parts)
    for number, (whose, paths) in enumerate(parts):
        y = margin + number * (high + margin)
        axes = plot.paper(left, y, wide, high, 1.0)
        plot.text(left + margin, y + 1.9 * line, whose)
        middle = (paths.min(axis=(0, 1)) + paths.max(axis=(0, 1))) / 2
        _draw(plot, axes, (paths - middle) * scale + np.array([wide / 2, 2.7 * line + room[1] / 2]), None)


def _in_rows(paths: Floats, wide: float, gap: float) -> tuple[Floats, Ints, float]:
    """Place of the origin of each path (N, n, 2), (N, 2), index of its row, (N,), and height of all rows, pixels.

    Each path is centred vertically in its row.
    """
    low, size = paths.min(axis=1), np.ptp(paths, axis=1)
    places, on, y = np.zeros((len(paths), 2)), np.zeros(len(paths), dtype=np.int64), 0.0
    for number, row in enumerate(rows_of(size[:, 0], wide, gap)):
        heights = size[row.strokes, 1]
        places[row.strokes, 0] = row.left
        places[row.strokes, 1] = y + (heights.max() - heights) / 2
        on[row.strokes] = number
        y += heights.max() + gap
    return places - low, on, y - gap


def _draw(plot: Plot, axes: Axes, paths: Floats, knots: Floats | None) -> None:
    """Draw paths (N, n, 2), pixels, each step as wide as the pressure given by its knots (N, 4)."""
    steps = np.stack([paths[:, :-1], paths[:, 1:]], axis=2)
    widths = np.full(steps.shape[:2], _WIDTH)
    if knots is not None:
        pressure = pressure_along(torch.from_numpy(knots)).numpy()
        light, deep = _WIDTHS
        pressed = light + (deep - light) * (pressure[:, :-1] + pressure[:, 1:]) / 2
        widths = np.where(np.isnan(pressed), widths, pressed)
    points = plot.points(plot.line) * widths
    axes.plot(*paths[:, 0].T, "o", ms=plot.points(0.26 * plot.line), mfc=ACCENT, mew=0)
    axes.add_collection(
        LineCollection(list(steps.reshape(-1, 2, 2)), colors=INK, linewidths=list(points.ravel()), capstyle="round")
    )
