"""How strokes lie to those near them, and how far their distribution is from a hand's: differentiable."""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
import torch
from scipy.spatial import cKDTree
from torch import Generator, Tensor
from torch.nn.functional import normalize

from maulstick.style.hand import quantiles
from maulstick.style.traits import path_length

NEAREST = 4
"""So many strokes are near one; there must be more."""

_DIRECTIONS = 24  # that distributions are compared along, others at each call
_LEAST = 0.005  # of the median length: nearer centres are as near, and offsets have no direction
_LEAST_SPREAD = 0.1  # of any number: where all strokes of a hand lie alike


@dataclass(frozen=True)
class Laid:
    """N strokes as far as their arrangement depends on them.

    centres: (N, 2).  axes: (N,), angles of principal axes, radians.  straightness: (N,) in [0, 1].  lengths: (N,).
    """

    centres: Tensor
    axes: Tensor
    straightness: Tensor
    lengths: Tensor

    @classmethod
    def of(cls, paths: Tensor, centres: Tensor, angles: Tensor) -> Self:
        """Return paths (N, n, 2) of any pose turned by angles (N,) about their middles, which lie at centres (N, 2)."""
        paths, centres, angles = paths.double(), centres.double(), angles.double()
        away = paths - paths.mean(dim=1, keepdim=True)
        x, y = away.unbind(dim=-1)
        along, across = (x.square() - y.square()).sum(dim=1), 2 * (x * y).sum(dim=1)
        straightness = torch.hypot(along, across) / away.square().sum((1, 2))
        return cls(centres, torch.atan2(across, along) / 2 + angles, straightness, path_length(paths))


@dataclass(frozen=True)
class Neighbourhoods:
    """Distribution of a hand's neighbourhoods: M strokes, each with those near it.

    numbers: (M, d) by `describe`.  unit: of length, metres.
    """

    numbers: Tensor
    unit: float

    @classmethod
    def of(cls, laid: Laid) -> Self:
        """Return those of a hand's strokes."""
        unit = float(laid.lengths.median())
        return cls(describe(laid, unit), unit)

    @cached_property
    def _spread(self) -> Tensor:
        return self.numbers.std(dim=0).clamp(min=_LEAST_SPREAD)

    @cached_property
    def usual(self) -> float:
        """How far the neighbourhoods of two random halves of the hand's strokes are from each other."""
        generator = torch.Generator().manual_seed(0)
        order = torch.randperm(len(self.numbers), generator=generator)
        half = len(order) // 2
        return float(self._apart(self.numbers[order[:half]], self.numbers[order[half:]], generator))

    def price(self, laid: Laid, generator: Generator) -> Tensor:
        """Return how far the strokes' neighbourhoods are from the hand's: sliced squared Wasserstein distance."""
        return self._apart(describe(laid, self.unit), self.numbers, generator)

    def _apart(self, numbers: Tensor, others: Tensor, generator: Generator) -> Tensor:
        directions = torch.randn(numbers.shape[1], _DIRECTIONS, generator=generator, dtype=torch.float64)
        directions = normalize(directions, dim=0) / self._spread[:, None]
        drawn = (numbers @ directions).sort(dim=0).values
        wanted = torch.quantile(others @ directions, quantiles(len(drawn)), dim=0)
        return (drawn - wanted).square().mean()


def describe(laid: Laid, unit: float) -> Tensor:
    """Return five numbers for each of the four strokes with the nearest centres, the nearest first, (N, 20).

    Log distance, less the mean of all; λλ' cos 2Δθ and λλ' |sin 2Δθ|, of straightness λ and axes θ;
    (along - across) / (along + across) of the offset in the stroke's frame; |log ratio of lengths|.
    """
    centres = laid.centres.detach().numpy()
    near = torch.from_numpy(np.asarray(cKDTree(centres).query(centres, NEAREST + 1)[1])[:, 1:])
    offsets = (laid.centres[near] - laid.centres[:, None]) / unit
    distances = (offsets.square().sum(dim=-1) + _LEAST**2).sqrt()
    turned, both = laid.axes[near] - laid.axes[:, None], laid.straightness[:, None] * laid.straightness[near]
    axes = torch.stack([laid.axes.cos(), laid.axes.sin()], dim=-1)[:, None]
    along = (offsets * axes).sum(dim=-1).abs()
    across = (offsets[..., 0] * axes[..., 1] - offsets[..., 1] * axes[..., 0]).abs()
    lengths = laid.lengths.log()
    numbers = [
        distances.log() - distances.log().mean(),  # how dense they are is the picture's
        both * (2 * turned).cos(),
        both * (2 * turned).sin().abs(),
        (along - across) / (along + across + _LEAST),
        (lengths[near] - lengths[:, None]).abs(),
    ]
    return torch.cat(numbers, dim=1)
