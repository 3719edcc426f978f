"""Strokes of a hand along the lines of a picture, each alone, where it is unknown how the hand arranges them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch
from scipy.ndimage import gaussian_filter
from torch import Generator, Tensor

from maulstick.painting.brush import Brush
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.placement import Places, at_pixels, colours_at, edge_size, strokes_at
from maulstick.planning.tracing import Along, lay_along
from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import path_lengths
from maulstick.style import Style
from maulstick.style.lengths import keep_lengths


class OnLines(NamedTuple):
    """Strokes on lines, standardised paths (k, n, 2) of others, metres, and the density (H, W) left for these."""

    strokes: StrokeParameters
    others: Tensor
    density: Floats


def strokes_on_lines(
    hand: Style,
    lines: Sequence[Floats],
    target: Floats,
    density: Floats,
    count: int,
    brush: Brush,
    scale: float,
    generator: Generator,
) -> OnLines | None:
    """Return those of `count` strokes of a hand that fit lines of a target (C, H, W), laid end to end along them.

    lines: as `traced` returns them.  density: (H, W), of strokes on the target.  scale: pixels per metre.
    None where none fits, and for a style that may grow its strokes.
    """
    lengths = hand.lengths(count)
    if lengths is None or not lines:
        return None
    codes, knots = hand.sample(count, generator)
    keep_lengths(codes, hand, lengths)
    paths = hand.decode(codes).detach()
    along = lay_along(lines, scale * paths.double().numpy(), np.ones(count, dtype=np.int64))
    if not len(along.rows):
        return None
    room = (density.size / count) ** 0.5
    centres, rows = along.paths.mean(axis=1), torch.from_numpy(along.rows)
    colours = colours_at(target, centres, edge_size(room, *density.shape))
    places = Places(centres, along.turns, np.full(len(rows), room), colours)
    others = torch.ones(count, dtype=torch.bool).index_fill(0, rows, False)
    ink = scale * float(lengths.sum())
    return OnLines(
        strokes_at(places, codes[rows], knots[rows], brush, scale), paths[others], _left(density, along, ink, room / 2)
    )


def _left(density: Floats, along: Along, ink: float, blur: float) -> Floats:
    """Return a density (H, W) that wants so much ink, in pixels of length, less what lies along lines."""
    wanted, drawn = density * (ink / density.sum()), np.zeros(density.shape)
    at = at_pixels(along.paths, *density.shape[::-1])
    np.add.at(drawn, at, (path_lengths(along.paths) / along.paths.shape[1])[:, None])
    before, there = (gaussian_filter(each, blur) for each in (wanted, drawn))
    left: Floats = density * (1 - there / np.maximum(before, 1e-12)).clip(0, 1)
    return left
