"""Reference renderer: every pixel against every segment. It is slow; all tests compare with it (docs/equations.md)."""

import torch
from torch import Tensor

from maulstick.rendering.kernels.arguments import check_canvas, check_size, check_strokes


def darkness(
    points: Tensor, thickness: Tensor, falloff: Tensor, plateau: Tensor, opacity: Tensor, *, height: int, width: int
) -> Tensor:
    """Draw each stroke on an image of its own (paper: Traj2Stroke Model; docs/equations.md).

    points: (N, n, 2) pixels from the upper left corner; the centre of the first pixel is (0.5, 0.5).
    thickness: (N, n) half-width in pixels; where it is 0 or less there is no mark.
    falloff, plateau, opacity: (N,) or (1,), the paper's c, and q and o beyond the paper.

    Returns (N, height, width) in [0, 1], in the points' dtype. Raises InputError for what cannot be drawn.
    """
    check_strokes(points, thickness, falloff, plateau, opacity)
    check_size(height, width)
    if points.shape[0] == 0:
        return points.new_zeros(0, height, width)
    grid_y, grid_x = torch.meshgrid(
        torch.arange(height, dtype=points.dtype, device=points.device) + 0.5,
        torch.arange(width, dtype=points.dtype, device=points.device) + 0.5,
        indexing="ij",
    )
    grid = torch.stack([grid_x, grid_y], dim=-1)  # (H, W, 2)
    falloff, plateau, opacity = (x.expand(points.shape[0]) for x in (falloff, plateau, opacity))
    return torch.stack(
        [_darkness_of_one(*stroke, grid) for stroke in zip(points, thickness, falloff, plateau, opacity, strict=True)]
    )


def _darkness_of_one(
    xy: Tensor, thickness: Tensor, falloff: Tensor, plateau: Tensor, opacity: Tensor, grid: Tensor
) -> Tensor:
    if xy.shape[0] == 1:  # a dot is a segment without length
        xy, thickness = xy.expand(2, 2), thickness.expand(2)
    u, w = xy[:-1, None, None], (xy[1:] - xy[:-1])[:, None, None]  # (n-1, 1, 1, 2)
    squared_length = w.square().sum(-1)
    has_length = squared_length > 0
    projection = ((grid - u) * w).sum(-1) / torch.where(has_length, squared_length, 1.0)
    between = (projection > 0) & (projection < 1)  # at an end T is constant
    T = torch.where(between, projection, projection.detach().clamp(0, 1))  # (n-1, H, W), the signed projection
    offset = grid - (u + T[..., None] * w)
    squared_distance = offset.square().sum(-1)
    apart = squared_distance > 0  # the square root has no slope at 0
    distance = torch.where(apart, torch.where(apart, squared_distance, 1.0).sqrt(), 0.0)
    at_pixel = thickness[:-1, None, None] * (1 - T) + thickness[1:, None, None] * T
    marks = at_pixel > 0
    ratio = torch.where(marks, distance / torch.where(marks, at_pixel, 1.0), 2.0)  # 1 and more: no mark
    nearest = ratio.argmin(dim=0, keepdim=True)  # the maximum of darkness; the first segment wins a tie
    ramp = (1 - ratio.gather(0, nearest)[0]) / (1 - plateau)
    base = torch.where(ramp < 1, ramp, 1.0)
    inside = base > 0
    return torch.where(inside, opacity * torch.where(inside, base, 1.0) ** falloff, 0.0)


def composite(
    canvas: Tensor,
    points: Tensor,
    thickness: Tensor,
    colours: Tensor,
    falloff: Tensor,
    plateau: Tensor,
    opacity: Tensor,
    *,
    trainable: Tensor | None = None,
) -> Tensor:
    """Paint all strokes onto one canvas, in order (paper: Stroke Composition; docs/equations.md).

    canvas: (C, H, W), any number of channels.  colours: (N, C).  The rest as in `darkness`.
    trainable: (N,) bool, strokes that get gradients; all of them by default.

    Returns the painted canvas (C, H, W). Raises InputError for what cannot be drawn.
    """
    check_strokes(points, thickness, falloff, plateau, opacity)
    check_canvas(canvas, points, colours, trainable)
    numbers = [x.expand(points.shape[0]) for x in (falloff, plateau, opacity)]
    for i in range(points.shape[0]):
        stroke = [points[i : i + 1], thickness[i : i + 1], *(x[i : i + 1] for x in numbers)]
        colour = colours[i]
        if trainable is not None and not trainable[i]:
            stroke, colour = [x.detach() for x in stroke], colour.detach()
        d = darkness(*stroke, height=canvas.shape[1], width=canvas.shape[2])
        canvas = canvas * (1 - d) + colour[:, None, None] * d
    return canvas
