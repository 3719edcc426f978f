"""Pyramids of halved images (Burt and Adelson 1983), and the mean squares of a difference on their levels."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from torch import Tensor
from torch.autograd.function import once_differentiable
from torch.nn.functional import conv2d, pad

from maulstick.planning.objectives import _pyramid


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


def mean_squares(difference: Tensor, weights: Sequence[float]) -> Tensor:
    """Return the sum over levels of a weight times the mean square of the difference (C, H, W) there, a scalar.

    weights: of each level, the finest first.
    """
    if difference.device.type == "cpu" and difference.dtype == torch.float32:
        result: Tensor = _MeanSquares.apply(difference.contiguous(), weights)
        return result
    return plain_mean_squares(difference, weights)


def plain_mean_squares(difference: Tensor, weights: Sequence[float]) -> Tensor:
    """Return the same as `mean_squares`, plainly: on any device, in any precision."""
    total = difference.new_zeros(())
    for level, weight in enumerate(weights):
        difference = halved(difference) if level else difference
        total = total + weight * difference.square().mean()
    return total


class _MeanSquares(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, difference: Tensor, weights: Sequence[float]) -> Tensor:
        slope = torch.empty_like(difference)
        value = _pyramid.mean_squares(difference.detach().numpy(), np.array(weights, dtype=np.float32), slope.numpy())
        ctx.save_for_backward(slope)
        return difference.new_tensor(value)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad_out: Tensor) -> tuple[Tensor, None]:
        (slope,) = ctx.saved_tensors
        return slope * grad_out, None
