"""Fast renderer for the tensors' device: `gpu` on a GPU, else `cpu`."""

from types import ModuleType

import torch
from torch import Tensor

from maulstick.rendering.kernels import cpu


def darkness(
    points: Tensor, thickness: Tensor, falloff: Tensor, plateau: Tensor, opacity: Tensor, *, height: int, width: int
) -> Tensor:
    """Draw each stroke alone on an image of its own, as `reference.darkness` does; float32.

    All tensors are on one device; so is the result.
    """
    kernels = kernels_for(points.device)
    images: Tensor = kernels.darkness(points, thickness, falloff, plateau, opacity, height=height, width=width)
    return images


def composite(
    canvas: Tensor,
    points: Tensor,
    thickness: Tensor,
    colours: Tensor,
    falloff: Tensor,
    plateau: Tensor,
    opacity: Tensor,
    *,
    trainable: Tensor | None = None,
) -> Tensor:
    """Paint all strokes onto one canvas in order, as `reference.composite` does; float32.

    All tensors are on one device; so is the result.
    """
    kernels = kernels_for(points.device)
    painted: Tensor = kernels.composite(
        canvas, points, thickness, colours, falloff, plateau, opacity, trainable=trainable
    )
    return painted


def kernels_for(device: torch.device) -> ModuleType:
    """Return the module that renders on this device."""
    if device.type != "cuda":
        return cpu
    from maulstick.rendering.kernels import gpu  # needs Triton, which may be missing where there is no GPU

    return gpu
