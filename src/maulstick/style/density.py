"""Kernel density estimate: a mixture of Gaussians, one around each sample."""

from dataclasses import dataclass
from functools import cached_property
from math import log

import numpy as np
import torch
from torch import Tensor

from maulstick.storage.arrays import Floats

_POOLED = 0.8  # weight of the pooled correlation beside that of the few samples; chosen by benchmarks/style_choices.py
_LEAST_SPREAD = 0.02  # of the pooled spread: keeps a number that never varies from a covariance without inverse


@dataclass(frozen=True)
class Density:
    """Gaussians around centres (M, d) with one covariance (d, d), which each centre scales by its scales (M, d)."""

    centres: Tensor
    scales: Tensor
    covariance: Tensor

    def cost(self, points: Tensor) -> tuple[Tensor, Tensor]:
        """Return the cost (N,), nats, of points (N, d), and the index of the centre nearest to each, (N,).

        A cost is the soft minimum over the centres of half the squared distance in spreads, at most log M at a centre.
        All kernels have the same height, so that a narrow one does not dominate.
        """
        apart = self._apart(points)
        return log(len(self.centres)) - torch.logsumexp(-apart / 2, dim=1), apart.detach().argmin(dim=1)

    def nearest(self, points: Tensor) -> Tensor:
        """Index of the centre nearest to each of the points (N, d), (N,)."""
        return self._apart(points).argmin(dim=1)

    def _apart(self, points: Tensor) -> Tensor:
        points = points.double()
        squares = (points[:, :, None] * points[:, None, :]).flatten(1)
        quadratic, linear, constant = self._terms
        return (squares @ quadratic - 2 * points @ linear + constant).clamp(min=0)

    @cached_property
    def _terms(self) -> tuple[Tensor, Tensor, Tensor]:
        """Terms of (x - c)ᵀ P (x - c), multiplied out so that all distances are one product of matrices."""
        inverse = torch.linalg.inv(self.covariance)
        precisions = inverse / (self.scales[:, :, None] * self.scales[:, None, :])
        linear = torch.einsum("mij,mj->im", precisions, self.centres)
        return precisions.flatten(1).T.contiguous(), linear, (linear.T * self.centres).sum(1)


def kernel(centres: Floats, pooled: Floats) -> Floats:
    """Covariance (d, d) of few samples (M, d) of one hand, regularised by the covariance `pooled` of many hands.

    Correlations are a weighted mean of the hand's and the pooled ones. Spreads are the geometric mean of the hand's
    and the pooled ones, which are first scaled to the hand's.
    """
    own = np.cov(centres, rowvar=False)
    others = np.sqrt(np.diag(pooled))
    spread = np.maximum(np.sqrt(np.diag(own)), _LEAST_SPREAD * others)
    scale = np.exp(np.mean(np.log(spread / others)))
    correlation = (1 - _POOLED) * own / np.outer(spread, spread) + _POOLED * pooled / np.outer(others, others)
    np.fill_diagonal(correlation, 1)
    both = np.sqrt(spread * scale * others)
    covariance: Floats = correlation * np.outer(both, both)
    return covariance
