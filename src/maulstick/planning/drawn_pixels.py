"""Pixels that a plan is drawn on: larger than the canvas' own at first, smaller at the end where edges are hard.

Strokes cost time for each pixel of their marks, and while they move far their places matter, not their outlines. In the
end outlines matter: a pixel takes marks that share it to lie on one another by chance, and at an edge they do not.
"""

from collections.abc import Callable
from typing import Any

import torch
from torch import Tensor
from torch.nn.functional import avg_pool2d

from maulstick.planning.objectives import Edges
from maulstick.planning.problem import PlannerSettings, PlanningProblem

FINE = 1 / 3
"""Side of fine pixels, in those of the canvas: halves still say up to 0.4 dB too much, quarters take longer."""

_APART = 3  # coarse pixels between strokes: with two, details come too late to be found
_FEWEST = 100  # coarse pixels over a canvas' shorter side, at least: with fewer, small things are lost for good
_LARGE = 512  # pixels of a canvas' shorter side, from which on fine pixels show nothing more
_MISJUDGED = 10**0.02  # ratio of squared differences, 0.2 dB, from which on a canvas is to be drawn on fine pixels


def coarsest(problem: PlanningProblem, options: PlannerSettings, spacing: float) -> int:
    """Return the side of the squares that are drawn as one at first, in pixels; spacing: metres between strokes.

    No square is broader than the broadest mark, and small canvases have none. Nor has what they spoil: greys of one
    ink, which are made of lines, edges, and what networks see.
    """
    sees_edges = any(isinstance(each.term, Edges) for each in problem.objectives)
    if options.in_ink or problem.network_losses or sees_edges:
        return 1
    side = min(spacing / _APART, 2 * problem.brushes[0].widest) * problem.canvas.pixels_per_metre
    return max(1, min(round(side), min(problem.paper.shape[1:]) // _FEWEST))


@torch.no_grad()
def finest(target: Tensor | None, rendered: Callable[[float], Tensor]) -> float:
    """Return the side of the pixels that the last steps are drawn on: fine ones where the canvas' own misjudge it.

    target: (C, H, W), if there is one.  rendered: the canvas (C, H, W) as it is now, drawn on pixels of a side; large
    ones are not asked for.
    """
    if target is None or min(target.shape[1:]) >= _LARGE:
        return 1
    seen, true = ((rendered(side) - target).square().mean().item() for side in (1, FINE))
    return FINE if max(seen, true) > _MISJUDGED * min(seen, true) else 1


def to_drawn(image: Tensor, side: float) -> Tensor:
    """Return the image (C, H, W) on pixels of another side, in its own; the last ones may reach beyond it."""
    if side < 1:
        finer = round(1 / side)
        return image.repeat_interleave(finer, dim=1).repeat_interleave(finer, dim=2)
    return avg_pool2d(image, int(side), ceil_mode=True) if side > 1 else image


def to_canvas(drawn: Tensor, side: float, like: Tensor) -> Tensor:
    """Return what was drawn on pixels of that side on as many as `like`, (C, H, W), has: each a square, or a mean.

    Beside a picture, the squared difference of squares has the same slope as that of both on coarse pixels.
    """
    if side == 1:
        return drawn
    channels, height, width = drawn.shape
    if side < 1:
        finer = round(1 / side)
        return drawn.reshape(channels, height // finer, finer, width // finer, finer).mean(dim=(2, 4))
    squares: Tensor = _Squares.apply(drawn, int(side), *like.shape[1:])
    return squares


class _Squares(torch.autograd.Function):
    """Each pixel of an image (C, h, w) as a square of `side`, cut to (C, height, width).

    Their slopes are summed by one pooling: PyTorch's own way back takes three times as long.
    """

    @staticmethod
    def forward(ctx: Any, drawn: Tensor, side: int, height: int, width: int) -> Tensor:
        ctx.side = side
        rows = torch.arange(height, device=drawn.device) // side
        return drawn.repeat_interleave(side, dim=2)[:, :, :width].index_select(1, rows)

    @staticmethod
    def backward(ctx: Any, *slopes: Tensor) -> tuple[Tensor, None, None, None]:
        return avg_pool2d(slopes[0], ctx.side, ceil_mode=True, divisor_override=1), None, None, None
