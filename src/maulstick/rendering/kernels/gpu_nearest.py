"""Which parts of a stroke are nearest to each pixel of a tile, in Triton's language (nearest.py)."""

import triton
import triton.language as tl

from maulstick.rendering.kernels.gpu_shapes import (
    AFTER,
    BEFORE,
    FIRST,
    LAST,
    LENGTH,
    SHAPE,
    SHARP_END,
    SHARP_START,
    SHARP_TURN,
    TIGHT_FROM,
    TURNED,
    TURNED_AFTER,
    TURNED_BEFORE,
    clamped,
    fade,
)
from maulstick.rendering.kernels.gpu_tiles import HALF_DIAGONAL, PIXELS, ends

_THINNEST = tl.constexpr(1e-6)  # as in nearest.py


@triton.jit
def foot(segments, segment, x, y):
    """Find the point of a segment nearest to each pixel: T, free and clamped, offset, thickness there, then slopes."""
    ux, uy, u, vx, vy, v = ends(segments, segment)
    wx, wy = vx - ux, vy - uy
    squared_length = wx * wx + wy * wy
    has_length = (squared_length > 0) & (squared_length < float("inf"))
    inverse = tl.where(has_length, 1.0 / tl.where(has_length, squared_length, 1.0), 0.0)
    wx, wy = tl.where(has_length, wx, 0.0), tl.where(has_length, wy, 0.0)
    dx, dy = x - ux, y - uy
    free = (dx * wx + dy * wy) * inverse
    t = tl.where(free > 0, tl.where(free < 1, free, 1.0), 0.0)
    # The very offset from the corner, so that both of its segments are as near and the first of them wins.
    ex, ey = tl.where(free >= 1, x - vx, dx - t * wx), tl.where(free >= 1, y - vy, dy - t * wy)
    return free, t, ex, ey, u * (1 - t) + v * t, wx, wy, inverse, v - u


@triton.jit
def _ratio(ex, ey, thickness):
    """Return (distance / thickness)^2, infinite where the mark does not reach the pixel."""
    distance, reach, squared = ex * ex + ey * ey, thickness + HALF_DIAGONAL, thickness * thickness
    touches = (thickness > _THINNEST) & (distance < reach * reach)
    # Division and root are rounded as in IEEE 754, so that a kink has the same side as in the reference.
    return tl.where(touches, tl.div_rn(distance, tl.where(touches, squared, 1.0)), float("inf"))


@triton.jit
def nearest(segments, pairs, first, last, x, y):
    """Return the nearest pair, -1 where there is none, its T, free, offset and thickness; the first wins a tie."""
    owner = tl.full([PIXELS], -1, tl.int32)
    ratio = tl.full([PIXELS], float("inf"), tl.float32)
    free, offset_x, offset_y = tl.zeros_like(ratio), tl.zeros_like(ratio), tl.zeros_like(ratio)
    thickness = tl.full([PIXELS], 1.0, tl.float32)
    for pair in range(first, last):
        its_free, _, ex, ey, h, _, _, _, _ = foot(segments, tl.load(pairs + pair), x, y)
        here = _ratio(ex, ey, h)
        nearer = here < ratio
        owner, ratio = tl.where(nearer, pair, owner), tl.where(nearer, here, ratio)
        free, thickness = tl.where(nearer, its_free, free), tl.where(nearer, h, thickness)
        offset_x, offset_y = tl.where(nearer, ex, offset_x), tl.where(nearer, ey, offset_y)
    return owner, free, offset_x, offset_y, thickness


@triton.jit
def _turned(shapes, segment, free):
    """Return by how much the stroke has turned up to the nearest point, and from it on."""
    shape = shapes + segment * SHAPE
    here, length = tl.load(shape + TURNED), tl.load(shape + LENGTH)
    before, after = tl.load(shape + TURNED_BEFORE), tl.load(shape + TURNED_AFTER)
    return (
        before + (here - before) * clamped(2 * length * free),
        after + (here - after) * clamped(2 * length * (1 - free)),
    )


@triton.jit
def second_nearest(segments, shapes, pairs, first, last, x, y, owner, free, offset_x, offset_y, thickness):
    """Return the nearest of all parts that go elsewhere and may meet the nearest one in a crease.

    The same as from `nearest`, but for T, and then the share of the pixel that it has, and the slant.
    """
    segment = tl.load(pairs + tl.maximum(owner, first))
    distance = tl.sqrt_rn(offset_x * offset_x + offset_y * offset_y)
    tight = (owner >= 0) & (distance >= tl.load(shapes + segment * SHAPE + TIGHT_FROM))
    near_from, near_to = _turned(shapes, segment, free)
    second = tl.full([PIXELS], -1, tl.int32)
    ratio = tl.full([PIXELS], float("inf"), tl.float32)
    second_x, second_y, turn = tl.zeros_like(ratio), tl.zeros_like(ratio), tl.zeros_like(ratio)
    second_thickness = tl.full([PIXELS], 1.0, tl.float32)
    looks = tl.max(tight.to(tl.int32), axis=0) > 0
    for pair in range(first, tl.where(looks, last, first)):
        other = tl.load(pairs + pair)
        its_free, _, ex, ey, h, _, _, _, _ = foot(segments, other, x, y)
        its_from, its_to = _turned(shapes, other, its_free)
        its_turn = tl.maximum(its_from - near_to, near_from - its_to)
        here = _ratio(ex, ey, h)
        within = tl.sqrt_rn(here) * thickness < distance + tl.minimum(its_turn, 2.0) / 2
        nearer = tight & (its_turn > SHARP_TURN) & within & (here < ratio)
        second, ratio, turn = (
            tl.where(nearer, pair, second),
            tl.where(nearer, here, ratio),
            tl.where(nearer, its_turn, turn),
        )
        second_x, second_y = tl.where(nearer, ex, second_x), tl.where(nearer, ey, second_y)
        second_thickness = tl.where(nearer, h, second_thickness)
    meets = second >= 0
    further = tl.sqrt_rn(second_x * second_x + second_y * second_y)
    unit, its_unit = 1 / tl.where(distance > 0, distance, 1.0), 1 / tl.where(further > 0, further, 1.0)
    apart_x, apart_y = offset_x * unit - second_x * its_unit, offset_y * unit - second_y * its_unit
    rate = tl.sqrt_rn(apart_x * apart_x + apart_y * apart_y)
    meets = meets & (rate > 0)
    opens = tl.where(meets, tl.minimum(rate, turn), 1.0)  # by how much the one gets nearer than the other, per pixel
    gap = further / second_thickness * thickness - distance
    share = tl.where(meets, tl.minimum(clamped(0.5 - gap / opens), 0.5) * fade(turn), 0.0)
    return second, second_x, second_y, second_thickness, share, rate / 2


@triton.jit
def _share_beyond(pixels):
    """Return the share of a pixel that lies beyond what is so far from its centre."""
    return clamped(0.5 - pixels)


@triton.jit
def rounded_share(segments, shapes, segment, x, y):
    """Return the share of each pixel that lies around a point and not along its segment.

    Then the segment's direction, and 1 where the share grows while the stroke's start moves in that direction, and
    where it grows while its end moves against it, else 0.
    """
    ux, uy, _, vx, vy, _ = ends(segments, segment)
    shape = shapes + segment * SHAPE
    direction_x, direction_y = tl.load(shape), tl.load(shape + 1)
    since = (x - ux) * direction_x + (y - uy) * direction_y
    until = tl.load(shape + LENGTH) - since
    is_first, is_last = tl.load(shape + FIRST) > 0, tl.load(shape + LAST) > 0
    start = _share_beyond(tl.load(shape + BEFORE) + tl.where(is_first, since, tl.maximum(since, 0.0)))
    end = _share_beyond(tl.load(shape + AFTER) + tl.where(is_last, until, tl.maximum(until, 0.0)))
    previous, following = tl.where(is_first, shape, shape - SHAPE), tl.where(is_last, shape, shape + SHAPE)
    theirs = (ux - x) * tl.load(previous) + (uy - y) * tl.load(previous + 1)
    wedge = tl.load(shape + SHARP_START) * clamped(_share_beyond(since) + _share_beyond(theirs) - 1)
    theirs = (x - vx) * tl.load(following) + (y - vy) * tl.load(following + 1)
    end_wedge = tl.load(shape + SHARP_END) * clamped(_share_beyond(until) + _share_beyond(theirs) - 1)
    wedge = tl.maximum(wedge, end_wedge)
    share = start + end
    grows = (share <= 1) & (share >= wedge)
    by_start = (grows & (start > 0) & (start < 1)).to(tl.float32)
    by_end = (grows & (end > 0) & (end < 1)).to(tl.float32)
    return tl.minimum(tl.maximum(share, wedge), 1.0), direction_x, direction_y, by_start, by_end
