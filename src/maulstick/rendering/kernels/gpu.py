"""Fast renderer on a GPU, in Triton: the signatures, values and gradients of `reference`, in float32.

Segments are listed by the tiles that they may mark, so that time and memory grow with the number of touched tiles.
Every number is written by one program and summed in one order: the same strokes give the same bits.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, Self

import torch
import triton
from torch import Tensor
from torch.autograd.function import once_differentiable

from maulstick.rendering.kernels import gpu_programs as programs
from maulstick.rendering.kernels import gpu_shapes, gpu_tiles
from maulstick.rendering.kernels.arguments import (
    check_canvas,
    check_colours,
    check_shapes,
    check_size,
    check_strokes,
    plain,
)
from maulstick.rendering.kernels.gpu_sums import sum_gradients

_TILE, _PIXELS, _LANES = gpu_tiles.TILE.value, gpu_tiles.PIXELS.value, gpu_tiles.LANES.value  # as plain integers
_SHAPE, _RECORD = gpu_shapes.SHAPE.value, programs.RECORD.value


def darkness(
    points: Tensor, thickness: Tensor, falloff: Tensor, plateau: Tensor, opacity: Tensor, *, height: int, width: int
) -> Tensor:
    """Draw each stroke alone on an image of its own, as `reference.darkness` does; float32."""
    points, thickness, falloff, plateau, opacity = plain(points, thickness, falloff, plateau, opacity)
    check_shapes(points, thickness, falloff=falloff, plateau=plateau, opacity=opacity)
    check_size(height, width)
    check = partial(check_strokes, points, thickness, falloff, plateau, opacity)
    with torch.cuda.device_of(points):
        strokes = _numbers(points, falloff, plateau, opacity)
        result: Tensor = _Darkness.apply(points, thickness, strokes, height, width, check)
    return result


def composite(
    canvas: Tensor,
    points: Tensor,
    thickness: Tensor,
    colours: Tensor,
    falloff: Tensor,
    plateau: Tensor,
    opacity: Tensor,
    *,
    trainable: Tensor | None = None,
) -> Tensor:
    """Paint all strokes onto one canvas in order, as `reference.composite` does; float32."""
    canvas, points, thickness, colours, falloff, plateau, opacity = plain(
        canvas, points, thickness, colours, falloff, plateau, opacity
    )
    check_shapes(points, thickness, falloff=falloff, plateau=plateau, opacity=opacity)
    check_canvas(canvas, points, colours, trainable)

    def check() -> None:
        check_strokes(points, thickness, falloff, plateau, opacity)
        check_colours(colours)

    if trainable is None:
        trainable = torch.ones(points.shape[0], dtype=torch.bool, device=points.device)
    strokes = torch.cat([_numbers(points, falloff, plateau, opacity), colours], dim=1)
    with torch.cuda.device_of(points):
        mask = trainable.to(torch.uint8).contiguous()
        result: Tensor = _Composite.apply(canvas, points, thickness, strokes, mask, check)
    return result


def _numbers(points: Tensor, *numbers: Tensor) -> Tensor:
    return torch.stack([x.expand(points.shape[0]) for x in numbers], dim=1)


@dataclass(frozen=True)
class _Lists:
    """Lists of the segments that may mark each tile; pairs and items are explained in `programs`.

    segments: (S, 6).  shapes: (S, SHAPE).  starts: (S + 1,) first slot of each segment.  pairs: (P,),
    items: (P + 1, 3), of which I + 1 are used, tiles: (T + 1,): sorted by tiles.  slots: (P,) index of each pair, in
    that order, in a list sorted by segments.  numbers: (P + 1,) of items that begin before each pair.
    """

    segments: Tensor
    shapes: Tensor
    starts: Tensor
    slots: Tensor
    pairs: Tensor
    items: Tensor
    tiles: Tensor
    numbers: Tensor

    @classmethod
    def of(
        cls,
        points: Tensor,
        thickness: Tensor,
        strokes: Tensor,
        height: int,
        width: int,
        check: Callable[[], None],
    ) -> Self:
        """Make the lists for strokes, points (N, n, 2) and thickness (N, n), pixels, on canvases of one size.

        check: raises where a stroke cannot be drawn; it is called where there is one. The number of such strokes comes
        with that of pairs, the one number that is waited for: until the CPU has it, the GPU stands still.
        """
        count, each = points.shape[0], _segments_each(points.shape[1])
        ends = torch.cat([points, thickness[..., None]], dim=2)
        segments = torch.cat([ends[:, :each], ends[:, -each:]], dim=2).reshape(-1, 6)  # of length 0 for a dot
        total = count * each
        of_strokes, of_segments = triton.cdiv(count, _LANES), triton.cdiv(total, _LANES)
        counts = segments.new_zeros(total + 2, dtype=torch.int64)  # 0, tiles of each segment, faults
        _launch(gpu_tiles.count_tiles, of_segments, segments, counts[1:], total, height, width)
        _launch(gpu_tiles.count_faults, of_strokes, segments, strokes, counts[-1:], count, each, strokes.shape[1])
        sums = counts.cumsum(0)
        pair_count, with_faults = sums[-2:].tolist()
        if with_faults > pair_count:
            check()
        shapes = segments.new_empty(total, _SHAPE)
        _launch(gpu_shapes.find_shapes, of_strokes, segments, shapes, count, each)
        _launch(gpu_shapes.find_tight, of_segments, segments, shapes, total, each)
        starts, keys = sums[:-1], sums.new_empty(pair_count)
        _launch(gpu_tiles.list_tiles, of_segments, segments, starts, keys, total, height, width)
        keys, slots = keys.sort()
        of_pairs = triton.cdiv(pair_count, _LANES)
        pairs, firsts = keys.new_empty(pair_count, dtype=torch.int32), keys.new_zeros(pair_count + 1)
        _launch(gpu_tiles.find_items, of_pairs, keys, pairs, firsts, pair_count, total, each)
        numbers = firsts.cumsum(0)
        items = pairs.new_zeros(pair_count + 1, 3)
        _launch(gpu_tiles.list_items, of_pairs, keys, numbers, items, pair_count, count, each)
        bounds = torch.arange(_tiles(height, width) + 1, device=points.device) * total  # of the keys of each tile
        tiles = numbers[torch.searchsorted(keys, bounds)].int()
        return cls(segments, shapes, starts, slots, pairs, items, tiles, numbers)

    @cached_property
    def item_count(self) -> int:
        """Number of items: of strokes that may mark a tile, summed over tiles. It is waited for."""
        return int(self.numbers[-1])

    def records(self, size: int) -> Tensor:
        """Return a tensor of zeros (P, size) for the gradients of each pair."""
        return self.segments.new_zeros(self.pairs.shape[0], size)

    def sums(self, records: Tensor, count: int, points: int) -> tuple[Tensor, Tensor, Tensor]:
        """Sum records (P, 13 + C) to gradients of points (N, n, 2), thickness (N, n) and strokes (N, 3 + C)."""
        each, columns = _segments_each(points), records.shape[1]
        of_segments = torch.segment_reduce(records, "sum", offsets=self.starts, axis=0, initial=0)
        of_points, of_thickness = records.new_empty(count, points, 2), records.new_empty(count, points)
        of_strokes = records.new_empty(count, 3 + columns - _RECORD)
        sums = of_points, of_thickness, of_strokes
        sizes = count, each, points - each, columns
        _launch(sum_gradients, triton.cdiv(count, _LANES), of_segments, *sums, *sizes)
        return sums


def _launch(program: Any, count: int, *args: Tensor | int) -> None:
    program[(count,)](*args, enable_fp_fusion=True)  # explicit, because Triton warns that its default will change


def _segments_each(points: int) -> int:
    return max(points - 1, 1)


def _tiles(height: int, width: int) -> int:
    return int(triton.cdiv(height, _TILE) * triton.cdiv(width, _TILE))


class _Darkness(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, *args: Any) -> Tensor:
        points, thickness, strokes, height, width, check = args
        lists = _Lists.of(points, thickness, strokes, height, width, check)
        images: Tensor = points.new_zeros(points.shape[0], height, width)
        _launch(
            programs.darkness,
            lists.item_count,
            images,
            lists.segments,
            lists.shapes,
            strokes,
            lists.pairs,
            lists.items,
            height,
            width,
        )
        ctx.save_for_backward(strokes)
        ctx.lists, ctx.points = lists, points.shape[1]
        return images

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad_images: Tensor) -> tuple[Tensor | None, ...]:
        (strokes,), lists = ctx.saved_tensors, ctx.lists
        count, height, width = grad_images.shape
        records = lists.records(_RECORD)
        _launch(
            programs.darkness_backward,
            lists.item_count,
            grad_images.contiguous(),
            records,
            lists.slots,
            lists.segments,
            lists.shapes,
            strokes,
            lists.pairs,
            lists.items,
            height,
            width,
        )
        return *lists.sums(records, count, ctx.points), None, None, None


class _Composite(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, *args: Any) -> Tensor:
        canvas, points, thickness, strokes, trainable, check = args
        channels, height, width = canvas.shape
        lists = _Lists.of(points, thickness, strokes, height, width, check)
        out = torch.empty_like(canvas)
        _launch(
            programs.composite,
            _tiles(height, width),
            canvas,
            out,
            lists.segments,
            lists.shapes,
            strokes,
            lists.pairs,
            lists.items,
            lists.tiles,
            channels,
            height,
            width,
            triton.next_power_of_2(channels),
        )
        ctx.save_for_backward(canvas, strokes, trainable)
        ctx.lists, ctx.points = lists, points.shape[1]
        return out

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad_out: Tensor) -> tuple[Tensor | None, ...]:
        (canvas, strokes, trainable), lists = ctx.saved_tensors, ctx.lists
        channels, height, width = canvas.shape
        grad_canvas, records = torch.empty_like(canvas), lists.records(_RECORD + channels)
        _launch(
            programs.composite_backward,
            _tiles(height, width),
            canvas,
            grad_out.contiguous(),
            grad_canvas,
            canvas.new_empty(lists.item_count, _PIXELS),
            records,
            trainable,
            lists.slots,
            lists.segments,
            lists.shapes,
            strokes,
            lists.pairs,
            lists.items,
            lists.tiles,
            channels,
            height,
            width,
            triton.next_power_of_2(channels),
        )
        return grad_canvas, *lists.sums(records, strokes.shape[0], ctx.points), None, None
