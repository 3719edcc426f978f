"""Losses of an image that are computed together with their slope."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.autograd.function import once_differentiable

from maulstick.rendering.kernels.repeated import Repeated

Pass = Callable[[NDArray[np.float32], NDArray[np.float32]], float]
"""What returns the loss of an image (C, H, W), and writes its slope with respect to it, (C, H, W)."""


def has_native(image: Tensor) -> bool:
    """Return whether native passes take this image."""
    return image.device.type == "cpu" and image.dtype == torch.float32


def fused(image: Tensor, native: Pass) -> Tensor:
    """Return the loss, a scalar, of an image (C, H, W) that `has_native`, as a native pass computes it."""

    def found() -> tuple[Tensor, Tensor]:
        slope = torch.empty(image.shape)
        value = native(image.detach().contiguous().numpy(), slope.numpy())
        return image.new_tensor(value), slope

    result: Tensor = _WithSlope.apply(image, found)
    return result


Plain = Callable[[Tensor, Tensor], Tensor]
"""What returns the loss, a scalar, of an image (C, H, W) and numbers (k,), all on one device, by PyTorch.

It makes no tensor of the CPU's memory, and looks at no value, so that a GPU can record it.
"""


class Recorded:
    """One loss of images and its slope as PyTorch finds them, which a GPU records and then replays."""

    def __init__(self) -> None:
        self._image = self._numbers = torch.empty(0)  # what is replayed reads these
        self._known: tuple[float, ...] = ()  # the numbers that are there
        self._repeated = Repeated(self._image.device)

    def __call__(self, plain: Plain, image: Tensor, numbers: Sequence[float] = ()) -> Tensor:
        """Return the loss, a scalar, of an image (C, H, W) and numbers (k,); plain: the same at each call."""
        result: Tensor = _WithSlope.apply(image, lambda: self._found(plain, image.detach(), numbers))
        return result

    def _found(self, plain: Plain, image: Tensor, numbers: Sequence[float]) -> tuple[Tensor, Tensor]:
        """Return the loss and its slope (C, H, W)."""
        if not self._suits(image) or len(numbers) != len(self._known):
            self._image, self._numbers, self._known = torch.empty_like(image), image.new_empty(len(numbers)), ()
            self._repeated = Repeated(image.device)
        self._image.copy_(image)
        if (asked := tuple(numbers)) != self._known:
            self._numbers.copy_(torch.tensor(asked, dtype=image.dtype, device=image.device))
            self._known = asked
        self._repeated(partial(self._work, plain), on=self._image)
        return self._value.clone(), self._slope.clone()  # a replay writes into the same memory

    def _suits(self, image: Tensor) -> bool:
        own = self._image
        return (own.shape, own.device, own.dtype) == (image.shape, image.device, image.dtype)

    def _work(self, plain: Plain) -> None:
        image = self._image.detach().requires_grad_()
        with torch.enable_grad():
            value = plain(image, self._numbers)
        (self._slope,) = torch.autograd.grad(value, image)
        self._value = value.detach()


class _WithSlope(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, image: Tensor, found: Callable[[], tuple[Tensor, Tensor]]) -> Tensor:
        value, slope = found()
        ctx.save_for_backward(slope)
        return value

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad_out: Tensor) -> tuple[Tensor | None, ...]:
        (slope,) = ctx.saved_tensors
        return slope * grad_out, None
