"""Lists of the segments that may mark each tile, in Triton's language (explained in `gpu_programs`)."""

import math

import triton
import triton.language as tl

TILE = tl.constexpr(8)  # pixels a side: strokes are thin, and larger tiles have more pixels beside them
PIXELS = tl.constexpr(64)  # of a tile: TILE * TILE
LANES = tl.constexpr(128)  # segments, pairs or tiles that one program prepares
SPAN = tl.constexpr(32)  # segments of a stroke that its program prepares at once
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
def list_segments(points, thickness, strokes, segments, counts, count, each, after, columns, height, width):
    """Write segments: (S, 6), and the number of tiles in which each may leave a mark into counts: (S + 1,).

    Behind these is added how many cannot be drawn: a number of theirs is not finite, or of their strokes' out of range.
    each: segments of a stroke.  after: 1, or 0 for a dot, whose segment starts and ends in its one point.
    columns: of strokes.
    """
    segment = tl.program_id(0) * LANES + tl.arange(0, LANES)
    known = segment < count
    segment = tl.minimum(segment, count - 1)
    stroke = segment // each
    point = segment + stroke * after
    ux, uy, u = tl.load(points + point * 2), tl.load(points + point * 2 + 1), tl.load(thickness + point)
    point += after
    vx, vy, v = tl.load(points + point * 2), tl.load(points + point * 2 + 1), tl.load(thickness + point)
    at = segments + segment * 6
    tl.store(at, ux, mask=known)
    tl.store(at + 1, uy, mask=known)
    tl.store(at + 2, u, mask=known)
    tl.store(at + 3, vx, mask=known)
    tl.store(at + 4, vy, mask=known)
    tl.store(at + 5, v, mask=known)

    at = strokes + stroke * columns
    c, q, opacity = tl.load(at), tl.load(at + 1), tl.load(at + 2)
    good = (c > 0) & (c < float("inf")) & (q >= 0) & (q < 1) & (opacity > 0) & (opacity <= 1)
    for column in range(3, columns):
        good = good & (tl.abs(tl.load(at + column)) < float("inf"))
    good = good & (tl.abs(ux) < float("inf")) & (tl.abs(uy) < float("inf")) & (tl.abs(u) < float("inf"))
    good = good & (tl.abs(vx) < float("inf")) & (tl.abs(vy) < float("inf")) & (tl.abs(v) < float("inf"))
    faults = tl.sum((~good & known).to(tl.int64))
    tl.atomic_add(counts + count, faults, mask=faults > 0)

    reach = _reach(u, v)
    first, last = _rows(uy, vy, reach, height)
    total = tl.zeros([LANES], tl.int32)
    for step in range(tl.max(last - first) + 1):
        row = first + step
        left, right = _columns(row, ux, uy, vx, vy, reach, width)
        total += tl.where((row <= last) & (left <= right), right - left + 1, 0)
    tl.store(counts + segment, total, mask=known)


@triton.jit
def list_tiles(segments, starts, keys, count, room, height, width):
    """Write tile * S + segment of each pair into keys: (room,), sorted by segments; what lies beyond is left out.

    starts: (S,) first key of each.
    """
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
            tile = (row * across + left + column).to(keys.dtype.element_ty)
            tl.store(keys + at, tile * count + segment, mask=inside & (at < room))
            at += inside.to(tl.int64)


@triton.jit
def find_items(keys, pairs, firsts, room, beyond, count, each):
    """Write the segment of each sorted key into pairs: (room,), and whether an item begins there into firsts.

    firsts: (room + 1,), behind its first number.  beyond: the key that stands where there is no pair.  count: of
    segments.
    """
    pair = tl.program_id(0) * LANES + tl.arange(0, LANES)
    inside = pair < room
    key = tl.load(keys + pair, mask=inside, other=0)
    before = tl.load(keys + pair - 1, mask=inside & (pair > 0), other=0)
    begins = (key < beyond) & ((pair == 0) | (key // each != before // each))
    tl.store(firsts + pair + 1, begins.to(tl.int32), mask=inside)
    tl.store(firsts + pair, 0, mask=pair == 0)
    tl.store(pairs + pair, (key % count).to(tl.int32), mask=inside)


@triton.jit
def list_items(keys, numbers, items, room, item_room, beyond, count, each):
    """Write the items of sorted keys: (item_room + 1, 3); what lies beyond is left out.

    numbers: (room + 1,), of items before each key.  count: of strokes.
    """
    pair = tl.program_id(0) * LANES + tl.arange(0, LANES)
    key = tl.load(keys + pair, mask=pair < room, other=beyond)
    known = key < beyond
    number, after = tl.load(numbers + pair, mask=known, other=0), tl.load(numbers + pair + 1, mask=known, other=0)
    stroke = key // each  # in a tile: tile * count + stroke
    at, begins = items + number * 3, after > number
    tl.store(at, pair, mask=begins & (number <= item_room))  # where the one before ends, too
    tl.store(at + 1, (stroke % count).to(tl.int32), mask=begins & (number < item_room))
    tl.store(at + 2, (stroke // count).to(tl.int32), mask=begins & (number < item_room))
    following = tl.load(keys + pair + 1, mask=pair + 1 < room, other=beyond)
    tl.store(items + after * 3, pair + 1, mask=known & (following >= beyond) & (after <= item_room))


@triton.jit
def find_tiles(keys, numbers, tiles, room, item_room, count, tile_count):
    """Write the first item of each tile and, behind, the number of items into tiles: (T + 1,); at most item_room.

    keys: (room,), sorted.  numbers: (room + 1,), of items before each.  count: of segments.
    """
    tile = tl.program_id(0) * LANES + tl.arange(0, LANES)
    wanted = tl.minimum(tile, tile_count).to(keys.dtype.element_ty) * count
    low, high = tl.zeros([LANES], tl.int32), tl.zeros([LANES], tl.int32) + room
    left = room
    while left > 0:  # halves what is left between low and high
        middle = (low + high) // 2
        smaller = (low < high) & (tl.load(keys + middle, mask=low < high, other=0) < wanted)
        low, high = tl.where(smaller, middle + 1, low), tl.where(smaller, high, middle)
        left = left // 2
    tl.store(tiles + tile, tl.minimum(tl.load(numbers + low), item_room), mask=tile <= tile_count)


@triton.jit
def pixels(tile, height, width):
    """Return for each pixel of a tile its centre x and y, its index in an image, and whether it lies inside."""
    across = tl.cdiv(width, TILE)
    pixel = tl.arange(0, PIXELS)
    column = tile % across * TILE + pixel % TILE
    row = tile // across * TILE + pixel // TILE
    inside = (column < width) & (row < height)
    return column.to(tl.float32) + 0.5, row.to(tl.float32) + 0.5, row.to(tl.int64) * width + column, inside
