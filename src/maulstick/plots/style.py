"""The plot of a style: strokes of the hand that it was learned from, and under them strokes that it draws itself."""

import numpy as np
import torch
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from numpy.typing import NDArray

from maulstick.plots.rows import largest_scale, rows_of
from maulstick.plots.sheet import ACCENT, INK, Plot, length_text
from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import path_lengths
from maulstick.style.pressure import pressure_along
from maulstick.style.store import Fitted

_MOST = 72
_PROPORTION = 1.4
_GAP = 1.5  # lines between strokes
_LARGEST = 1 / 6  # of a part's width: what the middle stroke is blown up to at most
_WIDTH = 0.09  # lines, without pressure
_WIDTHS = 0.04, 0.18  # lines, at pressure 0 and at pressure 1


def style_plot(style: Fitted, title: str, px: int) -> bytes:
    """A PNG, `px` pixels high: as many strokes drawn by the style as are shown of its hand, all at one scale.

    Of more than 72 strokes every so-manieth is shown, by length. Strokes are as wide as their pressure where the hand's
    was recorded.
    """
    plot = Plot(_PROPORTION * px, px)
    margin, line = plot.margin, plot.line
    hand = style.hand
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
    room = plot.width - 4 * margin, high - 4.2 * line
    widths = np.ptp(np.concatenate([paths[..., 0] for _, paths, _ in parts]), axis=1)

    def fits(scale: float) -> bool:
        return all(_libraries(paths * scale, room[0], _GAP * line)[2] <= room[1] for _, paths, _ in parts)

    scale = largest_scale(fits, room[0] * min(1 / widths.max(), _LARGEST / max(float(np.median(widths)), 1e-9)))
    for number, (whose, paths, pressure) in enumerate(parts):
        y = margin + number * (high + margin)
        axes = plot.paper(margin, y, plot.width - 2 * margin, high, 1.0)
        plot.text(2 * margin, y + 1.9 * line, whose)
        places, libraries, tall = _libraries(paths * scale, room[0], _GAP * line)
        apart = min((room[1] - tall) / max(libraries.max(), 1), 1.5 * _GAP * line)
        places += [margin, 2.7 * line + (room[1] - tall - apart * libraries.max()) / 2]
        places[:, 1] += apart * libraries
        _draw(plot, axes, paths * scale + places[:, None], pressure if pressed else None)
    count = f"{len(shown)} of {len(hand)} strokes" if len(shown) < len(hand) else f"{len(hand)} strokes"
    middle, least, most = (length_text(f(lengths)) for f in (np.median, np.min, np.max))
    told = (
        f"{count} of the hand, {least} to {most}, median {middle}; under them as many drawn by the style {style.name}"
    )
    note = "red where a stroke begins" + ("; as wide as it was pressed" if pressed else "; pressure not recorded")
    plot.caption(title, told, note, scale)
    return plot.png()


def _libraries(paths: Floats, wide: float, gap: float) -> tuple[Floats, NDArray[np.int64], float]:
    """Where the origin of each path (N, n, 2) goes, (N, 2), on which library, (N,), and how high all are, pixels.

    The middle of each lies at the middle of its library.
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
    """Draw paths (N, n, 2), pixels, each step as wide as its pressure knots (N, 4) say."""
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
