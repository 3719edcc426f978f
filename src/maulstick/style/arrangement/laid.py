"""Strokes where they lie, and numbers of each of them among those near it: differentiable."""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import shapely
import torch
from scipy.spatial import cKDTree
from torch import Tensor
from torch.autograd.function import once_differentiable

from maulstick.storage.arrays import Floats, Ints
from maulstick.style.arrangement import _neighbourhoods
from maulstick.style.traits import path_length

NEAREST = 4
"""So many strokes are near one; there must be more."""

_LEAST = 0.005  # of the median length: nearer centres and lines are as near, and offsets have no direction
_CORNERS = 16  # of a line that gaps are measured to, and from every other of them
_NUMBERS = 5 * NEAREST + 3


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
        lengths = path_length(paths).double()
        paths, centres, angles = paths.double(), centres.double(), angles.double()
        away = paths - paths.mean(dim=1, keepdim=True)
        x, y = away.unbind(dim=-1)
        along, across = (x.square() - y.square()).sum(dim=1), 2 * (x * y).sum(dim=1)
        straightness = torch.hypot(along, across) / away.square().sum((1, 2))
        corners = torch.linspace(0, paths.shape[1] - 1, _CORNERS).round().long()
        x, y, cos, sin = x[:, corners], y[:, corners], angles.cos()[:, None], angles.sin()[:, None]
        points = centres[:, None] + torch.stack([cos * x - sin * y, sin * x + cos * y], dim=-1)
        return cls(points, centres, torch.atan2(across, along) / 2 + angles, straightness, lengths)

    def density(self) -> float:
        """Return strokes per square of their median length, where there are any within half of it."""
        unit = float(self.lengths.median())
        lines = shapely.linestrings(self.points.detach().numpy())
        near = shapely.union_all(shapely.buffer(lines, unit / 2, quad_segs=2))
        return len(lines) * unit**2 / float(shapely.area(near))


def describe(laid: Laid, unit: float) -> Tensor:
    """Return numbers of strokes among those near them, (N, 23).

    Five for each of the four strokes with the nearest centres, the nearest first: log distance; λλ' cos 2Δθ and
    λλ' |sin 2Δθ|, of straightness λ and axes θ; (along - across) / (along + across) of the offset in the stroke's
    frame; |log ratio of lengths|. Then of the log gap to the nearest other stroke: mean, least, and standard deviation
    along the stroke.
    """
    given = laid.points, laid.centres, laid.axes, laid.straightness, laid.lengths
    numbers: Tensor = _Described.apply(unit, *(tensor.contiguous() for tensor in given))
    return numbers


class _Described(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, unit: float, *given: Tensor) -> Tensor:
        count, beside = len(given[0]), _beside(given[1])
        numbers, gaps = given[0].new_empty(count, _NUMBERS), given[0].new_empty(count, _CORNERS // 2)
        sides = torch.empty_like(gaps, dtype=torch.int64)
        arrays = [tensor.detach().numpy() for tensor in (beside, *given, numbers, sides, gaps)]
        _neighbourhoods.describe(unit, _LEAST, *arrays)
        ctx.unit = unit
        ctx.save_for_backward(beside, *given, numbers, sides, gaps)
        return numbers

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad_out: Tensor) -> tuple[Tensor | None, ...]:
        known = [tensor.detach() for tensor in (*ctx.saved_tensors, grad_out.contiguous())]
        slopes = [torch.zeros_like(tensor) for tensor in known[1:6]]
        _neighbourhoods.describe_backward(ctx.unit, _LEAST, *(tensor.numpy() for tensor in (*known, *slopes)))
        return None, *slopes


def plain_describe(laid: Laid, unit: float) -> Tensor:
    """Return the same as `describe`, plainly."""
    near = _beside(laid.centres)
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


def _beside(centres: Tensor) -> Tensor:
    """Return the strokes with the nearest centres, the nearest first, (N, 4), by centres (N, 2)."""
    places = centres.detach().numpy()
    nearest = np.asarray(cKDTree(places).query(places, NEAREST + 1)[1], dtype=np.int64)
    itself = nearest == np.arange(len(places))[:, None]
    itself[:, -1] |= ~itself.any(axis=1)  # where so many have the same centre that the stroke is not even among them
    return torch.from_numpy(nearest[~itself].reshape(-1, NEAREST))


def distance(log_distance: Tensor) -> Tensor:
    """Return the distance, median lengths, whose logarithm `describe` gave: that one never falls below `_LEAST`."""
    return ((2 * log_distance).exp() - _LEAST**2).clamp(min=0).sqrt()


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
    _neighbourhoods.nearest(np.ascontiguousarray(points), found)
    nearest = found.ravel()
    return nearest // _CORNERS, nearest % _CORNERS
