"""Programs that run on the GPU, in Triton's language: lists of tiles, and the two operations forwards and backwards.

A tile is TILE x TILE pixels, the work of one program. A **pair** is a segment and a tile that it may mark; an **item**
is all pairs of one stroke in one tile, in order. `gpu.py` prepares the tensors:

segments: (S, 6) x, y, thickness at the start, then at the end.  strokes: (N, 3 + C) falloff c, plateau q, opacity o,
then the colour.  pairs: (P,) segment of each.  items: (I + 1, 3) first pair, stroke, tile.
tiles: (T + 1,) first item of each.
records: (P, 9 + C) gradients of a pair's segment and, in the first pair of an item, of the stroke's numbers and colour.
"""

import triton
import triton.language as tl

TILE = tl.constexpr(16)  # pixels a side
PIXELS = tl.constexpr(256)  # of a tile: TILE * TILE
LANES = tl.constexpr(128)  # segments that one program lists


@triton.jit
def _ends(segments, segment):
    at = segments + segment * 6
    return tl.load(at), tl.load(at + 1), tl.load(at + 2), tl.load(at + 3), tl.load(at + 4), tl.load(at + 5)


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
    ux, uy, u, vx, vy, v = _ends(segments, tl.minimum(segment, count - 1))
    reach = tl.maximum(u, v)
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
    ux, uy, u, vx, vy, v = _ends(segments, known)
    reach = tl.maximum(u, v)
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
def _pixels(tile, height, width):
    """Return for each pixel of a tile its centre x and y, its index in an image, and whether it lies inside."""
    across = tl.cdiv(width, TILE)
    pixel = tl.arange(0, PIXELS)
    column = tile % across * TILE + pixel % TILE
    row = tile // across * TILE + pixel // TILE
    inside = (column < width) & (row < height)
    return column.to(tl.float32) + 0.5, row.to(tl.float32) + 0.5, row.to(tl.int64) * width + column, inside


@triton.jit
def _foot(segments, segment, x, y):
    """Find the point of a segment nearest to each pixel: T, free and clamped, offset, thickness there, then slopes."""
    ux, uy, u, vx, vy, v = _ends(segments, segment)
    wx, wy = vx - ux, vy - uy
    squared_length = wx * wx + wy * wy
    has_length = (squared_length > 0) & (squared_length < float("inf"))
    inverse = tl.where(has_length, 1.0 / tl.where(has_length, squared_length, 1.0), 0.0)
    wx, wy = tl.where(has_length, wx, 0.0), tl.where(has_length, wy, 0.0)
    dx, dy = x - ux, y - uy
    free = (dx * wx + dy * wy) * inverse
    t = tl.where(free > 0, tl.where(free < 1, free, 1.0), 0.0)
    return free, t, dx - t * wx, dy - t * wy, u * (1 - t) + v * t, wx, wy, inverse, v - u


@triton.jit
def _cover(segments, pairs, first, last, x, y):
    """Return (distance / thickness)^2 of the nearest segment, at most 2, and its pair; the first wins a tie."""
    square = tl.full([PIXELS], 2.0, tl.float32)
    owner = tl.full([PIXELS], -1, tl.int32)
    for pair in range(first, last):
        _, _, ex, ey, thickness, _, _, _, _ = _foot(segments, tl.load(pairs + pair), x, y)
        squared = thickness * thickness
        marks = (thickness > 0) & (squared > 0)  # a thickness whose square underflows leaves no mark
        # Division and root are rounded as in IEEE 754, so that a kink has the same side as in the reference.
        here = tl.div_rn(ex * ex + ey * ey, tl.where(marks, squared, 1.0))
        nearer = marks & (here < square)
        square = tl.where(nearer, here, square)
        owner = tl.where(nearer, pair, owner)
    return square, owner


@triton.jit
def _darken(square, stroke):
    """Return darkness, ratio, base and its binary logarithm; the base is 1 on the plateau and outside the mark."""
    c, q, o = tl.load(stroke), tl.load(stroke + 1), tl.load(stroke + 2)
    ratio = tl.sqrt_rn(tl.where(square < 1, square, 1.0))
    ramp = tl.div_rn(1 - ratio, 1 - q)
    inside = ramp > 0
    base = tl.where(inside & (ramp < 1), ramp, 1.0)
    log = tl.log2(base)
    return tl.where(inside, o * tl.exp2(c * log), 0.0), ratio, base, log


@triton.jit
def _add_gradients(
    record, size, slots, segments, pairs, first, last, stroke, x, y, owner, value, ratio, base, log, grad
):
    """Write the gradients of an item's segments and of its stroke's numbers; grad: that of each pixel's darkness."""
    c, q, o = tl.load(stroke), tl.load(stroke + 1), tl.load(stroke + 2)
    weighted = grad * value
    grad_base = tl.where(base < 1, weighted * c / base, 0.0)
    numbers = record + tl.load(slots + first) * size + 6
    tl.store(numbers, tl.sum(weighted * log) * 0.6931471805599453)
    tl.store(numbers + 1, tl.sum(grad_base * base) / (1 - q))
    tl.store(numbers + 2, tl.sum(weighted) / o)
    grad_ratio = -grad_base / (1 - q)
    for pair in range(first, last):
        free, t, ex, ey, thickness, wx, wy, inverse, growth = _foot(segments, tl.load(pairs + pair), x, y)
        mine = (owner == pair) & (ratio < 1)
        thickness = tl.where(mine, thickness, 1.0)
        grad_thickness = tl.where(mine, -grad_ratio * ratio / thickness, 0.0)
        # In the distance to the foot of the perpendicular, the derivative with respect to T is 0 ...
        apart = mine & (ratio > 0)
        per_distance = tl.where(apart, -grad_ratio / (tl.where(apart, ratio, 1.0) * thickness * thickness), 0.0)
        foot_x, foot_y = per_distance * ex, per_distance * ey
        # ... but the thickness depends on T wherever T is not clamped.
        moves = (free > 0) & (free < 1) & (grad_thickness != 0)
        grad_t = tl.where(moves, grad_thickness * (growth * inverse), 0.0)
        end_x, end_y = grad_t * (ex - t * wx), grad_t * (ey - t * wy)
        at = record + tl.load(slots + pair) * size
        tl.store(at, tl.sum(foot_x * (1 - t) - grad_t * wx - end_x))
        tl.store(at + 1, tl.sum(foot_y * (1 - t) - grad_t * wy - end_y))
        tl.store(at + 2, tl.sum(grad_thickness * (1 - t)))
        tl.store(at + 3, tl.sum(foot_x * t + end_x))
        tl.store(at + 4, tl.sum(foot_y * t + end_y))
        tl.store(at + 5, tl.sum(grad_thickness * t))


@triton.jit
def darkness(images, segments, strokes, pairs, items, height, width):
    """Draw one item per program into images: (N, H, W), which must be 0 before."""
    item = items + tl.program_id(0) * 3
    stroke = tl.load(item + 1)
    x, y, place, inside = _pixels(tl.load(item + 2), height, width)
    square, _ = _cover(segments, pairs, tl.load(item), tl.load(item + 3), x, y)
    value, _, _, _ = _darken(square, strokes + stroke * 3)
    tl.store(images + stroke.to(tl.int64) * height * width + place, value, mask=inside)


@triton.jit
def darkness_backward(grad_images, records, slots, segments, strokes, pairs, items, height, width):
    """Write the gradients of one item per program into records; grad_images: (N, H, W)."""
    item = items + tl.program_id(0) * 3
    first, last, stroke = tl.load(item), tl.load(item + 3), tl.load(item + 1)
    x, y, place, inside = _pixels(tl.load(item + 2), height, width)
    square, owner = _cover(segments, pairs, first, last, x, y)
    numbers = strokes + stroke * 3
    value, ratio, base, log = _darken(square, numbers)
    grad = tl.load(grad_images + stroke.to(tl.int64) * height * width + place, mask=inside, other=0.0)
    _add_gradients(records, 9, slots, segments, pairs, first, last, numbers, x, y, owner, value, ratio, base, log, grad)


@triton.jit
def composite(canvas, out, segments, strokes, pairs, items, tiles, channels, height, width, CHANNELS: tl.constexpr):
    """Paint one tile per program. canvas, out: (C, H, W).  CHANNELS: C rounded up to a power of two."""
    x, y, place, inside = _pixels(tl.program_id(0), height, width)
    channel = tl.arange(0, CHANNELS)
    known = channel < channels
    place = (channel.to(tl.int64) * height * width)[:, None] + place[None, :]
    inside = known[:, None] & inside[None, :]
    beneath = tl.load(canvas + place, mask=inside, other=0.0)
    for number in range(tl.load(tiles + tl.program_id(0)), tl.load(tiles + tl.program_id(0) + 1)):
        item = items + number * 3
        square, _ = _cover(segments, pairs, tl.load(item), tl.load(item + 3), x, y)
        stroke = strokes + tl.load(item + 1) * (3 + channels)
        value, _, _, _ = _darken(square, stroke)
        colour = tl.load(stroke + 3 + channel, mask=known, other=0.0)
        beneath += value[None, :] * (colour[:, None] - beneath)
    tl.store(out + place, beneath, mask=inside)


@triton.jit
def composite_backward(
    canvas,
    grad_out,
    grad_canvas,
    above,
    records,
    trainable,
    slots,
    segments,
    strokes,
    pairs,
    items,
    tiles,
    channels,
    height,
    width,
    CHANNELS: tl.constexpr,
):
    """Write the gradients of one tile per program into grad_canvas and records.

    canvas, grad_out, grad_canvas: (C, H, W).  above: (I, PIXELS), scratch.  trainable: (N,).

    The gradient of an item's darkness is sum(grad_out * above * (colour - beneath)): `above` is the share that later
    strokes let through, found from the last item to the first; `beneath` is what earlier strokes painted, found from
    the first to the last.
    """
    x, y, place, inside = _pixels(tl.program_id(0), height, width)
    channel = tl.arange(0, CHANNELS)
    known = channel < channels
    place = (channel.to(tl.int64) * height * width)[:, None] + place[None, :]
    inside = known[:, None] & inside[None, :]
    begin, end = tl.load(tiles + tl.program_id(0)), tl.load(tiles + tl.program_id(0) + 1)
    shade = above + begin.to(tl.int64) * PIXELS + tl.arange(0, PIXELS)

    through = tl.full([PIXELS], 1.0, tl.float32)
    for step in range(end - begin):
        number = end - 1 - step
        item = items + number * 3
        square, _ = _cover(segments, pairs, tl.load(item), tl.load(item + 3), x, y)
        value, _, _, _ = _darken(square, strokes + tl.load(item + 1) * (3 + channels))
        tl.store(shade + (number - begin) * PIXELS, through)
        through *= 1 - value
    grad = tl.load(grad_out + place, mask=inside, other=0.0)
    tl.store(grad_canvas + place, grad * through[None, :], mask=inside)
    tl.debug_barrier()  # other threads read `above` than wrote it

    beneath = tl.load(canvas + place, mask=inside, other=0.0)
    size = 9 + channels
    for number in range(begin, end):
        item = items + number * 3
        first, last, id = tl.load(item), tl.load(item + 3), tl.load(item + 1)
        square, owner = _cover(segments, pairs, first, last, x, y)
        stroke = strokes + id * (3 + channels)
        value, ratio, base, log = _darken(square, stroke)
        change = tl.load(stroke + 3 + channel, mask=known, other=0.0)[:, None] - beneath
        if tl.load(trainable + id) != 0:
            here = grad * tl.load(shade + (number - begin) * PIXELS)[None, :]
            colour = records + tl.load(slots + first) * size + 9 + channel
            tl.store(colour, tl.sum(here * value[None, :], axis=1), mask=known)
            grad_value = tl.sum(here * change, axis=0)
            _add_gradients(
                records,
                size,
                slots,
                segments,
                pairs,
                first,
                last,
                stroke,
                x,
                y,
                owner,
                value,
                ratio,
                base,
                log,
                grad_value,
            )
        beneath += value[None, :] * change
