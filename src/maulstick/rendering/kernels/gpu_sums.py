"""Gradients of strokes as sums over their segments, in Triton's language; records are explained in `gpu_programs`."""

import triton
import triton.language as tl

from maulstick.rendering.kernels.gpu_programs import RECORD
from maulstick.rendering.kernels.gpu_tiles import LANES


@triton.jit
def _sum(of_segments, column, each, columns):
    """Return the sum of a column over the segments of each stroke."""
    total = tl.zeros([LANES], tl.float32)
    for k in range(each):
        total += tl.load(of_segments + k * columns + column)
    return total


@triton.jit
def sum_gradients(of_segments, of_points, of_thickness, of_strokes, count, each, after, columns):
    """Write the gradients of points (N, n, 2), thickness (N, n) and strokes (N, 3 + C).

    of_segments: (S, 13 + C), sums of records.  each: segments of a stroke.  after: 1, or 0 for a dot, whose segment
    starts and ends in its one point.  columns: 13 + C.
    """
    stroke = tl.program_id(0) * LANES + tl.arange(0, LANES)
    known = stroke < count
    stroke = tl.minimum(stroke, count - 1)
    of_segments += stroke * each * columns
    first = stroke * (each + after)
    for axis in tl.static_range(3):
        if axis < 2:
            at, stride = of_points + first * 2 + axis, 2
            ends_before, begin = _sum(of_segments, 9 + axis, each, columns), _sum(of_segments, 11 + axis, each, columns)
        else:
            at, stride = of_thickness + first, 1
            ends_before, begin = tl.zeros([LANES], tl.float32), tl.zeros([LANES], tl.float32)
        own = tl.zeros([LANES], tl.float32)
        for k in range(each):
            own = ends_before + tl.load(of_segments + k * columns + axis)
            tl.store(at + k * stride, own, mask=known)
            ends_before = tl.load(of_segments + k * columns + 3 + axis)
        last = ends_before + begin + tl.where(after > 0, 0.0, own)
        tl.store(at + (each - 1 + after) * stride, last, mask=known)
    of_strokes += stroke * (3 + columns - RECORD)
    for column in range(6, 9):
        tl.store(of_strokes + column - 6, _sum(of_segments, column, each, columns), mask=known)
    for column in range(RECORD, columns):
        tl.store(of_strokes + 3 + column - RECORD, _sum(of_segments, column, each, columns), mask=known)
