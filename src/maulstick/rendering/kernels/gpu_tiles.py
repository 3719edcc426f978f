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
def pixels(tile, height, width):
    """Return for each pixel of a tile its centre x and y, its index in an image, and whether it lies inside."""
    across = tl.cdiv(width, TILE)
    pixel = tl.arange(0, PIXELS)
    column = tile % across * TILE + pixel % TILE
    row = tile // across * TILE + pixel // TILE
    inside = (column < width) & (row < height)
    return column.to(tl.float32) + 0.5, row.to(tl.float32) + 0.5, row.to(tl.int64) * width + column, inside
