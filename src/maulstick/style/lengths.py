"""Lengths of strokes, held as a hand's."""

import torch
from torch import Tensor

from maulstick.style.style import Style
from maulstick.style.traits import path_length


@torch.no_grad()
def keep_lengths(codes: Tensor, style: Style, lengths: Tensor) -> None:
    """Give the strokes of these codes (N, K) the lengths (N,), metres, ascending, by their ranks."""
    own = path_length(style.decode(codes))
    style.resize(codes, lengths[own.argsort(stable=True).argsort()], own)
