"""Luminance of colours, which is all that one ink can show."""

import torch
from torch import Tensor


def luminance(images: Tensor) -> Tensor:
    """Return the luma (..., 1, H, W) of sRGB images (..., 3, H, W) (Rec. 709)."""
    shares = torch.tensor([0.2126, 0.7152, 0.0722], dtype=images.dtype, device=images.device)
    return torch.einsum("...chw,c->...hw", images, shares).unsqueeze(-3)
