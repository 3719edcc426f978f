"""How strokes lie to those near them, and how far their distribution is from a hand's: differentiable."""

from dataclasses import dataclass, replace
from functools import cached_property
from math import log
from typing import Self

import torch
from torch import Generator, Tensor
from torch.nn.functional import normalize

from maulstick.style.arrangement.laid import NEAREST, Laid, describe
from maulstick.style.traits import quantiles

MEAN_GAP, LEAST_GAP = -3, -2
"""Columns of the mean and the least log gap, median lengths."""

_DIRECTIONS = 24  # that distributions are compared along, others at each call
_LEAST_SPREAD = 0.1  # of any number: where all strokes of a hand lie alike


@dataclass(frozen=True)
class Neighbourhoods:
    """Distribution of a hand's neighbourhoods: M strokes, each with those near it.

    numbers: (M, d) by `describe`.  unit: of length, metres.  density: as `Laid.density`.
    """

    numbers: Tensor
    unit: float
    density: float

    @classmethod
    def of(cls, laid: Laid) -> Self:
        """Return those of a hand's strokes."""
        unit = float(laid.lengths.median())
        return cls(describe(laid, unit), unit, laid.density())

    @cached_property
    def _spread(self) -> Tensor:
        return self.numbers.std(dim=0).clamp(min=_LEAST_SPREAD)

    def crowded(self, density: float) -> Self:
        """Return those of the same hand where it must draw so densely, if that is more than it does by itself.

        Lines are nearer in the ratio of densities then, and centres in its square root.
        """
        crowding = log(max(1.0, density / self.density))
        nearer = torch.zeros(self.numbers.shape[1], dtype=torch.float64)
        nearer[:NEAREST] = crowding / 2
        nearer[[MEAN_GAP, LEAST_GAP]] = crowding
        return replace(self, numbers=self.numbers - nearer)

    def price(self, laid: Laid, generator: Generator) -> Tensor:
        """Return how far the strokes' neighbourhoods are from the hand's: sliced squared Wasserstein distance."""
        return self._apart(describe(laid, self.unit), self.numbers, generator)

    def _apart(self, numbers: Tensor, others: Tensor, generator: Generator) -> Tensor:
        directions = torch.randn(numbers.shape[1], _DIRECTIONS, generator=generator, dtype=torch.float64)
        directions = normalize(directions, dim=0) / self._spread[:, None]
        drawn = (numbers @ directions).sort(dim=0).values
        wanted = torch.quantile(others @ directions, quantiles(len(drawn)), dim=0)
        return (drawn - wanted).square().mean()
