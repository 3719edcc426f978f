"""Coarse pixels: squares of a canvas' own that are drawn as one, each the average over its area.

Strokes cost time for each pixel of their marks, and while they move far their places matter, not their outlines.
"""

from torch import Tensor
from torch.nn.functional import avg_pool2d

from maulstick.planning.objectives import Edges
from maulstick.planning.problem import PlannerSettings, PlanningProblem

_APART = 3  # coarse pixels between strokes: with two, details come too late to be found
_LARGE = 512  # pixels of a canvas' shorter side, below which a step's other work counts, and squares would be seen


def coarsest(problem: PlanningProblem, options: PlannerSettings, spacing: float) -> int:
    """Return the side of the squares that are drawn as one at first, in pixels; spacing: metres between strokes.

    No square is broader than the broadest mark. On small canvases it is 1, and for what squares spoil: greys of one
    ink, which are made of lines, edges, and what networks see.
    """
    sees_edges = any(isinstance(each.term, Edges) for each in problem.objectives)
    is_small = min(problem.paper.shape[1:]) < _LARGE
    if is_small or options.one_ink or problem.network_losses or sees_edges:
        return 1
    side = min(spacing / _APART, 2 * problem.brushes[0].widest)
    return max(1, round(side * problem.canvas.pixels_per_metre))


def coarser(image: Tensor, side: int) -> Tensor:
    """Return the image (C, H, W) averaged over squares of `side` pixels; the last ones may reach beyond it."""
    return avg_pool2d(image, side, ceil_mode=True) if side > 1 else image


def finer(image: Tensor, side: int, like: Tensor) -> Tensor:
    """Return a coarser image with each pixel as a square of `side`, on as many pixels as `like`, (C, H, W), has.

    Beside a picture, its squared difference has the same slope as that of both on coarse pixels.
    """
    if side == 1:
        return image
    channels, height, width = image.shape
    squares = image[:, :, None, :, None].expand(channels, height, side, width, side)
    return squares.reshape(channels, side * height, side * width)[:, : like.shape[1], : like.shape[2]]
