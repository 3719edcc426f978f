"""Fast renderer on a GPU, in Triton: the signatures, values and gradients of `reference`, in float32.

Segments are listed by the tiles that they may mark, so that time and memory grow with the number of touched tiles.
Every number is written by one program and summed in one order: the same strokes give the same bits.
"""

from dataclasses import dataclass
from typing import Any, Self

import torch
import triton
from torch import Tensor
from torch.autograd.function import once_differentiable
from torch.nn.functional import pad

from maulstick.rendering.kernels import gpu_programs as programs
from maulstick.rendering.kernels import gpu_shapes, gpu_tiles
from maulstick.rendering.kernels.arguments import check_canvas, check_size, check_strokes, plain

_TILE, _PIXELS, _LANES = gpu_tiles.TILE.value, gpu_tiles.PIXELS.value, gpu_tiles.LANES.value  # as plain integers
_SHAPE, _RECORD = gpu_shapes.SHAPE.value, programs.RECORD.value


def darkness(
    points: Tensor, thickness: Tensor, falloff: Tensor, plateau: Tensor, opacity: Tensor, *, height: int, width: int
) -> Tensor:
    """Draw each stroke alone on an image of its own, as `reference.darkness` does; float32."""
    points, thickness, falloff, plateau, opacity = plain(points, thickness, falloff, plateau, opacity)
    check_strokes(points, thickness, falloff, plateau, opacity)
    check_size(height, width)
    with torch.cuda.device_of(points):
        result: Tensor = _Darkness.apply(points, thickness, _numbers(points, falloff, plateau, opacity), height, width)
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
    check_strokes(points, thickness, falloff, plateau, opacity)
    check_canvas(canvas, points, colours, trainable)
    if trainable is None:
        trainable = torch.ones(points.shape[0], dtype=torch.bool, device=points.device)
    strokes = torch.cat([_numbers(points, falloff, plateau, opacity), colours], dim=1)
    with torch.cuda.device_of(points):
        result: Tensor = _Composite.apply(canvas, points, thickness, strokes, trainable.to(torch.uint8).contiguous())
    return result


def _numbers(points: Tensor, *numbers: Tensor) -> Tensor:
    return torch.stack([x.expand(points.shape[0]) for x in numbers], dim=1)


@dataclass(frozen=True)
class _Lists:
    """Lists of the segments that may mark each tile; pairs and items are explained in `programs`.

    segments: (S, 6).  shapes: (S, SHAPE).  starts: (S + 1,) first slot of each segment.  pairs: (P,),
    items: (I + 1, 3), tiles: (T + 1,): sorted by tiles.  slots: (P,) index of each pair, in that order, in a list
    sorted by segments.
    """

    segments: Tensor
    shapes: Tensor
    starts: Tensor
    slots: Tensor
    pairs: Tensor
    items: Tensor
    tiles: Tensor

    @classmethod
    def of(cls, points: Tensor, thickness: Tensor, height: int, width: int) -> Self:
        """Make the lists for strokes, points (N, n, 2) and thickness (N, n), pixels, on canvases of one size."""
        count, each = points.shape[0], _segments_each(points.shape[1])
        ends = torch.cat([points, thickness[..., None]], dim=2)
        segments = torch.cat([ends[:, :each], ends[:, -each:]], dim=2).reshape(-1, 6)  # of length 0 for a dot
        total = count * each
        shapes = segments.new_zeros(total, _SHAPE)
        _launch(gpu_shapes.find_shapes, triton.cdiv(count, _LANES), segments, shapes, count, each)
        _launch(gpu_shapes.find_tight, triton.cdiv(total, _LANES), segments, shapes, total, each)
        counts = segments.new_zeros(total + 1, dtype=torch.int64)
        _launch(gpu_tiles.count_tiles, triton.cdiv(total, _LANES), segments, counts[1:], total, height, width)
        starts = counts.cumsum(0)
        keys = starts.new_empty(int(starts[-1]))
        _launch(gpu_tiles.list_tiles, triton.cdiv(total, _LANES), segments, starts, keys, total, height, width)
        keys, slots = keys.sort()
        stroke_in_tile, lengths = torch.unique_consecutive(keys // each, return_counts=True)
        tile, stroke = stroke_in_tile // max(count, 1), stroke_in_tile % max(count, 1)  # without strokes both are empty
        items = torch.stack([pad(lengths.cumsum(0), (1, 0)), pad(stroke, (0, 1)), pad(tile, (0, 1))], dim=1)
        every_tile = torch.arange(_tiles(height, width) + 1, device=points.device)
        tiles = torch.searchsorted(tile, every_tile, out_int32=True)
        return cls(segments, shapes, starts, slots, (keys % max(total, 1)).int(), items.int(), tiles)

    @property
    def item_count(self) -> int:
        """Number of items: of strokes that may mark a tile, summed over tiles."""
        return self.items.shape[0] - 1

    def records(self, size: int) -> Tensor:
        """Return a tensor of zeros (P, size) for the gradients of each pair."""
        return self.segments.new_zeros(self.pairs.shape[0], size)

    def sums(self, records: Tensor, count: int, points: int) -> tuple[Tensor, Tensor, Tensor]:
        """Sum records (P, 13 + C) to gradients of points (N, n, 2), thickness (N, n) and strokes (N, 3 + C)."""
        each = _segments_each(points)
        of_segments = torch.segment_reduce(records, "sum", offsets=self.starts, axis=0, initial=0)
        of_segments = of_segments.reshape(count, each, records.shape[1])
        starts, ends, rest = of_segments[..., :3], of_segments[..., 3:6], of_segments[..., 6:]
        of_points = pad(starts, (0, 0, 0, points - each)) + pad(ends, (0, 0, points - each, 0))
        rest = rest.sum(1)
        of_points[:, 0, :2] += rest[:, 3:5]
        of_points[:, -1, :2] += rest[:, 5:7]
        return of_points[..., :2], of_points[..., 2], torch.cat([rest[:, :3], rest[:, 7:]], dim=1)


def _launch(program: Any, count: int, *args: Tensor | int) -> None:
    program[(count,)](*args, enable_fp_fusion=True)  # explicit, because Triton warns that its default will change


def _segments_each(points: int) -> int:
    return max(points - 1, 1)


def _tiles(height: int, width: int) -> int:
    return int(triton.cdiv(height, _TILE) * triton.cdiv(width, _TILE))


class _Darkness(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, *args: Any) -> Tensor:
        points, thickness, strokes, height, width = args
        lists = _Lists.of(points, thickness, height, width)
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
        return *lists.sums(records, count, ctx.points), None, None


class _Composite(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, *args: Any) -> Tensor:
        canvas, points, thickness, strokes, trainable = args
        channels, height, width = canvas.shape
        lists = _Lists.of(points, thickness, height, width)
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
        return grad_canvas, *lists.sums(records, strokes.shape[0], ctx.points), None
