"""Reference renderer: every pixel against every segment. It is slow; all tests compare with it (docs/equations.md)."""

import math
from dataclasses import dataclass

import torch
from torch import Tensor

from maulstick.rendering.kernels.arguments import check_canvas, check_size, check_strokes

CELLS = 4
"""Cells per side of a pixel that is cut up, because a straight stroke is not what lies in it."""

_NEAR, _FADE = 1.25, 0.25  # pixels from an end up to which pixels are cut up, and over which that fades in
_SHARP = 0.4  # a corner that is cut up like an end, as twice the tangent of half its turn
_TURN = 0.17  # how much of that lies between two parts of a stroke that may meet in a crease
_CREASE = 0.6  # pixels: cut up are those whose centres lie so near to a crease
_ARC = 0.25  # of a cell: the least distance from an end at which its arc is one
_HALF_DIAGONAL = math.sqrt(0.5)
_WIDE, _ALIGNED = 3.0, 0.125  # pixels inside a mark's edge; sine of the angle between a stroke and the grid


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
    whole = _nearest(xy, thickness, grid, 1.0)
    turned = _turned(xy)
    always = turned.new_ones(1).bool()
    corners = xy.detach()[torch.cat([always, turned.diff() > _SHARP, always])]
    away = (grid[..., None, :] - corners).norm(dim=-1).amin(dim=-1)
    cut = torch.where(whole.creased, 1.0, ((_NEAR - away) / _FADE).clamp(0, 1))
    cut = torch.where(whole.marks & ~whole.flat(plateau), cut, 0.0)
    mean = whole.mean_darkness(falloff, plateau)
    if cut.any():
        steps = (torch.arange(CELLS, dtype=grid.dtype, device=grid.device) + 0.5) / CELLS - 0.5
        shifts = [torch.stack([dx, dy]) for dy in steps for dx in steps]
        cells = [_nearest(xy, thickness, grid + shift, 1 / CELLS).mean_darkness(falloff, plateau) for shift in shifts]
        mean = torch.lerp(mean, torch.stack(cells).mean(dim=0), cut)
    return opacity * mean


@dataclass(frozen=True)
class _Nearest:
    """The nearest part of a stroke to the centre of each cell, a square of `side` pixels.

    distance: (H, W) pixels.  across: (H, W, 2) |cos| and |sin| of the direction to it, the larger first.
    thickness: (H, W), 1 where no mark reaches the cell.  marks: (H, W) whether one does.
    creased: (H, W) whether another part of the stroke, which goes elsewhere, is as near to some of the cell.
    """

    side: float
    distance: Tensor
    across: Tensor
    thickness: Tensor
    marks: Tensor
    creased: Tensor

    def flat(self, plateau: Tensor) -> Tensor:
        """Tell which cells lie within the plateau, (H, W)."""
        return self.distance + _HALF_DIAGONAL * self.side <= plateau * self.thickness

    def mean_darkness(self, falloff: Tensor, plateau: Tensor) -> Tensor:
        """Return the mean over each cell, (H, W), of a straight stroke's darkness, before its opacity."""
        a, b = (self.side * self.across).unbind(-1)
        mean = _mean_across(self.distance, self.thickness, falloff, plateau, a, b, self.side)
        return torch.where(self.marks, mean, 0.0)


def _nearest(xy: Tensor, thickness: Tensor, grid: Tensor, side: float) -> _Nearest:
    turned = _turned(xy)
    nothing = grid.new_zeros(grid.shape[:2])
    square, half_width, turn = nothing + torch.inf, nothing + 1, nothing  # (distance / thickness)^2
    offset, distance, creased = torch.zeros_like(grid), nothing, nothing.bool()
    last = len(turned) - 1
    for k in range(last + 1):
        u, w = xy[k], xy[k + 1] - xy[k]
        squared_length = w.square().sum()
        projection = ((grid - u) * w).sum(-1) / torch.where(squared_length > 0, squared_length, 1.0)
        between = (projection > 0) & (projection < 1)  # at an end T is constant
        T = torch.where(between, projection, projection.detach().clamp(0, 1))  # (H, W), the signed projection
        away = grid - (u + T[..., None] * w)
        at_pixel = thickness[k] * (1 - T) + thickness[k + 1] * T
        held, squared = at_pixel.detach(), away.detach().square().sum(-1)
        touches = (held > 0) & (squared < (held + _HALF_DIAGONAL * side).square())
        here = torch.where(touches, squared / torch.where(touches, held, 1.0).square(), torch.inf)
        beyond = ((projection <= 0) & (k == 0)) | ((projection >= 1) & (k == last))
        # Around an end the mark's edge is an arc, and bends away: as if the cell lay a little further off.
        far = squared.clamp(min=1e-12).sqrt()
        bend = torch.where(beyond, side**2 / 24 / (far * far.clamp(min=_ARC * side)), 0.0)
        seen = away.detach() * (1 + bend[..., None])
        gap = torch.where(touches & square.isfinite(), (here - square).abs() * held.square(), torch.inf)
        feet = (seen - offset).square().sum(-1)
        creased = creased | ((gap.square() < (2 * _CREASE) ** 2 * feet) & ((turned[k] - turn).abs() > _TURN))
        nearer = here < square  # the maximum of darkness; the first segment wins a tie
        square, turn = torch.where(nearer, here, square), torch.where(nearer, turned[k], turn)
        half_width = torch.where(nearer, at_pixel, half_width)
        offset = torch.where(nearer[..., None], seen, offset)
        apart = away.square().sum(-1)
        reached = torch.where(apart > 0, torch.where(apart > 0, apart, 1.0).sqrt(), 0.0)  # has no slope at 0
        distance = torch.where(nearer, reached + far * bend, distance)
    length = offset.norm(dim=-1, keepdim=True)
    across = offset.abs() / torch.where(length > 0, length, 1.0)
    across = torch.where(length > 0, across.sort(descending=True).values, across.new_tensor([1.0, 0.0]))
    return _Nearest(side, distance, across, half_width, square.isfinite(), creased)


def _turned(xy: Tensor) -> Tensor:
    """Return by how much a stroke (n, 2) has turned up to each of its segments, to either side.

    Each corner counts as twice the tangent of half its turn, which is nearly the turn in radians, and 8 at most.
    """
    turned, heading = [xy.new_zeros(())], xy[0] * 0
    for direction in (xy[1:] - xy[:-1]).detach():
        across = heading[0] * direction[1] - heading[1] * direction[0]
        along = (heading * direction).sum() + heading.norm() * direction.norm()
        turn = torch.where(across.abs() < 4 * along, 2 * across.abs() / torch.where(along > 0, along, 1.0), 8.0)
        moves = direction.any()
        turned.append(turned[-1] + torch.where(heading.any() & moves, turn, 0.0))
        heading = torch.where(moves, direction, heading)
    return torch.stack(turned[1:])


def _mean_across(distance: Tensor, h: Tensor, c: Tensor, q: Tensor, a: Tensor, b: Tensor, side: float) -> Tensor:
    """Return the mean darkness of a straight stroke over square cells at some distance from its middle.

    Across the stroke a cell is a trapezoid: a box of width a blurred by a box of width b, its side times the larger
    and the smaller of |cos| and |sin|. So the mean is a second difference of the profile's second integral, or, where
    that would lose digits, a difference of its first integral.
    """
    exact = (b > _ALIGNED * side) & (h - distance < _WIDE)
    step = b * torch.where(exact, 0.5, 0.5 / math.sqrt(3))  # else Gauss's two places
    x = torch.stack([distance + i * a / 2 + j * step for i in (-1, 1) for j in (-1, 1)])
    ramp = h * (1 - q)
    base = ((1 - x.abs() / h) / (1 - q)).clamp(max=1)
    inside = base > 0
    base = torch.where(inside, base, 1.0)
    first = torch.where(inside, ramp / (c + 1) * base ** (c + 1), 0.0)  # the profile's ink from |x| outwards
    flat = (q * h - x.abs()).clamp(min=0)
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
    numbers = [x.expand(points.shape[0]) for x in (falloff, plateau, opacity)]
    for i in range(points.shape[0]):
        stroke = [points[i : i + 1], thickness[i : i + 1], *(x[i : i + 1] for x in numbers)]
        colour = colours[i]
        if trainable is not None and not trainable[i]:
            stroke, colour = [x.detach() for x in stroke], colour.detach()
        d = darkness(*stroke, height=canvas.shape[1], width=canvas.shape[2])
        canvas = canvas * (1 - d) + colour[:, None, None] * d
    return canvas
