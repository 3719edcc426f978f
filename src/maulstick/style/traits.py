"""Traits of a stroke that a hand is known by at a glance: how long it is, how far its ends are apart, how it turns."""

import torch
from torch import Tensor

from maulstick.style import _shape

_SHORTEST = 1e-9  # metres: keeps a stroke without length out of roots and denominators
_FLAT = 1e-3  # of a stroke's mean step, squared: below, turning has no slope


def path_length(paths: Tensor) -> Tensor:
    """Return the length (N,) of each path (N, n, 2), metres."""
    sloped = paths.requires_grad and torch.is_grad_enabled()
    if sloped or paths.device.type != "cpu" or paths.dtype != torch.float32:
        return plain_path_length(paths)
    lengths = paths.new_empty(len(paths))
    _shape.path_lengths(paths.detach().contiguous().numpy(), lengths.numpy())
    return lengths


def plain_path_length(paths: Tensor) -> Tensor:
    """Return the same as `path_length`, plainly: on any device, in any precision, with slopes."""
    return _norm(paths.diff(dim=1)).sum(1)


def quantiles(count: int) -> Tensor:
    """Return the quantiles (count,) that so many values stand for, ascending."""
    return (torch.arange(count, dtype=torch.float64) + 0.5) / count


def chord_and_turning(paths: Tensor) -> Tensor:
    """Return, for each path (N, n, 2), chord over length and absolute turning in radians, (N, 2); differentiable."""
    steps = paths.diff(dim=1)
    steps = steps / _norm(steps).mean(dim=1)[:, None, None]
    before, after = steps[:, :-1], steps[:, 1:]
    across = before[..., 0] * after[..., 1] - before[..., 1] * after[..., 0]
    turning = torch.atan2((across.square() + _FLAT**2).sqrt(), (before * after).sum(-1)).sum(1)
    return torch.stack([_norm(steps.mean(dim=1)), turning], dim=1)


def _norm(steps: Tensor) -> Tensor:
    return (steps.square().sum(-1) + _SHORTEST**2).sqrt()
