"""Lists of the segments that may mark each tile, in Triton's language (explained in `gpu_programs`)."""

import math

import triton
import triton.language as tl

TILE = tl.constexpr(16)  # pixels a side
PIXELS = tl.constexpr(256)  # of a tile: TILE * TILE
LANES = tl.constexpr(128)  # segments or strokes that one program prepares
HALF_DIAGONAL = tl.constexpr(math.sqrt(0.5))  # of a pixel


@triton.jit
def ends(segments, segment):
    """Return x, y and thickness at the start of segments, and at their end."""
    at = segments + segment * 6
    return tl.load(at), tl.load(at + 1), tl.load(at + 2), tl.load(at + 3), tl.load(at + 4), tl.load(at + 5)


@triton.jit
def _reach(u, v):
    widest = tl.maximum(u, v)
    return tl.where(widest > 0, widest + HALF_DIAGONAL, 0.0)


@triton.jit
def _span(low, high, size):
    """Return the first and last tile between low and high; last < first where there is none. NaN skips no tile."""
    outside = (high < 0) | (low > size)
    low = tl.where(low > 0, tl.where(low < size, low, size), 0.0)
    high = tl.where(high < size - 0.5, high, size - 0.5)
    first = (low / TILE).to(tl.int32)
    return first, tl.where(outside, -1, (tl.where(outside, 0.0, high) / TILE).to(tl.int32))


@triton.jit
def _rows(uy, vy, reach, height):
    first, last = _span(tl.minimum(uy, vy) - reach, tl.maximum(uy, vy) + reach, height)
    return first, tl.where(reach > 0, last, -1)


@triton.jit
def _columns(row, ux, uy, vx, vy, reach, width):
    """Return the first and last tile of a row through which a segment passes, widened by its reach."""
    wx, wy = vx - ux, vy - uy
    sloped = wy != 0
    slope = tl.where(sloped, wy, 1.0)
    a = (row * TILE - reach - uy) / slope
    b = (row * TILE + TILE + reach - uy) / slope
    enters = tl.where(sloped, tl.minimum(a, b), 0.0)
    leaves = tl.where(sloped, tl.maximum(a, b), 1.0)
    start = ux + tl.where(enters > 0, enters, 0.0) * wx
    stop = ux + tl.where(leaves < 1, leaves, 1.0) * wx
    return _span(tl.minimum(start, stop) - reach, tl.maximum(start, stop) + reach, width)


@triton.jit
def count_tiles(segments, counts, count, height, width):
    """Count the tiles in which each segment may leave a mark, into counts: (S,)."""
    segment = tl.program_id(0) * LANES + tl.arange(0, LANES)
    ux, uy, u, vx, vy, v = ends(segments, tl.minimum(segment, count - 1))
    reach = _reach(u, v)
    first, last = _rows(uy, vy, reach, height)
    total = tl.zeros([LANES], tl.int32)
    for step in range(tl.max(last - first) + 1):
        row = first + step
        left, right = _columns(row, ux, uy, vx, vy, reach, width)
        total += tl.where((row <= last) & (left <= right), right - left + 1, 0)
    tl.store(counts + segment, total, mask=segment < count)


@triton.jit
def list_tiles(segments, starts, keys, count, height, width):
    """Write tile * S + segment of each pair into keys: (P,), sorted by segments; starts: (S,) first key of each."""
    segment = tl.program_id(0) * LANES + tl.arange(0, LANES)
    known = tl.minimum(segment, count - 1)
    ux, uy, u, vx, vy, v = ends(segments, known)
    reach = _reach(u, v)
    first, last = _rows(uy, vy, reach, height)
    across = tl.cdiv(width, TILE)
    at = tl.load(starts + known)
    for step in range(tl.max(last - first) + 1):
        row = first + step
        left, right = _columns(row, ux, uy, vx, vy, reach, width)
        right = tl.where((row <= last) & (segment < count), right, -1)
        for column in range(tl.max(right - left) + 1):
            inside = left + column <= right
            tile = (row * across + left + column).to(tl.int64)
            tl.store(keys + at, tile * count + segment, mask=inside)
            at += inside.to(tl.int64)


@triton.jit
def count_faults(segments, strokes, faults, count, each, columns):
    """Add to faults, (1,), how many strokes cannot be drawn: a number is not finite, or out of range.

    each: segments of a stroke.  columns: of strokes.
    """
    stroke = tl.program_id(0) * LANES + tl.arange(0, LANES)
    known = tl.minimum(stroke, count - 1)
    at = strokes + known * columns
    c, q, opacity = tl.load(at), tl.load(at + 1), tl.load(at + 2)
    good = (c > 0) & (c < float("inf")) & (q >= 0) & (q < 1) & (opacity > 0) & (opacity <= 1)
    for column in range(3, columns):
        good = good & (tl.abs(tl.load(at + column)) < float("inf"))
    for number in range(each * 6):
        good = good & (tl.abs(tl.load(segments + known * each * 6 + number)) < float("inf"))
    tl.atomic_add(faults, tl.sum((~good & (stroke < count)).to(tl.int64)))


@triton.jit
def find_items(keys, pairs, firsts, total, count, each):
    """Write the segment of each of so many sorted keys into pairs: (P,), and whether an item begins there into firsts.

    firsts: (P + 1,), behind its first number.  count: of segments.
    """
    pair = tl.program_id(0) * LANES + tl.arange(0, LANES)
    known = pair < total
    key = tl.load(keys + pair, mask=known, other=0)
    before = tl.load(keys + pair - 1, mask=known & (pair > 0), other=0)
    begins = (pair == 0) | (key // each != before // each)
    tl.store(firsts + pair + 1, begins.to(tl.int64), mask=known)
    tl.store(pairs + pair, (key % count).to(tl.int32), mask=known)


@triton.jit
def list_items(keys, numbers, items, total, count, each):
    """Write the items of so many sorted keys; numbers: (P + 1,), of items before each.  count: of strokes."""
    pair = tl.program_id(0) * LANES + tl.arange(0, LANES)
    known = pair < total
    number, after = tl.load(numbers + pair, mask=known, other=0), tl.load(numbers + pair + 1, mask=known, other=0)
    stroke = tl.load(keys + pair, mask=known, other=0) // each  # in a tile: tile * count + stroke
    at = items + number * 3
    tl.store(at, pair, mask=after > number)
    tl.store(at + 1, (stroke % count).to(tl.int32), mask=after > number)
    tl.store(at + 2, (stroke // count).to(tl.int32), mask=after > number)
    tl.store(items + after * 3, total, mask=pair == total - 1)


@triton.jit
def pixels(tile, height, width):
    """Return for each pixel of a tile its centre x and y, its index in an image, and whether it lies inside."""
    across = tl.cdiv(width, TILE)
    pixel = tl.arange(0, PIXELS)
    column = tile % across * TILE + pixel % TILE
    row = tile // across * TILE + pixel // TILE
    inside = (column < width) & (row < height)
    return column.to(tl.float32) + 0.5, row.to(tl.float32) + 0.5, row.to(tl.int64) * width + column, inside
