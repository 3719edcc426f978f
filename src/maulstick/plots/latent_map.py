"""Map of a latent space: each stroke of a hand at its place in it, as in the paper's t-SNE figure."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from matplotlib.collections import LineCollection
from threadpoolctl import threadpool_limits

from maulstick.errors import InputError
from maulstick.plots.sheet import ACCENT, INK, Plot
from maulstick.storage.arrays import Floats, Ints
from maulstick.style.store import Fitted

COLOURS = (INK, ACCENT, "#2f6690", "#5f8a3a", "#b98220", "#7a4f95")
"""Colours of the styles on a map, in their order."""

_PROPORTION = 1.4  # width of the plot over its height
_MOST = 400  # strokes on a map: of more, each would be too small to be seen
_PERPLEXITY = 30  # of t-SNE, the default of scikit-learn; less where there are few strokes
_SAME = 1e-4  # of codes, whose change of 1 is a large one: rounding in float32 stays below a tenth of this
_LARGEST = 7.0  # lines: size of the largest stroke at most
_CLOSE = 1.3  # size of the largest stroke over its share of the map; above 1 since most strokes are smaller
_WIDTH = 0.075  # lines: of a stroke
_LEGEND = 13  # lines: width of a column of the legend


@dataclass(frozen=True)
class MapPositions:
    """Positions on the map of N strokes of the hands of some styles.

    whose: (N,), index of the style.  rows: (N,), index of the stroke within its hand.
    glyphs: (N, 32, 2), about the origin; the largest is 1 wide or high, the others scale by the root of their size.
    places: (N, 2), in the square of side 1 about the origin.
    """

    whose: Ints
    rows: Ints
    glyphs: Floats
    places: Floats


def places_of(styles: Sequence[Fitted]) -> MapPositions:
    """Place strokes of the styles' hands on a map, by t-SNE of their codes in the first style.

    Strokes lie near each other where the style gives them similar codes; directions and long distances mean nothing.
    Strokes that are all the same lie in the middle. Of more than 400 strokes an even selection is placed.

    Raises InputError where there are more styles than colours.
    """
    if not 1 <= len(styles) <= len(COLOURS):
        raise InputError.of_range("the number of styles on a map", len(styles), f"from 1 to {len(COLOURS)}")
    share = min(1.0, _MOST / sum(len(style.hand) for style in styles))
    chosen = [np.linspace(0, n - 1, max(round(share * n), 1)).astype(int) for n in (len(s.hand) for s in styles)]
    paths = np.concatenate([style.hand.paths[rows] for style, rows in zip(styles, chosen, strict=True)])
    whose = np.repeat(np.arange(len(styles)), [len(rows) for rows in chosen])
    places = _spread(_placed(styles[0].encode(torch.from_numpy(paths)).double().numpy()))
    return MapPositions(whose, np.concatenate(chosen), _glyphs(paths), places)


def latent_map(styles: Sequence[Fitted], title: str, px: int) -> bytes:
    """Draw a PNG, `px` pixels high: strokes of the styles' hands at their `places_of`, one colour per style.

    Raises InputError where there are more styles than colours.
    """
    found = places_of(styles)
    plot = Plot(_PROPORTION * px, px)
    margin, line = plot.margin, plot.line
    wide, high = plot.width - 2 * margin, px - plot.foot
    axes = plot.paper(margin, margin, wide, high, 1.0)
    size = min(_LARGEST * line, _CLOSE * float(np.sqrt(wide * high / len(found.whose))))
    room = np.array([wide, high]) - size - 2 * line
    drawn = found.glyphs * size + (found.places * room + np.array([wide, high]) / 2)[:, None]
    axes.add_collection(
        LineCollection(
            list(drawn),
            colors=[COLOURS[number] for number in found.whose],
            linewidths=plot.points(_WIDTH * line),
            capstyle="round",
            joinstyle="round",
        )
    )
    _legend(plot, [style.name for style in styles], title, len(found.whose), sum(len(style.hand) for style in styles))
    return plot.png()


def _placed(codes: Floats) -> Floats:
    """Embed codes (N, K) in the plane, (N, 2): always alike, and at the origin if none differ."""
    if np.ptp(codes, axis=0).max() < _SAME:  # only rounding tells them apart: t-SNE would divide by it, or by nothing
        return np.zeros((len(codes), 2))
    from sklearn.manifold import TSNE  # takes a moment

    perplexity = min(_PERPLEXITY, (len(codes) - 1) / 3)
    tsne: Any = TSNE(perplexity=perplexity, init="pca", random_state=0)
    with threadpool_limits(1):  # more only wait for each other, and need not add up the same
        return np.asarray(tsne.fit_transform(codes), dtype=np.float64)


def _spread(places: Floats) -> Floats:
    """Scale places (N, 2) to fill the square of side 1 about the origin; what does not differ is in its middle."""
    low, size = places.min(axis=0), np.ptp(places, axis=0)
    spread: Floats = (places - low - size / 2) / size.clip(min=1e-12)
    return spread


def _glyphs(paths: Floats) -> Floats:
    """Centre and scale paths (N, n, 2): the largest is 1 wide or high, the others by the root of their size."""
    low, size = paths.min(axis=1, keepdims=True), np.ptp(paths, axis=1, keepdims=True)
    extent = size.max(axis=2, keepdims=True)
    glyphs: Floats = (paths - low - size / 2) / np.sqrt(extent * extent.max())
    return glyphs


def _legend(plot: Plot, names: Sequence[str], title: str, shown: int, strokes: int) -> None:
    line, base = plot.line, plot.height - plot.margin
    columns = -(-len(names) // 3) if len(names) > 1 else 0
    for number, name in enumerate(names[: 3 * columns]):
        x = plot.width - plot.margin - (columns - 1 - number // 3) * _LEGEND * line
        y = base - (2.75, 1.35, 0)[number % 3] * line
        plot.text(x, y, name, COLOURS[number], 1.2, room=(_LEGEND - 1) * line, ha="right")
    room = plot.width - 2 * plot.margin - columns * _LEGEND * line
    count = f"{shown} of {strokes}" if shown < strokes else f"{shown}"
    plot.text(plot.margin, base - 2.75 * line, title, INK, 1.2, room)
    caption = f"{count} strokes by hand; the nearer, the more alike to the style {names[0]} (t-SNE of their codes)"
    plot.text(plot.margin, base - 1.3 * line, caption, room=room)
    plot.text(plot.margin, base, "a stroke that was four times as large is drawn twice as large", room=room)
