"""Programs that run on the GPU, in Triton's language: the two operations, forwards and backwards.

A tile is TILE x TILE pixels. A **pair** is a segment and a tile that it may mark; an **item** is all pairs of one
stroke in one tile, in order. One program shades an item, and one blends all items of a tile. `gpu_lists` makes the
tensors:

segments: (S, 6) x, y, thickness at the start, then at the end.  shapes: (S, SHAPE), explained in `gpu_shapes`.
strokes: (N, 4 + C) falloff c, plateau q, opacity o, 1 if it gets gradients, else 0, then the colour.
pairs: (P,) segment of each.
items: (I + 1, 3) first pair, stroke, tile.  tiles: (T + 1,) first item of each.
records: (P, 13 + C) gradients of a pair's segment and, in the first pair of an item, of the stroke's numbers, of the
x and y of its first and its last point while those bound the mark, and of its colour.
"""

import triton
import triton.language as tl

from maulstick.rendering.kernels.gpu_average import mean_darkness
from maulstick.rendering.kernels.gpu_nearest import foot, nearest, rounded_share, second_nearest
from maulstick.rendering.kernels.gpu_tiles import HALF_DIAGONAL, PIXELS, pixels

RECORD = tl.constexpr(13)  # numbers of a record before the colour


@triton.jit
def _part(segments, shapes, pairs, first, x, y, owner, offset_x, offset_y, h, c, q, slant, share, SLOPES: tl.constexpr):
    """Return what one of two parts adds to each pixel, and its slopes by distance, thickness, c and q.

    Then those by x and y of the stroke's first point and of its last. share: of the pixel, whose part this is.
    """
    segment = tl.load(pairs + tl.maximum(owner, first))
    rounded, direction_x, direction_y, by_start, by_end = rounded_share(segments, shapes, segment, x, y)
    mean, by_distance, by_thickness, by_c, by_q, by_rounded = mean_darkness(
        offset_x, offset_y, h, c, q, slant, 1 - share, rounded, SLOPES
    )
    has = (owner >= 0) & (share > 0)
    mean = tl.where(has, share * mean, 0.0)
    by_distance, by_thickness = tl.where(has, share * by_distance, 0.0), tl.where(has, share * by_thickness, 0.0)
    by_c, by_q = tl.where(has, share * by_c, 0.0), tl.where(has, share * by_q, 0.0)
    by_rounded = tl.where(has, share * by_rounded, 0.0)
    start, end = by_rounded * by_start, -by_rounded * by_end
    return (
        mean,
        by_distance,
        by_thickness,
        by_c,
        by_q,
        start * direction_x,
        start * direction_y,
        end * direction_x,
        end * direction_y,
    )


@triton.jit
def _mark(segments, shapes, pairs, first, last, stroke, x, y, SLOPES: tl.constexpr):
    """Return the darkness of a stroke before its opacity, and for both parts their pairs and slopes.

    For the nearest part and then the second one: its pair, its slopes by distance and thickness. Then those of both,
    by c, q, and x and y of the stroke's first point and of its last.
    """
    c, q = tl.load(stroke), tl.load(stroke + 1)
    owner, free, offset_x, offset_y, h = nearest(segments, pairs, first, last, x, y)
    second, second_x, second_y, second_h, share, slant = second_nearest(
        segments, shapes, pairs, first, last, x, y, owner, free, offset_x, offset_y, h
    )
    within = tl.sqrt_rn(offset_x * offset_x + offset_y * offset_y) + HALF_DIAGONAL <= q * h
    within = within & (owner >= 0)
    value, by_distance, by_thickness, by_c, by_q, start_x, start_y, end_x, end_y = _part(
        segments, shapes, pairs, first, x, y, owner, offset_x, offset_y, h, c, q, slant, 1 - share, SLOPES
    )
    second_distance, second_thickness = tl.zeros_like(value), tl.zeros_like(value)
    if tl.max(share, axis=0) > 0:
        more, second_distance, second_thickness, more_c, more_q, more_start_x, more_start_y, more_end_x, more_end_y = (
            _part(
                segments,
                shapes,
                pairs,
                first,
                x,
                y,
                second,
                second_x,
                second_y,
                second_h,
                c,
                q,
                slant,
                share,
                SLOPES,
            )
        )
        value, by_c, by_q = value + more, by_c + more_c, by_q + more_q
        start_x, start_y = start_x + more_start_x, start_y + more_start_y
        end_x, end_y = end_x + more_end_x, end_y + more_end_y
    value = tl.where(within, 1.0, value)
    owner, second = tl.where(within, -1, owner), tl.where(within, -1, second)
    by_c, by_q = tl.where(within, 0.0, by_c), tl.where(within, 0.0, by_q)
    start_x, start_y = tl.where(within, 0.0, start_x), tl.where(within, 0.0, start_y)
    end_x, end_y = tl.where(within, 0.0, end_x), tl.where(within, 0.0, end_y)
    return (
        value,
        owner,
        by_distance,
        by_thickness,
        second,
        second_distance,
        second_thickness,
        by_c,
        by_q,
        start_x,
        start_y,
        end_x,
        end_y,
    )


@triton.jit
def _add_gradients(record, size, slots, segments, pairs, first, last, stroke, x, y, mark, grad):
    """Write the gradients of an item's segments and of its stroke's numbers and ends.

    mark: as from `_mark`.  grad: that of each pixel's darkness.
    """
    value, owner, by_distance, by_thickness, second, second_distance, second_thickness = mark[:7]
    by_c, by_q, start_x, start_y, end_x, end_y = mark[7:]
    numbers = record + tl.load(slots + first) * size + 6
    tl.store(numbers + 2, tl.sum(grad * value))
    grad *= tl.load(stroke + 2)
    tl.store(numbers, tl.sum(grad * by_c))
    tl.store(numbers + 1, tl.sum(grad * by_q))
    tl.store(numbers + 3, tl.sum(grad * start_x))
    tl.store(numbers + 4, tl.sum(grad * start_y))
    tl.store(numbers + 5, tl.sum(grad * end_x))
    tl.store(numbers + 6, tl.sum(grad * end_y))
    for pair in range(first, last):
        free, t, ex, ey, _, wx, wy, inverse, growth = foot(segments, tl.load(pairs + pair), x, y)
        per_distance = tl.where(owner == pair, by_distance, tl.where(second == pair, second_distance, 0.0))
        grad_thickness = tl.where(owner == pair, by_thickness, tl.where(second == pair, second_thickness, 0.0))
        grad_thickness *= grad
        # In the distance to the foot of the perpendicular, the derivative with respect to T is 0 ...
        squared = ex * ex + ey * ey
        apart = (squared > 0) & (per_distance != 0)
        per_distance = tl.where(apart, -grad * per_distance / tl.sqrt_rn(tl.where(apart, squared, 1.0)), 0.0)
        foot_x, foot_y = per_distance * ex, per_distance * ey
        # ... but the thickness depends on T wherever T is not clamped.
        per_t = tl.where(tl.abs(growth) < float("inf"), growth * inverse, 0.0)
        moves = (free > 0) & (free < 1) & (grad_thickness != 0)
        grad_t = tl.where(moves, grad_thickness * per_t, 0.0)
        along_x, along_y = grad_t * (ex - t * wx), grad_t * (ey - t * wy)
        at = record + tl.load(slots + pair) * size
        tl.store(at, tl.sum(foot_x * (1 - t) - grad_t * wx - along_x))
        tl.store(at + 1, tl.sum(foot_y * (1 - t) - grad_t * wy - along_y))
        tl.store(at + 2, tl.sum(grad_thickness * (1 - t)))
        tl.store(at + 3, tl.sum(foot_x * t + along_x))
        tl.store(at + 4, tl.sum(foot_y * t + along_y))
        tl.store(at + 5, tl.sum(grad_thickness * t))


@triton.jit
def _places(item, number, height, width, ALONE: tl.constexpr):
    """Return for each pixel of an item its centre x and y, its index in a tensor of all pixels, and if it lies inside.

    The tensor is (N, H, W) where each stroke is ALONE on its image, else (I, PIXELS).
    """
    x, y, place, inside = pixels(tl.load(item + 2), height, width)
    if ALONE:
        place += tl.load(item + 1).to(tl.int64) * height * width
    else:
        place = number.to(tl.int64) * PIXELS + tl.arange(0, PIXELS)
        inside = place >= 0
    return x, y, place, inside


@triton.jit
def shade(shades, segments, shapes, strokes, pairs, items, item_count, columns, height, width, ALONE: tl.constexpr):
    """Draw one item per program into shades: (N, H, W), which must be 0 before, if ALONE; else (room, PIXELS).

    item_count: (1,); there may be more programs.  columns: of strokes.
    """
    number = tl.program_id(0)
    if number < tl.load(item_count):
        item = items + number * 3
        x, y, place, inside = _places(item, number, height, width, ALONE)
        stroke = strokes + tl.load(item + 1) * columns
        mark = _mark(segments, shapes, pairs, tl.load(item), tl.load(item + 3), stroke, x, y, False)
        tl.store(shades + place, tl.load(stroke + 2) * mark[0], mask=inside)


@triton.jit
def shade_backward(
    grad_shades,
    records,
    slots,
    segments,
    shapes,
    strokes,
    pairs,
    items,
    item_count,
    columns,
    height,
    width,
    ALONE: tl.constexpr,
):
    """Write the gradients of one item per program into records, but for the colour's.

    grad_shades: as shades.  item_count, columns: as for `shade`.
    """
    number = tl.program_id(0)
    if number < tl.load(item_count):
        item = items + number * 3
        first, last = tl.load(item), tl.load(item + 3)
        stroke = strokes + tl.load(item + 1) * columns
        if tl.load(stroke + 3) != 0:
            x, y, place, inside = _places(item, number, height, width, ALONE)
            mark = _mark(segments, shapes, pairs, first, last, stroke, x, y, True)
            grad = tl.load(grad_shades + place, mask=inside, other=0.0)
            size = RECORD + columns - 4
            _add_gradients(records, size, slots, segments, pairs, first, last, stroke, x, y, mark, grad)


@triton.jit
def blend(canvas, out, shades, strokes, items, tiles, channels, height, width, CHANNELS: tl.constexpr):
    """Paint one tile per program. canvas, out: (C, H, W).  CHANNELS: C rounded up to a power of two."""
    _, _, place, inside = pixels(tl.program_id(0), height, width)
    channel = tl.arange(0, CHANNELS)
    known = channel < channels
    place = (channel.to(tl.int64) * height * width)[:, None] + place[None, :]
    inside = known[:, None] & inside[None, :]
    beneath = tl.load(canvas + place, mask=inside, other=0.0)
    begin, end = tl.load(tiles + tl.program_id(0)), tl.load(tiles + tl.program_id(0) + 1)
    pixel = begin.to(tl.int64) * PIXELS + tl.arange(0, PIXELS)
    for number in range(begin, end):
        stroke = strokes + tl.load(items + number * 3 + 1) * (4 + channels)
        value = tl.load(shades + pixel + (number - begin) * PIXELS)
        colour = tl.load(stroke + 4 + channel, mask=known, other=0.0)
        beneath += value[None, :] * (colour[:, None] - beneath)
    tl.store(out + place, beneath, mask=inside)


@triton.jit
def blend_backward(
    canvas,
    grad_out,
    grad_canvas,
    shades,
    above,
    grad_shades,
    records,
    slots,
    strokes,
    items,
    tiles,
    channels,
    height,
    width,
    CHANNELS: tl.constexpr,
):
    """Write the gradients of one tile per program into grad_canvas, grad_shades and, of colours, into records.

    canvas, grad_out, grad_canvas: (C, H, W).  shades, grad_shades: (I, PIXELS).  above: (I, PIXELS), scratch.

    The gradient of an item's darkness is sum(grad_out * above * (colour - beneath)): `above` is the share that later
    strokes let through, found from the last item to the first; `beneath` is what earlier strokes painted, found from
    the first to the last.
    """
    _, _, place, inside = pixels(tl.program_id(0), height, width)
    channel = tl.arange(0, CHANNELS)
    known = channel < channels
    place = (channel.to(tl.int64) * height * width)[:, None] + place[None, :]
    inside = known[:, None] & inside[None, :]
    begin, end = tl.load(tiles + tl.program_id(0)), tl.load(tiles + tl.program_id(0) + 1)
    pixel = begin.to(tl.int64) * PIXELS + tl.arange(0, PIXELS)

    through = tl.full([PIXELS], 1.0, tl.float32)
    for step in range(end - begin):
        at = pixel + (end - 1 - step - begin) * PIXELS
        tl.store(above + at, through)
        through *= 1 - tl.load(shades + at)
    grad = tl.load(grad_out + place, mask=inside, other=0.0)
    tl.store(grad_canvas + place, grad * through[None, :], mask=inside)
    tl.debug_barrier()  # other threads read `above` than wrote it

    beneath = tl.load(canvas + place, mask=inside, other=0.0)
    for number in range(begin, end):
        item = items + number * 3
        stroke = strokes + tl.load(item + 1) * (4 + channels)
        at = pixel + (number - begin) * PIXELS
        value = tl.load(shades + at)
        change = tl.load(stroke + 4 + channel, mask=known, other=0.0)[:, None] - beneath
        if tl.load(stroke + 3) != 0:
            here = grad * tl.load(above + at)[None, :]
            colour = records + tl.load(slots + tl.load(item)) * (RECORD + channels) + RECORD + channel
            tl.store(colour, tl.sum(here * value[None, :], axis=1), mask=known)
            tl.store(grad_shades + at, tl.sum(here * change, axis=0))
        beneath += value[None, :] * change
