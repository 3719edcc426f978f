"""Reference renderer: every pixel against every segment. It is slow; all tests compare with it (docs/equations.md)."""

import math
from dataclasses import dataclass

import torch
from torch import Tensor

from maulstick.rendering.kernels.arguments import check_canvas, check_size, check_strokes

_HALF_DIAGONAL = math.sqrt(0.5)
_TURN, _FADE = 0.8, 0.3  # a turn from which on parts of a stroke may meet in a crease and a corner is round; its fade-in
_ROOM, _LONG = 1.0, 4.0  # pixels from a crease within which it may cut a pixel; a long segment
_CLOSE = 1.25  # pixels from a point beyond which its mark is a line's whose edge is bent
_SLIMMEST = 0.1  # pixels: the least width that a part of a pixel is given
_WIDE, _ALIGNED = 3.0, 0.125  # pixels inside a mark's edge; of a pixel, across a stroke that lies along the grid


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
    near, second = _two_nearest(xy, thickness, grid)
    with torch.no_grad():
        apart = near.towards - second.towards
        rate, turn = apart.norm(dim=-1), _turn_between(near, second)
        meets = near.marks & second.marks & (rate > 0)
        opens = torch.where(meets, rate.minimum(turn), 1.0)  # by how much the one gets nearer than the other, per pixel
        gap = (torch.where(meets, second.ratio, 0) - torch.where(meets, near.ratio, 0)) * near.thickness
        share = torch.where(meets, (0.5 - gap / opens).clamp(0, 0.5) * _fade(turn), 0.0)
    mean = (1 - share) * near.mean_darkness(falloff, plateau, rate / 2, share)
    mean = mean + share * second.mean_darkness(falloff, plateau, rate / 2, 1 - share)
    within = near.marks & (near.distance + _HALF_DIAGONAL <= plateau * near.thickness)
    return opacity * torch.where(within, 1.0, mean)


@dataclass(frozen=True)
class _Segments:
    """A stroke's n - 1 segments; what has no gradient is about its shape.

    start, along: (n - 1, 2) where each begins, and how far it goes.  direction: (n - 1, 2) its unit, 0 without length.
    length, before, after: (n - 1,) pixels along the stroke, of it and on either side of it.
    turned: (n + 1,) by how much the stroke has turned up to it, to either side, with the first and the last twice.
    """

    xy: Tensor
    along: Tensor
    direction: Tensor
    length: Tensor
    before: Tensor
    after: Tensor
    turned: Tensor


def _segments(xy: Tensor) -> _Segments:
    along = xy[1:] - xy[:-1]
    length = along.detach().norm(dim=-1)
    direction = along.detach() / torch.where(length > 0, length, 1.0)[:, None]
    turned = _turned(xy)
    return _Segments(
        xy,
        along,
        direction,
        length,
        before=length.cumsum(0) - length,
        after=length.flip(0).cumsum(0).flip(0) - length,
        turned=torch.cat([turned[:1], turned, turned[-1:]]),
    )


@dataclass(frozen=True)
class _Nearest:
    """A stroke's segments nearest to each pixel's centre, (H, W); where there is none, `marks` is false.

    ratio: distance over thickness.  distance, thickness: pixels.  towards: (H, W, 2) unit, 0 at no distance.
    rounded: share of the pixel that lies around a point, an end or a corner, and not along a line.
    turned: by how much the stroke has turned up to the nearest point, and from it on, since that may be a corner.
    tight: whether another part of the stroke is so near that both may meet in a crease within the pixel.
    """

    ratio: Tensor
    distance: Tensor
    thickness: Tensor
    towards: Tensor
    rounded: Tensor
    turned: tuple[Tensor, Tensor]
    tight: Tensor

    @property
    def marks(self) -> Tensor:
        return self.ratio.isfinite()

    def where(self, here: Tensor, other: "_Nearest") -> "_Nearest":
        """Return this one `here`, and the other elsewhere."""
        return _Nearest(
            torch.where(here, self.ratio, other.ratio),
            torch.where(here, self.distance, other.distance),
            torch.where(here, self.thickness, other.thickness),
            torch.where(here[..., None], self.towards, other.towards),
            torch.where(here, self.rounded, other.rounded),
            (torch.where(here, self.turned[0], other.turned[0]), torch.where(here, self.turned[1], other.turned[1])),
            torch.where(here, self.tight, other.tight),
        )

    def mean_darkness(self, falloff: Tensor, plateau: Tensor, slant: Tensor, lost: Tensor) -> Tensor:
        """Return the mean, (H, W), over the part of each pixel that is nearest to these, before the opacity.

        lost: (H, W) share of the pixel beyond a crease.  slant: (H, W) cosine between the way across and to the point.
        """
        away = self.towards.abs().sort(dim=-1, descending=True).values
        away = torch.where((away > 0).any(-1, keepdim=True), away, away.new_tensor([1.0, 0.0]))
        a, b = (away * (1 - slant**2 * lost * (2 - lost)).clamp(min=_SLIMMEST**2).sqrt()[..., None]).unbind(-1)
        close = self.distance < _CLOSE
        around, _ = _around_a_point(self.distance.detach())
        bend = torch.where(close, 0.0, self.rounded * (around - self.distance)).detach()
        distance = self.distance + bend - slant * lost / 2
        line = _mean_across(distance, self.thickness, falloff, plateau, a, b)
        around, spread = _around_a_point(distance)
        point = _mean_across(around, self.thickness, falloff, plateau, spread * a, spread * b)
        mean = torch.where(close, torch.lerp(line, point, self.rounded), line)
        return torch.where(self.marks, mean, 0.0)


def _around_a_point(distance: Tensor) -> tuple[Tensor, Tensor]:
    """Return the mean distance from a point to a pixel whose centre is so far from it, and its spread beside a line's.

    The square's part is fitted; the second moment of the distance over a square of side 1 is 1/6 more than its centre's.
    """
    square = distance.square()
    bulge = 1 / 12 + 0.06305 / (1 + 5.12 * square + 23.6 * square.square())
    return (square + bulge).sqrt(), (2 - 12 * bulge).sqrt()


def _two_nearest(xy: Tensor, thickness: Tensor, grid: Tensor) -> tuple[_Nearest, _Nearest]:
    """Return what is nearest, and what is nearest of all that goes elsewhere and may meet it in a crease."""
    segments = _segments(xy)
    nothing = grid.new_zeros(grid.shape[:2])
    none = _Nearest(
        nothing + torch.inf, nothing, nothing + 1, torch.zeros_like(grid), nothing, (nothing, nothing), nothing.bool()
    )
    each = [_nearest_on(segments, k, thickness, grid) for k in range(len(segments.length))]
    near = second = none
    for here in each:
        near = here.where(here.ratio < near.ratio, near)  # the maximum of darkness; the first segment wins a tie
    for here in each:
        turn = _turn_between(here, near)
        meets = here.ratio * near.thickness < near.distance + turn.clamp(max=2) / 2
        second = here.where(near.tight & (turn > _TURN) & meets & (here.ratio < second.ratio), second)
    return near, second


def _nearest_on(segments: _Segments, k: int, thickness: Tensor, grid: Tensor) -> _Nearest:
    u, w, length, last = segments.xy[k], segments.along[k], segments.length[k], len(segments.length) - 1
    squared_length = w.square().sum()
    projection = ((grid - u) * w).sum(-1) / torch.where(squared_length > 0, squared_length, 1.0)
    between = (projection > 0) & (projection < 1)  # at an end T is constant
    T = torch.where(between, projection, projection.detach().clamp(0, 1))  # (H, W), the signed projection
    offset = grid - (u + T[..., None] * w)
    at_pixel = thickness[k] * (1 - T) + thickness[k + 1] * T
    squared = offset.square().sum(-1)
    distance = torch.where(squared > 0, torch.where(squared > 0, squared, 1.0).sqrt(), 0.0)  # has no slope at 0
    far, held = distance.detach(), at_pixel.detach()
    touches = (held > 0) & (far < held + _HALF_DIAGONAL)
    ratio = torch.where(touches, far / torch.where(touches, held, 1.0), torch.inf)
    since = ((grid - u).detach() * segments.direction[k]).sum(-1)  # pixels along the segment
    until = length - since
    start = _share_beyond(since if k == 0 else segments.before[k] + since.clamp(min=0))
    end = _share_beyond(until if k == last else segments.after[k] + until.clamp(min=0))
    start = _moved_with(start, segments.xy[0], segments.direction[k])
    end = _moved_with(end, segments.xy[-1], -segments.direction[k])
    rounded = start + end
    for corner, ours, other in ((k, since, k - 1), (k + 1, until, k + 1)):
        if 0 <= other <= last:
            onwards = (grid - segments.xy[corner].detach()) @ segments.direction[other]
            theirs = -onwards if other < k else onwards
            wedge = (_share_beyond(ours) + _share_beyond(theirs) - 1).clamp(min=0)
            turn = segments.turned[corner + 1] - segments.turned[corner]
            rounded = torch.maximum(rounded, wedge * _fade(turn))
    before, here, after = segments.turned[k : k + 3]
    turned = torch.where(projection <= 0, before, here), torch.where(projection >= 1, after, here)
    towards = offset.detach() / torch.where(far > 0, far, 1.0)[..., None]
    tight = far >= _free_radius(segments, k) - _ROOM
    return _Nearest(ratio, distance, at_pixel, towards, rounded.clamp(max=1), turned, tight)


def _free_radius(segments: _Segments, k: int) -> Tensor:
    """Return the radius of the largest disc that touches segment k, on either side, and no other part of the stroke.

    Discs are tried against points, and middles of segments longer than 1; beside those longer than _LONG there is no
    room at all.
    """
    xy, direction = segments.xy.detach(), segments.direction[k]
    onwards = torch.stack([xy[:-1], (xy[:-1] + xy[1:]) / 2, xy[1:]], dim=1) - xy[k]  # (n - 1, 3, 2)
    along = onwards @ direction
    across = (onwards[..., 0] * direction[1] - onwards[..., 1] * direction[0]).abs()
    beside = along - along.clamp(min=0).minimum(segments.length[k])
    radius = (beside.square() + across.square()) / (2 * across.clamp(min=1e-6))
    length = segments.length
    radius[:, 1] = torch.where(length > _LONG, 0.0, torch.where(length > 1, radius[:, 1], torch.inf))
    turns = (segments.turned[1:-1] - segments.turned[k + 1]).abs() > _TURN
    return torch.where(turns, radius.amin(dim=1), torch.inf).amin()


def _share_beyond(pixels: Tensor) -> Tensor:
    """Return the share of a pixel that lies beyond what is so far from its centre."""
    return (0.5 - pixels).clamp(0, 1)


def _moved_with(share: Tensor, point: Tensor, direction: Tensor) -> Tensor:
    """Return the same share, which grows while the point moves in this direction and is else held."""
    grows = (share > 0) & (share < 1)
    return share + torch.where(grows, (point - point.detach()) @ direction, 0.0)


def _turn_between(one: _Nearest, other: _Nearest) -> Tensor:
    return torch.maximum(one.turned[0] - other.turned[1], other.turned[0] - one.turned[1])


def _fade(turn: Tensor) -> Tensor:
    return ((turn - _TURN) / _FADE).clamp(0, 1)


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
