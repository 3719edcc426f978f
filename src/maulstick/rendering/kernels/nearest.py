"""Which parts of a stroke are nearest to each pixel, for the reference renderer (docs/equations.md, Ink on a grid)."""

import math
from dataclasses import dataclass

import torch
from torch import Tensor

HALF_DIAGONAL = math.sqrt(0.5)
_THINNEST = 1e-6  # pixels: half-widths below leave no mark
_TURN, _FADE = 0.8, 0.3  # a turn from which on parts may meet in a crease and a corner is round; its fade-in
_ROOM, _LONG = 1.0, 4.0  # pixels from a crease within which it may cut a pixel; a long segment


@dataclass(frozen=True)
class _Segments:
    """A stroke's n - 1 segments; what has no gradient is about its shape.

    xy: (n, 2) points.  along: (n - 1, 2) from each to the next.  direction: (n - 1, 2) its unit, 0 without length.
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
class Nearest:
    """A stroke's segments nearest to each pixel's centre, (H, W); where there is none, `marks` is false.

    ratio: distance over thickness.  distance, thickness: pixels.  towards: (H, W, 2) unit, 0 at no distance.
    rounded: share of the pixel that lies around a point, an end or a corner, and not along a line.
    turned: by how much the stroke has turned up to the nearest point, and from it on, since that may be a corner; from
        half a pixel before a corner on they grow apart.
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
        """Whether a mark reaches each pixel."""
        return self.ratio.isfinite()

    def where(self, here: Tensor, other: "Nearest") -> "Nearest":
        """Return this one `here`, and the other elsewhere."""
        return Nearest(
            torch.where(here, self.ratio, other.ratio),
            torch.where(here, self.distance, other.distance),
            torch.where(here, self.thickness, other.thickness),
            torch.where(here[..., None], self.towards, other.towards),
            torch.where(here, self.rounded, other.rounded),
            (torch.where(here, self.turned[0], other.turned[0]), torch.where(here, self.turned[1], other.turned[1])),
            torch.where(here, self.tight, other.tight),
        )


def two_nearest(xy: Tensor, thickness: Tensor, grid: Tensor) -> tuple[Nearest, Nearest]:
    """Return what is nearest, and what is nearest of all that goes elsewhere and may meet it in a crease."""
    segments = _segments(xy)
    nothing = grid.new_zeros(grid.shape[:2])
    none = Nearest(
        nothing + torch.inf, nothing, nothing + 1, torch.zeros_like(grid), nothing, (nothing, nothing), nothing.bool()
    )
    each = [_nearest_on(segments, k, thickness, grid) for k in range(len(segments.length))]
    near = second = none
    for here in each:
        near = here.where(here.ratio < near.ratio, near)  # the maximum of darkness; the first segment wins a tie
    for here in each:
        turn = turn_between(here, near)
        meets = here.ratio * near.thickness < near.distance + turn.clamp(max=2) / 2
        second = here.where(near.tight & (turn > _TURN) & meets & (here.ratio < second.ratio), second)
    return near, second


def _nearest_on(segments: _Segments, k: int, thickness: Tensor, grid: Tensor) -> Nearest:
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
    touches = (held > _THINNEST) & (far < held + HALF_DIAGONAL)
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
            rounded = torch.maximum(rounded, wedge * fade(turn))
    before, here, after = segments.turned[k : k + 3]
    turned = before + (here - before) * (2 * since).clamp(0, 1), after + (here - after) * (2 * until).clamp(0, 1)
    towards = offset.detach() / torch.where(far > 0, far, 1.0)[..., None]
    tight = far >= _free_radius(segments, k) - _ROOM
    return Nearest(ratio, distance, at_pixel, towards, rounded.clamp(max=1), turned, tight)


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


def turn_between(one: Nearest, other: Nearest) -> Tensor:
    """Return by how much the stroke turns from the one to the other, (H, W)."""
    return torch.maximum(one.turned[0] - other.turned[1], other.turned[0] - one.turned[1])


def fade(turn: Tensor) -> Tensor:
    """Return from 0 to 1 how much a turn counts."""
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
