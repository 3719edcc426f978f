"""Pyramids of halved images (Burt and Adelson 1983), and the mean squares of differences on their levels."""

from collections.abc import Sequence

import numpy as np
import torch
from torch import Tensor
from torch.nn.functional import conv2d, pad

from maulstick.planning.objectives import _pyramid
from maulstick.planning.objectives.fused import fused
from maulstick.rendering.kernels.cpu import THREADS


def levels_of(image: Tensor) -> int:
    """Return how many levels the pyramid of an image (C, H, W) has; the coarsest is some 16 pixels high."""
    return max(1, min(image.shape[1:]).bit_length() - 4)


def halved(image: Tensor) -> Tensor:
    """Return the image (C, H, W) at half its size, each pixel a binomial average.

    Averages over squares would reward lines that run along rows and columns.
    """
    taps = torch.tensor([1.0, 4.0, 6.0, 4.0, 1.0], dtype=image.dtype, device=image.device) / 16
    rows = pad(image[:, None], (0, 0, 2, 2), mode="replicate")
    rows = conv2d(rows, taps[None, None, :, None], stride=(2, 1))
    columns = pad(rows, (2, 2, 0, 0), mode="replicate")
    return conv2d(columns, taps[None, None, None, :], stride=(1, 2))[:, 0]


def mean_squares(
    canvas: Tensor, target: Tensor, scale: Tensor, weights: Sequence[float], pull: Tensor | None = None
) -> Tensor:
    """Return the sum over levels of a weight times the mean square of a scaled difference there, a scalar.

    canvas, target: (C, H, W).  scale: (H, W), which their difference is multiplied by.  weights: of each level, the
    finest first.  pull: (C, H, W), whose mean product with the difference is added.
    """
    if canvas.device.type == "cpu" and canvas.dtype == torch.float32:
        pull = canvas.new_empty(0, 0, 0) if pull is None else pull
        others = [each.detach().contiguous().numpy() for each in (target, scale)]
        terms = np.array(weights, dtype=np.float32), pull.detach().contiguous().numpy()
        return fused(canvas, lambda seen, slope: _pyramid.mean_squares(THREADS, seen, *others, *terms, slope))
    return plain_mean_squares(canvas, target, scale, weights, pull)


def plain_mean_squares(
    canvas: Tensor, target: Tensor, scale: Tensor, weights: Sequence[float], pull: Tensor | None = None
) -> Tensor:
    """Return the same as `mean_squares`, plainly: on any device, in any precision."""
    difference = canvas - target
    total = difference.new_zeros(()) if pull is None else (difference * pull).mean()
    difference = difference * scale
    for level, weight in enumerate(weights):
        difference = halved(difference) if level else difference
        total = total + weight * difference.square().mean()
    return total
