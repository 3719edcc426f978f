"""Kernel density estimate: a mixture of Gaussians, one around each sample."""

from dataclasses import dataclass
from functools import cached_property
from math import log
from typing import Any, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.autograd.function import once_differentiable
from torch.nn.functional import one_hot

from maulstick.storage.arrays import Floats
from maulstick.style import _density

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
        if points.device.type == "cpu":
            costs, nearest = _Cost.apply(points.double().contiguous(), self._arrays)
            return log(len(self.centres)) + costs, nearest
        return self.plain_cost(points)

    def plain_cost(self, points: Tensor) -> tuple[Tensor, Tensor]:
        """Return the same as `cost`, plainly: on any device."""
        apart = self._apart(points)
        return log(len(self.centres)) - torch.logsumexp(-apart / 2, dim=1), apart.detach().argmin(dim=1)

    def nearest(self, points: Tensor) -> Tensor:
        """Index of the centre nearest to each of the points (N, d), (N,)."""
        return self._apart(points).argmin(dim=1)

    def _apart(self, points: Tensor) -> Tensor:
        points = points.double()
        terms = self._terms
        inside = points[:, None] * one_hot(terms.group).T  # (N, k, d), a point's numbers of one group each
        squares = (inside @ terms.inverse @ inside.mT).flatten(1)
        return (squares @ terms.weights - 2 * points @ terms.linear + terms.constant).clamp(min=0)

    @cached_property
    def _terms(self) -> "_Terms":
        columns, group = self.scales.unique(dim=1, return_inverse=True)
        inverse = torch.linalg.inv(self.covariance)
        weights = 1 / (columns.T[:, None] * columns.T[None])
        scaled = self.centres / self.scales
        linear = (scaled @ inverse) / self.scales
        return _Terms(inverse, group, weights.flatten(0, 1), linear.T.contiguous(), (linear * self.centres).sum(1))

    @cached_property
    def _arrays(self) -> tuple[NDArray[Any], ...]:
        terms = self._terms
        rows = torch.cat([terms.weights, -2 * terms.linear, terms.constant[None]])
        return terms.inverse.numpy(), terms.group.numpy(), rows.numpy()


class _Terms(NamedTuple):
    """Terms of (x - c)ᵀ P (x - c), multiplied out: P is the inverse of the covariance over a centre's scales.

    Numbers whose scales are alike at each centre are of one group, so that few products of points serve all centres.

    inverse: (d, d).  group: (d,), of k.  weights: (k², M), one over the scales of two groups.  linear: (d, M).
    constant: (M,).
    """

    inverse: Tensor
    group: Tensor
    weights: Tensor
    linear: Tensor
    constant: Tensor


class _Cost(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, points: Tensor, terms: tuple[NDArray[Any], ...]) -> tuple[Tensor, Tensor]:
        costs, slopes = points.new_empty(len(points)), torch.empty_like(points)
        nearest = torch.empty(len(points), dtype=torch.long)
        _density.cost(points.detach().numpy(), *terms, costs.numpy(), nearest.numpy(), slopes.numpy())
        ctx.save_for_backward(slopes)
        ctx.mark_non_differentiable(nearest)
        return costs, nearest

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad_out: Tensor, _: Tensor) -> tuple[Tensor, None]:
        (slopes,) = ctx.saved_tensors
        return grad_out[:, None] * slopes, None


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
