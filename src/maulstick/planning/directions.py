"""Directions of a picture for a hand's strokes: along its edges, near and far, and between them as the hand leans."""

import numpy as np
from scipy.ndimage import gaussian_filter

from maulstick.planning.placement import edge_size
from maulstick.storage.arrays import Complexes, Floats

_OCTAVES = 4  # sizes of edges that are looked at, each twice the one before
_FADES = 0.25  # weight of an edge of twice the size: near ones rule where there are any
_OWN = 0.1  # weight of the hand's own direction, over that of a usual place's edges


def directions(target: Floats, spacing: float, leaning: complex) -> Complexes:
    """Return which way lines lie on a target (C, H, W), (H, W): exp(2i angle), times how sure that is, from 0 to 1.

    spacing: pixels between strokes.  leaning: which way the hand leans, in the same way.

    A sum of structure tensors, the coarser the fainter: a flat place goes with the edges around it, and one that is far
    from all of them as the hand leans, so its lines lie alike. A target without any edge has no direction.
    """
    grey = target.mean(axis=0)
    height, width = grey.shape
    sigma = edge_size(spacing, height, width)
    across, strength = np.zeros(grey.shape, dtype=complex), np.zeros(grey.shape)
    for octave in range(_OCTAVES):
        y, x = (sigma * gaussian_filter(grey, sigma / 2, order=order) for order in ((1, 0), (0, 1)))
        yy, xy, xx = (_FADES**octave * gaussian_filter(part, sigma) for part in (y * y, x * y, x * x))
        here = np.ix_(np.arange(height) >> octave, np.arange(width) >> octave)
        across += (xx - yy + 2j * xy)[here]
        strength += (xx + yy)[here]
        grey = gaussian_filter(grey, 1.0)[::2, ::2]
    own = _OWN * strength.mean()
    sure = (own * leaning - across) / np.maximum(strength + own, 1e-12)
    found: Complexes = sure / np.sqrt(np.maximum(np.abs(sure), 1e-12))
    return found
