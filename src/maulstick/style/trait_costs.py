"""Costs of strokes whose traits are distributed otherwise than those of a hand."""

from typing import Any

import torch
from torch import Tensor
from torch.autograd.function import once_differentiable

from maulstick.style import _shape, shape
from maulstick.style.shape import GIST
from maulstick.style.traits import chord_and_turning

_LEAST_CHORD = 0.01  # over length: keeps the log odds of closed and of straight strokes finite
_LEAST_RESIDUAL = 1e-4  # keeps the logarithm of a residual of 0 finite


def gist_and_roughness(gist: Tensor, residual: Tensor) -> Tensor:
    """Return what a stroke's likelihood depends on, (N, 17): its gist, and the logarithm of its residual's size.

    gist: (N, 16).  residual: (N, 47).
    """
    return torch.cat([gist, roughness(residual)], dim=1)


def roughness(residual: Tensor) -> Tensor:
    """Return the logarithm of the size of residuals (N, 47), (N, 1)."""
    return (residual.square().sum(1, keepdim=True) + _LEAST_RESIDUAL**2).log() / 2


def traits(seen: Tensor, strays: Tensor) -> Tensor:
    """Return what a plan's strokes are to have in the hand's distribution, (N, 19).

    These are gist, roughness, the log odds of chord over length, whose hands of closed and of straight strokes differ
    by little near 0 and 1, and absolute turning.

    seen: (N, 17), as `gist_and_roughness` returns it.  strays: (N, 2, 32), as `shape.strays` does.
    """
    chord, turning = chord_and_turning(shape.drawn(seen[:, :GIST], strays)).unbind(dim=1)
    odds = (chord + _LEAST_CHORD) / (1 - chord + _LEAST_CHORD)
    return torch.cat([seen, odds.log()[:, None], turning[:, None]], dim=1)


def trait_costs(seen: Tensor, strays: Tensor, wanted: Tensor, widths: Tensor) -> Tensor:
    """Return half the squared distance (N,) of strokes' traits from those of the same ranks that are wanted.

    So each trait is to be distributed as wanted (squared distance of sorted values, Wasserstein's in one dimension).

    seen: (N, 17).  strays: (N, 2, 32).  wanted: (N, 19), ascending in each column.  widths: (19,), units of distance.
    """
    if seen.device.type == "cpu" and seen.dtype == torch.float32:
        costs: Tensor = _TraitCosts.apply(seen.contiguous(), strays.contiguous(), wanted.contiguous(), widths)
        return costs
    return plain_trait_costs(seen, strays, wanted, widths)


def plain_trait_costs(seen: Tensor, strays: Tensor, wanted: Tensor, widths: Tensor) -> Tensor:
    """Return the same as `trait_costs`, plainly: on any device, in any precision."""
    found = traits(seen, strays).double()
    order = found.detach().argsort(dim=0, stable=True)
    apart = (found - torch.empty_like(wanted).scatter_(0, order, wanted)) / widths
    return (apart.square().sum(1) / 2).to(seen)


class _TraitCosts(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, seen: Tensor, strays: Tensor, wanted: Tensor, widths: Tensor) -> Tensor:
        costs, of_seen = seen.new_empty(len(seen)), torch.empty_like(seen)
        of_strays = strays.new_empty(len(strays) if ctx.needs_input_grad[1] else 0, *strays.shape[1:])
        given, found = (seen.detach(), strays.detach()), (costs, of_seen, of_strays)
        asked = wanted.numpy(), widths.numpy()
        _shape.trait_costs(*(x.numpy() for x in given), *shape.bases(), *asked, *(x.numpy() for x in found))
        ctx.save_for_backward(of_seen, of_strays)
        return costs

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad_out: Tensor) -> tuple[Tensor | None, ...]:
        of_seen, of_strays = ctx.saved_tensors
        wanted = ctx.needs_input_grad[1]
        return grad_out[:, None] * of_seen, grad_out[:, None, None] * of_strays if wanted else None, None, None
