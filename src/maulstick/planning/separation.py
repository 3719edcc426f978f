"""Separation of an image into inks: how much of each place each of them covers."""

from collections.abc import Sequence

import torch
from torch import Tensor

from maulstick.planning.problem import Colour

_MOST_ROUNDS = 300  # over all inks: alike ones settle slowly
_SETTLED = 2e-4  # of a pixel, in a round
_STEPS = 255  # of each channel that are told apart, of several inks


def separated(image: Tensor, paper: Tensor, inks: Sequence[Colour]) -> Tensor:
    """Return how much of each place of an image (C, H, W) each of the inks covers on the paper (C, H, W), (k, H, W).

    Seen from afar, lines side by side mix as the shares of what they cover: image = paper + sum of a (ink - paper).
    The shares a >= 0 are those of least squares, found ink by ink; where their sum is above 1 all are divided by it.
    Inks unlike the paper come first, so that of all ways to mix a grey that of few lines is found.
    """
    colours, pixels = torch.tensor(inks).to(paper), torch.cat([image, paper]).flatten(1)
    if len(inks) == 1:
        return _amounts(pixels, colours).reshape(-1, *image.shape[1:])
    steps = (pixels * _STEPS).round().clamp(0, _STEPS).long()
    places = (_STEPS + 1) ** torch.arange(len(steps), device=steps.device)
    alike, which = (steps * places[:, None]).sum(dim=0).unique(return_inverse=True)
    pixels = (alike // places[:, None] % (_STEPS + 1)).to(paper) / _STEPS
    return _amounts(pixels, colours)[:, which].reshape(-1, *image.shape[1:])


def _amounts(pixels: Tensor, inks: Tensor) -> Tensor:
    """Return how much of pixels, their colour above that of the paper (2 C, P), each of the inks (k, C) covers."""
    image, paper = pixels.chunk(2)
    full = inks[:, :, None] - paper
    squares = (full[:, None] * full[None]).sum(dim=2)
    wanted = ((image - paper) * full).sum(dim=1)
    strongest = squares.diagonal().mean(dim=0).argsort(descending=True, stable=True).tolist()
    amounts = torch.zeros_like(wanted)
    for _ in range(_MOST_ROUNDS if len(inks) > 1 else 1):
        before = amounts.clone()
        for own in strongest:
            missing = wanted[own].clone()
            for other in strongest:
                if other != own:
                    missing -= amounts[other] * squares[other, own]
            amounts[own] = (missing / squares[own, own].clamp(min=1e-9)).clamp(0, 1)
        if (amounts - before).abs().max() < _SETTLED:
            break
    return amounts / amounts.sum(dim=0).clamp(min=1)
