"""Edges: a loss that compares where the edges of canvas and picture lie."""

import math

import torch
from torch import Tensor
from torch.nn.functional import pad

from maulstick.planning.objectives import _edges
from maulstick.planning.objectives.fused import Recorded, fused, has_native
from maulstick.planning.objectives.luminance import luminance
from maulstick.planning.objectives.objective import Objective
from maulstick.planning.objectives.pyramid import halved

_LEVELS = 3  # levels of the pyramid: edges of one, two and four pixels of the finest
_LARGEST_PX = 512  # longest side of the finest level: on a finer one, single lines would count as edges
_FAINTEST = 1e-4  # squared slope of luminance, per pixel²: below 1 % of contrast per pixel, a place counts as flat


class Edges(Objective):
    """One minus the local correlation of the slopes of luminance, of the canvas with those of the target (3, H, W).

    weights: (H, W), how much each pixel counts.

    The correlation is normalised in a window of a few pixels, so that any edge of the same place and direction matches
    a soft edge. Strong edges of the target matter most, flat places little, but enough to keep them flat. The three
    levels of a pyramid count alike; the finest has at most 512 pixels a side, since on larger
    ones single lines would be edges.
    """

    def __init__(self, target: Tensor, weights: Tensor) -> None:
        self._halvings = max(0, math.ceil(math.log2(max(weights.shape) / _LARGEST_PX)))
        self._wanted: list[tuple[Tensor, Tensor, Tensor]] = []
        self._recorded = Recorded()
        for image, counts in zip(self._pyramid(luminance(target)), self._pyramid(weights[None]), strict=True):
            slopes = _slopes(image)
            energy = _windowed(slopes, slopes)
            shares = halved(halved(counts)) * energy.sqrt()
            self._wanted.append((slopes, energy, shares / shares.sum().clamp(min=1e-30)))

    @property
    def name(self) -> str:
        """Name of the term: ``edges``."""
        return "edges"

    def loss(self, canvas: Tensor, progress: float) -> Tensor:
        """Return 0 for the target, about 1 for blank paper, 2 for the target's negative; the same at any progress."""
        image = luminance(canvas)
        if not has_native(image):
            return self._recorded(lambda image, _: self.plain_loss(image), image)
        wanted, energies, shares = ([each.numpy() for each in kind] for kind in zip(*self._wanted, strict=True))
        known = self._halvings, wanted, energies, shares, _FAINTEST
        return fused(image, lambda luma, slope: _edges.uncorrelated(luma, *known, slope))

    def plain_loss(self, image: Tensor) -> Tensor:
        """Return the same of luminance (1, H, W), plainly: on any device, in any precision."""
        losses = []
        for level, (wanted, wanted_energy, shares) in zip(self._pyramid(image), self._wanted, strict=True):
            slopes = _slopes(level)
            correlation = _windowed(slopes, wanted) / (_windowed(slopes, slopes) * wanted_energy).sqrt()
            losses.append((shares * (1 - correlation)).sum())
        return torch.stack(losses).mean()

    def _pyramid(self, image: Tensor) -> list[Tensor]:
        """Return the levels, finest first, of an image (1, H, W)."""
        for _ in range(self._halvings):
            image = halved(image)
        levels = [image]
        for _ in range(_LEVELS - 1):
            levels.append(halved(levels[-1]))
        return levels


def _slopes(image: Tensor) -> Tensor:
    """Return slopes per pixel along x and y, (2, H, W), of an image (1, H, W) (Sobel)."""
    padded = pad(image, (1, 1, 1, 1), mode="replicate")[0]
    down = padded[:-2] + 2 * padded[1:-1] + padded[2:]
    across = padded[:, :-2] + 2 * padded[:, 1:-1] + padded[:, 2:]
    return torch.stack([down[:, 2:] - down[:, :-2], across[2:] - across[:-2]]) / 8


def _windowed(slopes: Tensor, others: Tensor) -> Tensor:
    """Return the average of the slopes' products in windows four pixels apart, plus a little, so that it is never 0."""
    return halved(halved((slopes * others).sum(dim=0, keepdim=True))) + _FAINTEST
