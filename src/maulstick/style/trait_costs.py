"""Costs of strokes whose traits are distributed otherwise than those of a hand."""

from typing import Any

import torch
from torch import Tensor
from torch.autograd.function import once_differentiable

from maulstick.style import _shape, shape
from maulstick.style.traits import chord_and_turning

_LEAST_CHORD = 0.01  # over length: keeps the log odds of closed and of straight strokes finite
_LEAST_RESIDUAL = 1e-4  # keeps the logarithm of a residual of 0 finite


def gist_and_roughness(gist: Tensor, residual: Tensor) -> Tensor:
    """Return what a stroke's likelihood depends on, (N, 17): its gist, and the logarithm of its residual's size.

    gist: (N, 16).  residual: (N, 47).
    """
    squares = residual.square().sum(1, keepdim=True)
    return torch.cat([gist, (squares + _LEAST_RESIDUAL**2).log() / 2], dim=1)


def traits(gist: Tensor, residual: Tensor) -> Tensor:
    """Return what a plan's strokes are to have in the hand's distribution, (N, 19).

    These are gist, roughness, the log odds of chord over length, whose hands of closed and of straight strokes differ
    by little near 0 and 1, and absolute turning.
    """
    chord, turning = chord_and_turning(shape.drawn(gist, residual)).unbind(dim=1)
    odds = (chord + _LEAST_CHORD) / (1 - chord + _LEAST_CHORD)
    return torch.cat([gist_and_roughness(gist, residual), odds.log()[:, None], turning[:, None]], dim=1)


def trait_costs(gist: Tensor, residual: Tensor, wanted: Tensor, widths: Tensor) -> Tensor:
    """Return half the squared distance (N,) of strokes' traits from those of the same ranks that are wanted.

    So each trait is to be distributed as wanted (squared distance of sorted values, Wasserstein's in one dimension).

    gist: (N, 16).  residual: (N, 47).  wanted: (N, 19), ascending in each column.  widths: (19,), units of distance.
    """
    if gist.device.type == "cpu" and gist.dtype == torch.float32 and not residual.requires_grad:
        costs: Tensor = _TraitCosts.apply(gist.contiguous(), residual.contiguous(), wanted.contiguous(), widths)
        return costs
    return plain_trait_costs(gist, residual, wanted, widths)


def plain_trait_costs(gist: Tensor, residual: Tensor, wanted: Tensor, widths: Tensor) -> Tensor:
    """Return the same as `trait_costs`, plainly: on any device, in any precision, with slopes of the residual too."""
    found = traits(gist, residual).double()
    order = found.detach().argsort(dim=0, stable=True)
    apart = (found - torch.empty_like(wanted).scatter_(0, order, wanted)) / widths
    return (apart.square().sum(1) / 2).to(gist)


class _TraitCosts(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, gist: Tensor, residual: Tensor, wanted: Tensor, widths: Tensor) -> Tensor:
        costs, slopes = gist.new_empty(len(gist)), torch.empty_like(gist)
        given = (tensor.detach().numpy() for tensor in (gist, residual))
        _shape.trait_costs(*given, *shape.bases(), wanted.numpy(), widths.numpy(), costs.numpy(), slopes.numpy())
        ctx.save_for_backward(slopes)
        return costs

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad_out: Tensor) -> tuple[Tensor | None, ...]:
        (slopes,) = ctx.saved_tensors
        return grad_out[:, None] * slopes, None, None, None
