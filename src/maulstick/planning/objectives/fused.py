"""Losses of an image that a native pass computes together with their slope."""

from collections.abc import Callable
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.autograd.function import once_differentiable

Pass = Callable[[NDArray[np.float32], NDArray[np.float32]], float]
"""What returns the loss of an image (C, H, W), and writes its slope with respect to it, (C, H, W)."""


def fused(image: Tensor, native: Pass) -> Tensor:
    """Return the loss, a scalar, of an image (C, H, W), float32 on the CPU, as a native pass computes it."""
    result: Tensor = _Fused.apply(image, native)
    return result


class _Fused(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, image: Tensor, native: Pass) -> Tensor:
        slope = torch.empty(image.shape)
        value = native(image.detach().contiguous().numpy(), slope.numpy())
        ctx.save_for_backward(slope)
        return image.new_tensor(value)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad_out: Tensor) -> tuple[Tensor | None, ...]:
        (slope,) = ctx.saved_tensors
        return slope * grad_out, None
