"""Reference renderer: every pixel against every segment. It is slow; all tests compare with it (docs/equations.md)."""

import math

import torch
from torch import Tensor

from maulstick.rendering.kernels.arguments import check_canvas, check_colours, check_size, check_strokes
from maulstick.rendering.kernels.nearest import HALF_DIAGONAL, Nearest, fade, turn_between, two_nearest

_CLOSE = 1.25  # pixels from a point beyond which its mark is a line's whose edge is bent
_SLIMMEST = 0.1  # pixels: the least width that a part of a pixel is given
_WIDE, _ALIGNED = 2.0, 0.125  # pixels inside a mark's edge; of a pixel, across a stroke that lies along the grid


def darkness(
    points: Tensor, thickness: Tensor, falloff: Tensor, plateau: Tensor, opacity: Tensor, *, height: int, width: int
) -> Tensor:
    """Draw each stroke on an image of its own, each pixel the mean over its square (docs/equations.md, Ink on a grid).

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
    near, second = two_nearest(xy, thickness, grid)
    with torch.no_grad():
        apart = near.towards - second.towards
        rate, turn = apart.norm(dim=-1), turn_between(near, second)
        meets = near.marks & second.marks & (rate > 0)
        opens = torch.where(meets, rate.minimum(turn), 1.0)  # by how much the one gets nearer than the other, per pixel
        gap = (torch.where(meets, second.ratio, 0) - torch.where(meets, near.ratio, 0)) * near.thickness
        share = torch.where(meets, (0.5 - gap / opens).clamp(0, 0.5) * fade(turn), 0.0)
    mean = (1 - share) * _mean_darkness(near, falloff, plateau, rate / 2, share)
    mean = mean + share * _mean_darkness(second, falloff, plateau, rate / 2, 1 - share)
    within = near.marks & (near.distance + HALF_DIAGONAL <= plateau * near.thickness)
    return opacity * torch.where(within, 1.0, mean)


def _mean_darkness(near: Nearest, falloff: Tensor, plateau: Tensor, slant: Tensor, lost: Tensor) -> Tensor:
    """Return the mean, (H, W), over the part of each pixel that is nearest to these, before the opacity.

    lost: (H, W) share of the pixel beyond a crease.  slant: (H, W) cosine between the way across and to the point.
    """
    away = near.towards.abs().sort(dim=-1, descending=True).values
    away = torch.where((away > 0).any(-1, keepdim=True), away, away.new_tensor([1.0, 0.0]))
    a, b = (away * (1 - slant**2 * lost * (2 - lost)).clamp(min=_SLIMMEST**2).sqrt()[..., None]).unbind(-1)
    close = near.distance < _CLOSE
    around, _ = _around_a_point(near.distance.detach())
    bend = torch.where(close, 0.0, near.rounded * (around - near.distance)).detach()
    distance = near.distance + bend - slant * lost / 2
    line = _mean_across(distance, near.thickness, falloff, plateau, a, b)
    around, spread = _around_a_point(distance)
    point = _mean_across(around, near.thickness, falloff, plateau, spread * a, spread * b)
    mean = torch.where(close, torch.lerp(line, point, near.rounded), line)
    return torch.where(near.marks, mean, 0.0)


def _around_a_point(distance: Tensor) -> tuple[Tensor, Tensor]:
    """Return the mean distance from a point to a pixel whose centre is so far from it, and its spread beside a line's.

    The bulge is fitted. Over a square of side 1 the mean of the squared distance is 1/6 more than its centre's.
    """
    square = distance.square()
    bulge = 1 / 12 + 0.06305 / (1 + 5.12 * square + 23.6 * square.square())
    return (square + bulge).sqrt(), (2 - 12 * bulge).sqrt()


def _mean_across(distance: Tensor, h: Tensor, c: Tensor, q: Tensor, a: Tensor, b: Tensor) -> Tensor:
    """Return the mean darkness of a straight stroke over pixels at some distance from its middle.

    Across the stroke a pixel is a trapezoid: a box of width a blurred by a box of width b, the larger and the smaller
    of |cos| and |sin|. So the mean is a second difference of the profile's second integral, or, where
    that would lose digits, a difference of its first integral.
    """
    exact = (b > _ALIGNED) & (h - distance < _WIDE)
    step = b * torch.where(exact, 0.5, 0.5 / math.sqrt(3))  # else Gauss's two places
    x = torch.stack([distance + i * a / 2 + j * step for i in (-1, 1) for j in (-1, 1)])
    ramp = h * (1 - q)
    flat = torch.relu(q * h - x.abs())
    base = torch.where(flat > 0, 1.0, (1 - x.abs() / h) / (1 - q))
    inside = base > 0
    base = torch.where(inside, base, 1.0)
    first = torch.where(inside, ramp / (c + 1) * base ** (c + 1), 0.0)  # the profile's ink from |x| outwards
    second = ramp / (c + 2) * base * first + flat * ramp / (c + 1) + flat.square() / 2
    whole = 2 * (q * h + ramp / (c + 1))
    first = torch.where(x < 0, whole - first - flat, first + flat)
    second = second + whole * (-x).clamp(min=0)
    mean = torch.where(
        exact,
        (second[0] - second[1] - second[2] + second[3]) / torch.where(exact, a * b, 1.0),
        (first[0] + first[1] - first[2] - first[3]) / (2 * a),
    )
    return torch.where(distance + (a + b) / 2 <= q * h, 1.0, mean)


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
    check_colours(colours)
    numbers = [x.expand(points.shape[0]) for x in (falloff, plateau, opacity)]
    for i in range(points.shape[0]):
        stroke = [points[i : i + 1], thickness[i : i + 1], *(x[i : i + 1] for x in numbers)]
        colour = colours[i]
        if trainable is not None and not trainable[i]:
            stroke, colour = [x.detach() for x in stroke], colour.detach()
        d = darkness(*stroke, height=canvas.shape[1], width=canvas.shape[2])
        canvas = canvas * (1 - d) + colour[:, None, None] * d
    return canvas
