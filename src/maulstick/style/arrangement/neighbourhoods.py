"""How strokes lie to those near them, and how far their distribution is from a hand's: differentiable."""

from dataclasses import dataclass, replace
from functools import cached_property
from math import log
from typing import Self

import numpy as np
import shapely
import torch
from scipy.spatial import cKDTree
from torch import Generator, Tensor
from torch.nn.functional import normalize

from maulstick.storage.arrays import Floats, Ints
from maulstick.style.arrangement import _corners
from maulstick.style.traits import path_length, quantiles

NEAREST = 4
"""So many strokes are near one; there must be more."""

MEAN_GAP, LEAST_GAP = -3, -2
"""Columns of the mean and the least log gap, median lengths."""

_DIRECTIONS = 24  # that distributions are compared along, others at each call
_LEAST = 0.005  # of the median length: nearer centres and lines are as near, and offsets have no direction
_LEAST_SPREAD = 0.1  # of any number: where all strokes of a hand lie alike
_CORNERS = 16  # of a line that gaps are measured to, and from every other of them


@dataclass(frozen=True)
class Laid:
    """N strokes where they lie.

    points: (N, 16, 2), corners of their lines.  centres: (N, 2).  axes: (N,), angles of principal axes, radians.
    straightness: (N,) in [0, 1].  lengths: (N,).
    """

    points: Tensor
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
        corners = torch.linspace(0, paths.shape[1] - 1, _CORNERS).round().long()
        x, y, cos, sin = x[:, corners], y[:, corners], angles.cos()[:, None], angles.sin()[:, None]
        points = centres[:, None] + torch.stack([cos * x - sin * y, sin * x + cos * y], dim=-1)
        return cls(points, centres, torch.atan2(across, along) / 2 + angles, straightness, path_length(paths))

    def density(self) -> float:
        """Return strokes per square of their median length, where there are any within half of it."""
        unit = float(self.lengths.median())
        lines = shapely.linestrings(self.points.detach().numpy())
        near = shapely.union_all(shapely.buffer(lines, unit / 2, quad_segs=2))
        return len(lines) * unit**2 / float(shapely.area(near))


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


def describe(laid: Laid, unit: float) -> Tensor:
    """Return numbers of strokes among those near them, (N, 23).

    Five for each of the four strokes with the nearest centres, the nearest first: log distance; λλ' cos 2Δθ and
    λλ' |sin 2Δθ|, of straightness λ and axes θ; (along - across) / (along + across) of the offset in the stroke's
    frame; |log ratio of lengths|. Then of the log gap to the nearest other stroke: mean, least, and standard deviation
    along the stroke.
    """
    centres = laid.centres.detach().numpy()
    near = torch.from_numpy(np.asarray(cKDTree(centres).query(centres, NEAREST + 1)[1])[:, 1:])
    offsets = (laid.centres[near] - laid.centres[:, None]) / unit
    turned, both = laid.axes[near] - laid.axes[:, None], laid.straightness[:, None] * laid.straightness[near]
    axes = torch.stack([laid.axes.cos(), laid.axes.sin()], dim=-1)[:, None]
    along = (offsets * axes).sum(dim=-1).abs()
    across = (offsets[..., 0] * axes[..., 1] - offsets[..., 1] * axes[..., 0]).abs()
    lengths = laid.lengths.log()
    gaps = _log_distance(_gaps(laid.points) / unit)
    numbers = [
        _log_distance(offsets),
        both * (2 * turned).cos(),
        both * (2 * turned).sin().abs(),
        (along - across) / (along + across + _LEAST),
        (lengths[near] - lengths[:, None]).abs(),
        torch.stack([gaps.mean(dim=1), gaps.amin(dim=1), gaps.std(dim=1)], dim=1),
    ]
    return torch.cat(numbers, dim=1)


def _log_distance(offsets: Tensor) -> Tensor:
    return (offsets.square().sum(dim=-1) + _LEAST**2).log() / 2


def _gaps(points: Tensor) -> Tensor:
    """Return offsets to the nearest line of another stroke from every other corner of each stroke, (N, 8, 2)."""
    ours = points[:, ::2].reshape(-1, 2)
    stroke, corner = _nearest_corners(points.detach().numpy())
    found = []
    for first in (corner - 1, corner):
        first = np.clip(first, 0, _CORNERS - 2)
        start, end = points[stroke, first], points[stroke, first + 1]
        side, away = end - start, ours - start
        share = ((away * side).sum(dim=-1) / side.square().sum(dim=-1).clamp(min=1e-18)).clamp(0, 1)
        found.append(away - share[:, None] * side)
    one, other = found
    nearer = one.square().sum(dim=-1) < other.square().sum(dim=-1)
    return torch.where(nearer[:, None], one, other).reshape(len(points), -1, 2)


def _nearest_corners(points: Floats) -> tuple[Ints, Ints]:
    """Return stroke and corner of another stroke that is nearest to every other corner of points (N, 16, 2), (8 N,)."""
    found = np.empty((len(points), _CORNERS // 2), dtype=np.int64)
    _corners.nearest(np.ascontiguousarray(points), found)
    nearest = found.ravel()
    return nearest // _CORNERS, nearest % _CORNERS
