"""How a stroke goes on around each of its segments, in Triton's language (nearest.py, _Segments and _free_radius).

shapes: (S, SHAPE) direction x and y, length; pixels along the stroke before and after it; by how much the stroke has
turned up to the segments before, here and after; from 0 to 1 how much its corners at the start and at the end count;
from how far on another part may be as near; whether it is the stroke's first, and its last.
"""

import triton
import triton.language as tl

from maulstick.rendering.kernels.gpu_tiles import LANES, SPAN, ends

SHAPE = tl.constexpr(13)
LENGTH, BEFORE, AFTER = tl.constexpr(2), tl.constexpr(3), tl.constexpr(4)
TURNED_BEFORE, TURNED, TURNED_AFTER = tl.constexpr(5), tl.constexpr(6), tl.constexpr(7)
SHARP_START, SHARP_END, TIGHT_FROM = tl.constexpr(8), tl.constexpr(9), tl.constexpr(10)
FIRST, LAST = tl.constexpr(11), tl.constexpr(12)

# As in nearest.py: _TURN, _FADE, _ROOM, _LONG.
SHARP_TURN, TURN_FADE = tl.constexpr(0.8), tl.constexpr(0.3)
_ROOM, _LONG = tl.constexpr(1.0), tl.constexpr(4.0)
_NOWHERE = tl.constexpr(1e15)


@triton.jit
def clamped(share):
    """Return what lies in [0, 1]; 0 for NaN."""
    return tl.where(share > 0, tl.where(share < 1, share, 1.0), 0.0)


@triton.jit
def fade(turn):
    """Return from 0 to 1 how much a turn counts."""
    return clamped((turn - SHARP_TURN) / TURN_FADE)


@triton.jit
def _course(segments, segment):
    """Return the direction of segments, a unit or 0, and their length, in float64."""
    ux, uy, _, vx, vy, _ = ends(segments, segment)
    wx, wy = vx.to(tl.float64) - ux.to(tl.float64), vy.to(tl.float64) - uy.to(tl.float64)
    length = tl.sqrt(wx * wx + wy * wy)
    some = tl.where(length > 0, length, 1.0)
    return wx / some, wy / some, length


@triton.jit
def _latest(a, b):
    return tl.maximum(a, b)


@triton.jit
def find_shapes(segments, shapes, each):
    """Write all but `tight from` of the shapes of a stroke with so many segments, one stroke per program."""
    at = tl.program_id(0) * each
    nothing = tl.sum(tl.zeros([SPAN], tl.float64))
    whole, before, turned, moved = nothing, nothing, nothing, -1
    for begin in range(0, each, SPAN):
        k = begin + tl.arange(0, SPAN)
        _, _, length = _course(segments, at + tl.minimum(k, each - 1))
        whole += tl.sum(tl.where(k < each, length, 0.0))
    for begin in range(0, each, SPAN):
        k = begin + tl.arange(0, SPAN)
        known = k < each
        segment = at + tl.minimum(k, each - 1)
        x, y, length = _course(segments, segment)
        length = tl.where(known, length, 0.0)
        _, _, previous = _course(segments, tl.maximum(segment - 1, at))
        heading = tl.where(known & (k > 0) & (previous > 0), k - 1, -1)  # the segment before that has a direction
        heading = tl.maximum(tl.associative_scan(heading, 0, _latest), moved)
        heading_x, heading_y, _ = _course(segments, at + tl.maximum(heading, 0))
        across = tl.abs(heading_x * y - heading_y * x)
        along = heading_x * x + heading_y * y + 1  # a corner counts as twice the tangent of half its turn
        turn = tl.where(across < 4 * along, 2 * across / tl.where(along > 0, along, 1.0), 8.0)
        turn = tl.where((length > 0) & (heading >= 0), turn, 0.0)
        since = before + tl.cumsum(tl.where(k > begin, previous, 0.0))
        turns = turned + tl.cumsum(turn)
        shape = shapes + segment * SHAPE
        tl.store(shape, x.to(tl.float32), mask=known)
        tl.store(shape + 1, y.to(tl.float32), mask=known)
        tl.store(shape + LENGTH, tl.minimum(length, _NOWHERE).to(tl.float32), mask=known)
        tl.store(shape + BEFORE, tl.minimum(since, _NOWHERE).to(tl.float32), mask=known)
        tl.store(
            shape + AFTER, tl.minimum(tl.maximum(whole - since - length, 0.0), _NOWHERE).to(tl.float32), mask=known
        )
        tl.store(shape + TURNED_BEFORE, (turns - turn).to(tl.float32), mask=known)
        tl.store(shape + TURNED, turns.to(tl.float32), mask=known)
        tl.store(shape + SHARP_START, fade(turn).to(tl.float32), mask=known)
        later = known & (k > 0)
        tl.store(shape - SHAPE + TURNED_AFTER, turns.to(tl.float32), mask=later)
        tl.store(shape - SHAPE + SHARP_END, fade(turn).to(tl.float32), mask=later)
        last = k == each - 1
        tl.store(shape + FIRST, (k == 0).to(tl.float32), mask=known)
        tl.store(shape + LAST, last.to(tl.float32), mask=known)
        tl.store(shape + TURNED_AFTER, turns.to(tl.float32), mask=last)
        tl.store(shape + SHARP_END, tl.zeros([SPAN], tl.float32), mask=last)
        before += tl.sum(length)
        turned += tl.sum(turn)
        moved = tl.maximum(moved, tl.max(tl.where(length > 0, k, -1)))


@triton.jit
def _radius(x, y, direction_x, direction_y, length):
    """Return the radius of the disc that touches a segment and a point, given from the segment's start."""
    along, across = x * direction_x + y * direction_y, tl.abs(x * direction_y - y * direction_x)
    beside = along - tl.minimum(tl.maximum(along, 0.0), length)
    return (beside * beside + across * across) / (2 * tl.maximum(across, 1e-6))


@triton.jit
def find_tight(segments, shapes, count, each):
    """Write from how far on another part of the stroke may be as near; count: of segments."""
    segment = tl.program_id(0) * LANES + tl.arange(0, LANES)
    known = tl.minimum(segment, count - 1)
    ux, uy, _, _, _, _ = ends(segments, known)
    shape = shapes + known * SHAPE
    dx, dy, length, turned = tl.load(shape), tl.load(shape + 1), tl.load(shape + LENGTH), tl.load(shape + TURNED)
    radius = tl.full([LANES], _NOWHERE, tl.float32)
    for k in range(each):
        other = known // each * each + k
        ax, ay, _, bx, by, _ = ends(segments, other)
        ax, ay, bx, by = ax - ux, ay - uy, bx - ux, by - uy
        its_length = tl.load(shapes + other * SHAPE + LENGTH)
        middle = _radius((ax + bx) / 2, (ay + by) / 2, dx, dy, length)
        middle = tl.where(its_length > _LONG, 0.0, tl.where(its_length > 1, middle, _NOWHERE))
        its = tl.minimum(_radius(ax, ay, dx, dy, length), _radius(bx, by, dx, dy, length))
        its = tl.minimum(its, middle)
        turns = tl.abs(tl.load(shapes + other * SHAPE + TURNED) - turned) > SHARP_TURN
        radius = tl.where(turns & (its < radius), its, radius)
    tl.store(shape + TIGHT_FROM, radius - _ROOM, mask=segment < count)
