"""The map of a latent space: each stroke of a hand at its place in it, the paper's figure of t-SNE."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from matplotlib.collections import LineCollection
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from maulstick.errors import InputError
from maulstick.plots.sheet import ACCENT, INK, Plot
from maulstick.storage.arrays import Floats
from maulstick.style.store import Fitted

COLOURS = (INK, ACCENT, "#2f6690", "#5f8a3a", "#b98220", "#7a4f95")
_PROPORTION = 1.4
_MOST = 400
_PERPLEXITY = 30
_SAME = 1e-4  # of codes, whose change of 1 is a large one: rounding in float32 stays below a tenth of this
_LARGEST = 7.0  # lines: the largest stroke at most
_CLOSE = 1.3  # times its share of the map, since some strokes are small
_WIDTH = 0.075  # lines
_LEGEND = 13  # lines: width of a column of it


@dataclass(frozen=True)
class MapPositions:
    """Where N strokes of some styles' hands lie on the map.

    whose: (N,), the number of the style.  rows: (N,), which stroke of its hand.
    glyphs: (N, 32, 2), about the origin; the largest is 1 wide or high, the others by the root of their size.
    places: (N, 2), over the square of side 1 about the origin.
    """

    whose: NDArray[np.int64]
    rows: NDArray[np.int64]
    glyphs: Floats
    places: Floats


def places_of(styles: Sequence[Fitted]) -> MapPositions:
    """Where strokes of the styles' hands lie, by the t-SNE of their codes in the first style.

    Strokes lie near each other where the style thinks them alike; directions and distances across the map mean
    nothing. Strokes that are all the same lie in the middle. Of more than 400 strokes there is every so-manieth.

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
    """A PNG, `px` pixels high: strokes of the styles' hands at their `places_of`, each style in a colour.

    Raises InputError where there are more styles than colours.
    """
    at = places_of(styles)
    plot = Plot(_PROPORTION * px, px)
    margin, line = plot.margin, plot.line
    wide, high = plot.width - 2 * margin, px - plot.foot
    axes = plot.paper(margin, margin, wide, high, 1.0)
    size = min(_LARGEST * line, _CLOSE * float(np.sqrt(wide * high / len(at.whose))))
    room = np.array([wide, high]) - size - 2 * line
    drawn = at.glyphs * size + (at.places * room + np.array([wide, high]) / 2)[:, None]
    axes.add_collection(
        LineCollection(
            list(drawn),
            colors=[COLOURS[number] for number in at.whose],
            linewidths=plot.points(_WIDTH * line),
            capstyle="round",
            joinstyle="round",
        )
    )
    _legend(plot, [style.name for style in styles], title, len(at.whose), sum(len(style.hand) for style in styles))
    return plot.png()


def _placed(codes: Floats) -> Floats:
    """Codes (N, K) on the plane, (N, 2), the same for the same codes; all at the origin if none differ."""
    if np.ptp(codes, axis=0).max() < _SAME:  # only rounding tells them apart: t-SNE would divide by it, or by nothing
        return np.zeros((len(codes), 2))
    from sklearn.manifold import TSNE  # takes a moment

    perplexity = min(_PERPLEXITY, (len(codes) - 1) / 3)
    tsne: Any = TSNE(perplexity=perplexity, init="pca", random_state=0)
    with threadpool_limits(1):  # more only wait for each other, and need not add up the same
        return np.asarray(tsne.fit_transform(codes), dtype=np.float64)


def _spread(places: Floats) -> Floats:
    """Places (N, 2) over the square of side 1 about the origin."""
    low, size = places.min(axis=0), np.ptp(places, axis=0)
    spread: Floats = (places - low - size / 2) / size.clip(min=1e-12)
    return spread


def _glyphs(paths: Floats) -> Floats:
    """Paths (N, n, 2) about the origin; the largest is 1 wide or high, the others by the root of their size."""
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
    told = f"{count} strokes by hand; the nearer, the more alike to the style {names[0]} (t-SNE of their codes)"
    plot.text(plot.margin, base - 1.3 * line, told, room=room)
    plot.text(plot.margin, base, "a stroke that was four times as large is drawn twice as large", room=room)
