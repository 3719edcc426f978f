"""What each stroke does for the picture.

The canvas is linear in a stroke's opacity, so that taking the stroke away changes the squared error by an exact
quadratic, whose terms a few backward passes give for all strokes at once.
"""

import torch
from torch import Generator, Tensor
from torch.nn.functional import avg_pool2d

from maulstick.brush.kernels.cpu import composite
from maulstick.brush.traj2stroke import Marks

_PROBES = 8


def removal_costs(
    paper: Tensor, target: Tensor, marks: Marks, colours: Tensor, *, pool: int, generator: Generator
) -> Tensor:
    """How much the summed squared error would grow, (N,), if each stroke alone were not there.

    paper, target: (C, H, W), compared after averaging over squares of `pool` pixels.  marks and colours (N, C) are
    in painting order.  The slope is exact; the curvature, a sum of squares over pixels, is estimated from random
    signs (Hutchinson).
    """
    opacity = marks.o.detach().requires_grad_()
    canvas = composite(
        paper, marks.points.detach(), marks.thickness.detach(), colours.detach(), marks.c, marks.q.detach(), opacity
    )
    difference = seen(canvas, pool) - seen(target, pool)

    def pull(signal: Tensor) -> Tensor:
        (gradient,) = torch.autograd.grad(difference, opacity, signal, retain_graph=True)
        return gradient

    slope = pull(2 * difference.detach())
    curvature = torch.zeros_like(slope)
    for _ in range(_PROBES):
        signs = torch.randint(0, 2, difference.shape, generator=generator) * 2.0 - 1
        curvature += 2 * pull(signs).square() / _PROBES
    amount = opacity.detach()
    return 0.5 * curvature * amount.square() - slope * amount


def coverage(paper: Tensor, marks: Marks, colours: Tensor) -> Tensor:
    """Pixels of the canvas that show each stroke in the end, (N,)."""
    colours = colours.detach().requires_grad_()
    canvas = composite(
        paper, marks.points.detach(), marks.thickness.detach(), colours, marks.c, marks.q.detach(), marks.o.detach()
    )
    (shown,) = torch.autograd.grad(canvas.sum(), colours)
    return shown.mean(dim=1)


def seen(image: Tensor, pool: int) -> Tensor:
    """The image (C, H, W) averaged over squares of `pool` pixels."""
    return avg_pool2d(image, pool, ceil_mode=True) if pool > 1 else image
