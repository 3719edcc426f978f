"""Pyramids of halved images (Burt and Adelson 1983), and the mean squares of differences on their levels."""

from collections.abc import Sequence
from functools import cache

import numpy as np
import torch
from torch import Tensor
from torch.nn.functional import conv2d, pad

from maulstick.planning.objectives import _pyramid
from maulstick.planning.objectives.fused import Recorded, fused, has_native
from maulstick.rendering.kernels.cpu import THREADS


def levels_of(image: Tensor) -> int:
    """Return how many levels the pyramid of an image (C, H, W) has; the coarsest is some 16 pixels high."""
    return max(1, min(image.shape[1:]).bit_length() - 4)


def halved(image: Tensor) -> Tensor:
    """Return the image (C, H, W) at half its size, each pixel a binomial average.

    Averages over squares would reward lines that run along rows and columns.
    """
    taps = _taps(image.dtype, image.device)
    rows = pad(image[:, None], (0, 0, 2, 2), mode="replicate")
    rows = conv2d(rows, taps[None, None, :, None], stride=(2, 1))
    columns = pad(rows, (2, 2, 0, 0), mode="replicate")
    return conv2d(columns, taps[None, None, None, :], stride=(1, 2))[:, 0]


@cache  # a GPU could not record a copy from the processor's memory
def _taps(dtype: torch.dtype, device: torch.device) -> Tensor:
    return torch.tensor([1.0, 4.0, 6.0, 4.0, 1.0], dtype=dtype, device=device) / 16


class MeanSquares:
    """Sum over levels of a weight times the mean square of a scaled difference from a target there.

    target: (C, H, W).  scale: (H, W), which the difference is multiplied by.  pull: (C, H, W), whose mean product with
    the difference is added.
    """

    def __init__(self, target: Tensor, scale: Tensor, pull: Tensor | None = None) -> None:
        self._compared, self._recorded = (target, scale, pull), Recorded()

    def __call__(self, canvas: Tensor, weights: Sequence[float]) -> Tensor:
        """Return it, a scalar, for a canvas (C, H, W); weights: of each level, the finest first."""
        if not has_native(canvas):
            return self._recorded(self.plain, canvas, weights)
        target, scale, pull = self._compared
        pull = canvas.new_empty(0, 0, 0) if pull is None else pull
        others = [each.detach().contiguous().numpy() for each in (target, scale)]
        terms = np.array(weights, dtype=np.float32), pull.detach().contiguous().numpy()
        return fused(canvas, lambda seen, slope: _pyramid.mean_squares(THREADS, seen, *others, *terms, slope))

    def plain(self, canvas: Tensor, weights: Tensor) -> Tensor:
        """Return the same plainly: on any device, in any precision; weights: (levels,)."""
        target, scale, pull = self._compared
        difference = canvas - target
        total = difference.new_zeros(()) if pull is None else (difference * pull).mean()
        difference = difference * scale
        for level, weight in enumerate(weights.unbind()):
            difference = halved(difference) if level else difference
            total = total + weight * difference.square().mean()
        return total
