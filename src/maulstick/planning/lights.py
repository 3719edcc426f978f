"""Strokes that lie across the lights of a picture: a long arc over a face, which no person would draw."""

import numpy as np
from scipy.ndimage import maximum_filter
from torch import Tensor

from maulstick.planning.placement import at_pixels
from maulstick.planning.problem import Colour
from maulstick.planning.separation import separated
from maulstick.storage.arrays import Bools, Floats
from maulstick.strokes.strokes import path_lengths

_LIGHT = 0.08  # of the ink in the darkest hundredth: what has less is light
_BESIDE = 3  # side of the squares of pixels without any more ink: strokes may miss a line or an edge by one
_ACROSS = 2.5  # spacings in lights, from which on a stroke is seen before the picture; by eye
_MOST = 0.02  # share of the strokes: where more lie across lights, that is how the hand draws


def across_lights(paths: Floats, target: Tensor, paper: Tensor, inks: tuple[Colour, ...], spacing: float) -> Bools:
    """Return which strokes, (N,), lie far across lights: those that do so farthest, few at most.

    None do where something is drawn on the paper already, since that need not be drawn again.

    paths: (N, n, 2).  target, paper: (C, H, W), what inks are to draw, and on what.
    spacing: distance between strokes. Lengths are in pixels.
    """
    across = np.zeros(len(paths), dtype=bool)
    if (paper != paper[:, :1, :1]).any():
        return across
    amounts = separated(target.double(), paper.double(), inks).sum(dim=0).cpu().numpy()
    light = maximum_filter(amounts, _BESIDE) < _LIGHT * np.quantile(amounts, 0.99)
    in_lights = path_lengths(paths) * light[at_pixels(paths, *light.shape[::-1])].mean(axis=1)
    farthest = np.argsort(-in_lights, kind="stable")[: int(_MOST * len(paths))]
    across[farthest] = in_lights[farthest] > _ACROSS * spacing
    return across
