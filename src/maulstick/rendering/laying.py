"""Trajectories of standardised paths, laid where they are to be drawn."""

from typing import Any

import torch
from torch import Tensor
from torch.autograd.function import once_differentiable

from maulstick.rendering import _laying


def place(paths: Tensor, poses: Tensor) -> Tensor:
    """Return commanded paths R(dθ)(x, y) + (dx, dy), (N, n, 2) metres, of standardised paths and poses (N, 3)."""
    cos, sin = poses[:, 2:3].cos(), poses[:, 2:3].sin()
    x, y = paths.unbind(-1)
    return torch.stack([cos * x - sin * y + poses[:, :1], sin * x + cos * y + poses[:, 1:2]], dim=-1)


def poses_of(paths: Tensor, centres: Tensor, angles: Tensor) -> Tensor:
    """Return the poses (N, 3), Δ = (Δx, Δy, Δθ), that turn paths by angles (N,), and lay their middles at centres.

    paths: (N, n, 2), standardised, and centres: (N, 2), metres.
    """
    turned = torch.cat([torch.zeros_like(centres), angles[:, None]], dim=1)
    return torch.cat([centres - place(paths, turned).mean(dim=1), angles[:, None]], dim=1)


def laid(paths: Tensor, centres: Tensor, angles: Tensor, pressure: Tensor) -> Tensor:
    """Return commanded trajectories (N, n, 3) of paths that lie as `poses_of` says: x, y in metres, and pressure.

    pressure: (N, n), in [0, 1].
    """
    given = paths, centres, angles, pressure
    if all(tensor.device.type == "cpu" and tensor.dtype == torch.float32 for tensor in given):
        trajectories: Tensor = _Laid.apply(*(tensor.contiguous() for tensor in given))
        return trajectories
    return plain_laid(*given)


def plain_laid(paths: Tensor, centres: Tensor, angles: Tensor, pressure: Tensor) -> Tensor:
    """Return the same as `laid`, plainly: on any device, in any precision."""
    return torch.cat([place(paths, poses_of(paths, centres, angles)), pressure[..., None]], dim=-1)


def extents(trajectories: Tensor) -> tuple[Tensor, Tensor]:
    """Return the least and the most x and y of trajectories (N, n, 3), (N, 2) each, without gradients."""
    if trajectories.device.type != "cpu" or trajectories.dtype != torch.float32:
        return plain_extents(trajectories)
    least, most = (trajectories.new_empty(len(trajectories), 2) for _ in range(2))
    _laying.extents(trajectories.detach().contiguous().numpy(), least.numpy(), most.numpy())
    return least, most


def plain_extents(trajectories: Tensor) -> tuple[Tensor, Tensor]:
    """Return the same as `extents`, plainly: on any device, in any precision."""
    paths = trajectories.detach()[..., :2]
    return paths.amin(dim=1), paths.amax(dim=1)


class _Laid(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, *given: Tensor) -> Tensor:
        paths, _, angles, _ = given
        ctx.save_for_backward(paths, angles)
        trajectories = paths.new_empty(*paths.shape[:2], 3)
        _laying.lay(*(tensor.detach().numpy() for tensor in given), trajectories.numpy())
        return trajectories

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad_out: Tensor) -> tuple[Tensor, ...]:
        paths, angles = (tensor.detach() for tensor in ctx.saved_tensors)
        of_poses = angles.new_empty(len(angles), 2), torch.empty_like(angles)
        slopes = torch.empty_like(paths), *of_poses, paths.new_empty(paths.shape[:2])
        _laying.lay_backward(*(tensor.numpy() for tensor in (paths, angles, grad_out.contiguous(), *slopes)))
        return slopes
