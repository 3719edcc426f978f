"""Gradients of strokes as sums over their segments, in Triton's language; records are explained in `gpu_programs`."""

import triton
import triton.language as tl

from maulstick.rendering.kernels.gpu_programs import RECORD
from maulstick.rendering.kernels.gpu_tiles import SPAN


@triton.jit
def _of(sums, column, wanted):
    return tl.sum(tl.where(column == wanted, sums, 0.0))


@triton.jit
def sum_gradients(
    records, starts, of_segments, of_points, of_thickness, of_strokes, each, after, columns, COLUMNS: tl.constexpr
):
    """Write the gradients of points (N, n, 2), thickness (N, n) and strokes (N, 3 + C), one stroke per program.

    records: (P, 13 + C), of segment after segment.  starts: (S + 1,), first of each.  of_segments: (S, 13 + C), room.
    each: segments of a stroke.  after: 1, or 0 for a dot, whose segment starts and ends in its one point.
    columns: 13 + C.  COLUMNS: these rounded up to a power of two.
    """
    stroke = tl.program_id(0)
    first, points = stroke * each, each + after
    column = tl.arange(0, COLUMNS)
    sums = tl.zeros([COLUMNS], tl.float32)
    for begin in range(0, each, SPAN):
        segment = first + begin + tl.arange(0, SPAN)
        known = segment < first + each
        at, last = tl.load(starts + segment, mask=known, other=0), tl.load(starts + segment + 1, mask=known, other=0)
        total = tl.zeros([SPAN, COLUMNS], tl.float32)
        for _ in range(tl.max(last - at)):
            inside = (at < last)[:, None] & (column < columns)[None, :]
            total += tl.load(records + at[:, None] * columns + column[None, :], mask=inside, other=0.0)
            at += 1
        inside = known[:, None] & (column < columns)[None, :]
        tl.store(of_segments + segment[:, None] * columns + column[None, :], total, mask=inside)
        sums += tl.sum(total, axis=0)
    of_strokes += stroke * (3 + columns - RECORD)
    tl.store(of_strokes + column - 6, sums, mask=(column >= 6) & (column < 9))
    tl.store(of_strokes + 3 + column - RECORD, sums, mask=(column >= RECORD) & (column < columns))
    tl.debug_barrier()  # other threads read `of_segments` than wrote it
    for begin in range(0, points, SPAN):
        k = begin + tl.arange(0, SPAN)
        starting, ending = of_segments + (first + k) * columns, of_segments + (first + k - after) * columns
        for axis in tl.static_range(3):
            total = tl.load(starting + axis, mask=k < each, other=0.0)
            total += tl.load(ending + 3 + axis, mask=(k >= after) & (k < points), other=0.0)
            if axis < 2:
                total += tl.where(k == 0, _of(sums, column, 9 + axis), 0.0)
                total += tl.where(k == points - 1, _of(sums, column, 11 + axis), 0.0)
                tl.store(of_points + (stroke * points + k) * 2 + axis, total, mask=k < points)
            else:
                tl.store(of_thickness + stroke * points + k, total, mask=k < points)
