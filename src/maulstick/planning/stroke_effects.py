"""Effects of single strokes on the error of the canvas, estimated.

The canvas is linear in a stroke's opacity and in its colour, so that taking it away, or painting it with another paint,
changes the squared error by a quadratic. One backward pass gives its slope, exactly, for all strokes at once; a few of
random signs estimate its curvature. `benchmarks/removal.py` measures how well: half of the costs are off by a third.
"""

from dataclasses import dataclass, replace
from typing import Self

import torch
from torch import Generator, Tensor
from torch.nn.functional import avg_pool2d

from maulstick.planning.drawn_pixels import to_drawn
from maulstick.rendering.kernels.render import composite
from maulstick.rendering.traj2stroke import Marks

_PROBES = 8  # random signs per estimate of curvature, one backward pass each: enough to rank strokes (0.92)

_UNSEEN = (
    1e-5  # opacity of strokes that are not there yet: a kernel draws none of 0, and sees none below float32's grain
)


@dataclass(frozen=True)
class TargetView:
    """View of the target (C, H, W), with which a canvas is compared.

    weights: (H, W), how much each pixel counts.  pool: side of the squares that are averaged before, pixels.
    pull: (C, H, W), of inks, as `Halftone` takes it.
    """

    target: Tensor
    weights: Tensor
    pool: int = 1
    pull: Tensor | None = None

    def drawn(self, side: float) -> Self:
        """Return the same view of a canvas that is drawn on pixels of this side, in its own."""
        target, weights = to_drawn(self.target, side), to_drawn(self.weights[None], side)[0]
        pull = None if self.pull is None else to_drawn(self.pull, side)
        return replace(self, target=target, weights=weights, pool=max(1, int(self.pool / side)), pull=pull)

    def difference(self, canvas: Tensor) -> Tensor:
        """Return the weighted difference (C, h, w), whose sum of squares is the error."""
        difference = (canvas - self.target) * self.weights.sqrt()
        return avg_pool2d(difference, self.pool, ceil_mode=True) if self.pool > 1 else difference

    def pulled(self, canvas: Tensor) -> Tensor:
        """Return what the pull of the view adds to the error, a scalar."""
        assert self.pull is not None
        return (canvas * self.pull * self.weights).sum() / self.pool**2


def removal_costs(view: TargetView, paper: Tensor, marks: Marks, colours: Tensor, generator: Generator) -> Tensor:
    """Return an estimate of how much the error would grow, (N,), if each stroke alone were removed.

    paper: (C, H, W).  marks and colours, (N, C), are in painting order.  The slope is exact; the curvature, a sum of
    squares over pixels, is estimated from random signs (Hutchinson, 1990), without bias.
    """
    marks, colours = _detached(marks), colours.detach()
    opacity = marks.opacity.requires_grad_()
    canvas = _painted(paper, marks, colours)
    slope, curvature = _slope_and_curvature(view.difference(canvas), opacity, generator)
    if view.pull is not None:
        slope = slope + torch.autograd.grad(view.pulled(canvas), opacity)[0]
    amount = opacity.detach()
    return 0.5 * curvature * amount.square() - slope * amount


def insertion_costs(
    view: TargetView, paper: Tensor, marks: Marks, colours: Tensor, new: Tensor, generator: Generator
) -> Tensor:
    """Return an estimate of how much the error would shrink, as a number below 0, if each new stroke alone were there.

    new: (N,), which of the strokes are; for the others it says nothing. Each counts at the opacity that serves best,
    up to its own: its shape will still adapt. Estimated as in `removal_costs`.
    """
    marks = _detached(marks)
    amount = marks.opacity
    opacity = torch.where(new.to(amount.device), _UNSEEN, amount).requires_grad_()
    difference = view.difference(_painted(paper, replace(marks, opacity=opacity), colours.detach()))
    slope, curvature = _slope_and_curvature(difference, opacity, generator)
    best = torch.minimum((-slope).clamp(min=0) / curvature.clamp(min=1e-12), amount)
    return slope * best + 0.5 * curvature * best.square()


def recolouring_costs(
    view: TargetView, paper: Tensor, marks: Marks, colours: Tensor, paints: Tensor, generator: Generator
) -> Tensor:
    """Return an estimate of how much the error would grow, (N, k), if each stroke alone took each paint of (k, C).

    Estimated as in `removal_costs`, and for the same reason: the canvas is linear in a stroke's colour too.
    """
    colours = colours.detach().requires_grad_()
    difference = view.difference(_painted(paper, _detached(marks), colours))
    slope, curvature = _slope_and_curvature(difference, colours, generator)
    change = paints.detach().to(colours) - colours.detach()[:, None]
    return (slope[:, None] * change + 0.5 * curvature[:, None] * change.square()).sum(dim=-1)


def coverage(view: TargetView, paper: Tensor, marks: Marks, colours: Tensor) -> Tensor:
    """Return how much of each stroke the finished canvas shows, (N,), in weighted pixels."""
    colours = colours.detach().requires_grad_()
    (shown,) = torch.autograd.grad((_painted(paper, _detached(marks), colours) * view.weights).sum(), colours)
    return shown.mean(dim=1)


def _slope_and_curvature(difference: Tensor, numbers: Tensor, generator: Generator) -> tuple[Tensor, Tensor]:
    """Return the slope of the sum of squared differences, linear in the numbers, and an estimate of its curvature."""

    def backward(signal: Tensor) -> Tensor:
        total = (difference * signal).sum()  # to give `grad` the signal would load a library of symbols
        (gradient,) = torch.autograd.grad(total, numbers, retain_graph=True)
        return gradient

    slope = backward(2 * difference.detach())
    curvature = torch.zeros_like(slope)
    for _ in range(_PROBES):
        signs = torch.randint(0, 2, difference.shape, generator=generator, dtype=torch.float32).mul_(2).sub_(1)
        curvature += 2 * backward(signs.to(difference)).square() / _PROBES
    return slope, curvature


def _detached(marks: Marks) -> Marks:
    return Marks(**{name: tensor.detach() for name, tensor in vars(marks).items()})


def _painted(paper: Tensor, marks: Marks, colours: Tensor) -> Tensor:
    return composite(paper, marks.points, marks.thickness, colours, marks.falloff, marks.plateau, marks.opacity)
