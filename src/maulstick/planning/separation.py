"""Separation of an image into inks: how much of each place each of them covers."""

from collections.abc import Sequence
from itertools import combinations

import torch
from torch import Tensor

from maulstick.planning.problem import Colour

_STEPS = 255  # of each channel that are told apart, of several inks
_MOST_AT_A_PLACE = 4  # paper and inks: three channels need no more
_FEW_LINES = 1e-5  # of a squared difference: what it costs to cover all of a place, so that few lines are preferred
_RIDGE = 1e-9  # beside squared differences of colours, some of which may be alike


def separated(image: Tensor, paper: Tensor, inks: Sequence[Colour]) -> Tensor:
    """Return how much of each place of an image (C, H, W) each of the inks covers on the paper (C, H, W), (k, H, W).

    Seen from afar, lines side by side mix as the shares of what they cover: image = paper + sum of a (ink - paper).
    The shares are those of least squares with a >= 0 and their sum at most 1; of all ways to mix a colour, the one that
    covers least.
    """
    colours = torch.tensor(inks, dtype=paper.dtype, device=paper.device)
    if len(inks) == 1:
        full = colours[0, :, None, None] - paper
        one = ((image - paper) * full).sum(dim=0) / full.square().sum(dim=0).clamp(min=1e-9)
        return one.clamp(0, 1)[None]
    pixels = torch.cat([image, paper]).flatten(1)
    levels = (pixels * _STEPS).round().clamp(0, _STEPS).long()
    places = (_STEPS + 1) ** torch.arange(len(levels), device=levels.device)
    alike, which = (levels * places[:, None]).sum(dim=0).unique(return_inverse=True)
    apart = (alike // places[:, None] % (_STEPS + 1)).double() / _STEPS
    return _shares(apart, colours.double())[:, which].to(paper).reshape(-1, *image.shape[1:])


def _shares(pixels: Tensor, inks: Tensor) -> Tensor:
    """Return how much of pixels, their colour above that of the paper (2 C, P), each of the inks (k, C) covers.

    The nearest mixture lies in a corner, an edge, a face or the inside of a body whose corners are the paper and inks.
    """
    image, paper = pixels.chunk(2)
    if (paper == paper[:, :1]).all():
        paper = paper[:, :1]
    corners = torch.cat([torch.zeros_like(paper)[None], inks[:, :, None] - paper])
    wanted, count = image - paper, pixels.shape[1]
    least, found = wanted.new_full((count,), torch.inf), wanted.new_zeros(len(corners), count)
    for size in range(1, _MOST_AT_A_PLACE + 1):
        for names in combinations(range(len(corners)), size):
            if size == _MOST_AT_A_PLACE and 0 not in names:
                continue  # bodies that share the corner of the paper fill all that can be mixed
            own = corners[list(names)]
            shares = _nearest(own, wanted)
            cost = (wanted - (shares[:, None] * own).sum(dim=0)).square().sum(dim=0)
            cost += _FEW_LINES * (1 - shares[0] if 0 in names else 1)
            better = ((cost < least) & (shares >= 0).all(dim=0)).nonzero()[:, 0]
            least[better] = cost[better]
            found[:, better] = 0
            for name, share in zip(names, shares, strict=True):
                found[name, better] = share[better]
    return found[1:]


def _nearest(corners: Tensor, wanted: Tensor) -> Tensor:
    """Return the shares (s, P), which are 1 together, of corners (s, C, P or 1) that mix what is nearest to (C, P)."""
    across, left = corners[1:] - corners[0], wanted - corners[0]
    gram = (across[:, None] * across[None]).sum(dim=2).permute(2, 0, 1)
    inverse = torch.linalg.inv(gram + _RIDGE * torch.eye(len(across), dtype=gram.dtype, device=gram.device))
    others = (inverse.permute(1, 2, 0) * (across * left).sum(dim=1)).sum(dim=1)
    return torch.cat([1 - others.sum(dim=0, keepdim=True), others])
