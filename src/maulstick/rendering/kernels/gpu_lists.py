"""Lists of the segments that may mark each tile of a canvas, made and used on a GPU (explained in `gpu_programs`)."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Self

import torch
import triton
from torch import Tensor

from maulstick.rendering.kernels import gpu_programs as programs
from maulstick.rendering.kernels import gpu_shapes, gpu_tiles
from maulstick.rendering.kernels.gpu_sums import sum_gradients

_TILE, _LANES, PIXELS = (int(each.value) for each in (gpu_tiles.TILE, gpu_tiles.LANES, gpu_tiles.PIXELS))
_SHAPE, _RECORD = gpu_shapes.SHAPE.value, programs.RECORD.value


@dataclass(frozen=True)
class Sizes:
    """N strokes of n points, of C channels, on canvases of one height and width."""

    strokes: int
    points: int
    channels: int
    height: int
    width: int

    @property
    def segments_each(self) -> int:
        """Number of segments of a stroke; a dot has one, of length 0."""
        return max(self.points - 1, 1)

    @property
    def segments(self) -> int:
        """Number of all segments."""
        return self.strokes * self.segments_each

    @property
    def tiles(self) -> int:
        """Number of tiles of a canvas."""
        return int(triton.cdiv(self.height, _TILE) * triton.cdiv(self.width, _TILE))

    @property
    def columns(self) -> int:
        """How many numbers a stroke has, its colour among them."""
        return 4 + self.channels

    @property
    def record(self) -> int:
        """How many numbers the gradients of a pair have."""
        return int(_RECORD + self.channels)


@dataclass(frozen=True)
class Room:
    """Number of pairs and of items for which lists have room."""

    pairs: int
    items: int

    @classmethod
    def enough(cls, pairs: int, items: int) -> Self:
        """Return room for so many and a quarter more, since strokes move."""
        return cls(*(_programs(count * 5 // 4 + 1) * _LANES for count in (pairs, items)))

    def holds(self, pairs: int, items: int) -> bool:
        """Return whether there is room for so many."""
        return pairs <= self.pairs and items <= self.items

    def suits(self, pairs: int, items: int) -> bool:
        """Return whether there is room for so many, and not for many more."""
        ample = Room.enough(2 * pairs, 2 * items)
        return self.holds(pairs, items) and ample.holds(self.pairs, self.items)


_rooms: dict[Sizes, Room] = {}  # that suited what was drawn last


def room_for(sizes: Sizes) -> Room:
    """Return room for lists of these sizes: a guess at first, and later the same again for as long as it suits."""
    return _rooms.get(sizes) or Room.enough(2 * sizes.segments, 2 * sizes.segments)


@dataclass(frozen=True)
class Lists:
    """Lists of the segments that may mark each tile; pairs and items are explained in `gpu_programs`.

    strokes: (N, 4 + C).  segments: (S, 6).  shapes: (S, SHAPE).  starts: (S + 1,) first slot of each segment.
    pairs: (room,), of which P are used, items: (room + 1, 3), of which I + 1 are, tiles: (T + 1,): sorted by tiles.
    slots: (room,) index of each pair, in that order, in a list sorted by segments.
    found: (3,) number of pairs, the same plus segments that cannot be drawn, number of items.
    """

    sizes: Sizes
    room: Room
    strokes: Tensor
    segments: Tensor
    shapes: Tensor
    starts: Tensor
    slots: Tensor
    pairs: Tensor
    items: Tensor
    tiles: Tensor
    found: Tensor

    @classmethod
    def of(cls, points: Tensor, thickness: Tensor, strokes: Tensor, sizes: Sizes, room: Room) -> Self:
        """Make the lists for points (N, n, 2) and thickness (N, n), pixels, and strokes (N, 4 + C).

        What there is no room for is left out. Nothing is waited for, so that a CUDA graph can hold it.
        """
        total, each, size = sizes.segments, sizes.segments_each, (sizes.height, sizes.width)
        of_segments, of_pairs = _programs(total), _programs(room.pairs)
        segments, shapes = points.new_empty(total, 6), points.new_empty(total, _SHAPE)
        counts = points.new_zeros(total + 2, dtype=torch.int64)  # 0, tiles of each segment, faults
        about = total, each, sizes.points - each, sizes.columns, *size
        launch(gpu_tiles.list_segments, of_segments, points, thickness, strokes, segments, counts[1:], *about)
        launch(gpu_shapes.find_shapes, sizes.strokes, segments, shapes, each, warps=1)
        launch(gpu_shapes.find_tight, of_segments, segments, shapes, total, each)
        sums = counts.cumsum(0)
        starts, some, someone = sums[:-1], max(total, 1), max(sizes.strokes, 1)  # these are divided by
        beyond = sizes.tiles * some
        keys = sums.new_full((room.pairs,), beyond, dtype=torch.int32 if beyond < 2**31 else torch.int64)
        launch(gpu_tiles.list_tiles, of_segments, segments, starts, keys, total, room.pairs, *size)
        keys, slots = keys.sort()
        pairs = keys.new_empty(room.pairs, dtype=torch.int32)
        firsts = pairs.new_empty(room.pairs + 1)
        launch(gpu_tiles.find_items, of_pairs, keys, pairs, firsts, room.pairs, beyond, some, each)
        numbers = firsts.cumsum(0, dtype=torch.int32)
        items, tiles = pairs.new_empty(room.items + 1, 3), pairs.new_empty(sizes.tiles + 1)
        launch(gpu_tiles.list_items, of_pairs, keys, numbers, items, room.pairs, room.items, beyond, someone, each)
        launch(
            gpu_tiles.find_tiles,
            _programs(sizes.tiles + 1),
            keys,
            numbers,
            tiles,
            room.pairs,
            room.items,
            some,
            sizes.tiles,
        )
        found = torch.cat([sums[-2:], numbers[-1:]])
        return cls(sizes, room, strokes, segments, shapes, starts, slots, pairs, items, tiles, found)

    def fit(self, check: Callable[[], None]) -> bool:
        """Return whether there was room for all, and remember for the next lists how much is needed.

        check: raises where a stroke cannot be drawn; it is called where there is one. The GPU is waited for.
        """
        pairs, with_faults, items = self.found.tolist()
        if with_faults > pairs:
            check()
        if self.room.suits(pairs, items):
            _rooms[self.sizes] = self.room
        else:
            _rooms[self.sizes] = Room.enough(pairs, items if pairs <= self.room.pairs else pairs)
        return self.room.holds(pairs, items)

    def shade(self, shades: Tensor, *, alone: bool) -> None:
        """Draw each item into shades: (N, H, W), which are 0, of each stroke `alone`, else (room, PIXELS)."""
        about = self.tiles[-1:], self.sizes.columns, self.sizes.height, self.sizes.width, alone
        lists = self.segments, self.shapes, self.strokes, self.pairs, self.items
        launch(programs.shade, self.room.items, shades, *lists, *about, warps=2)

    def shade_backward(self, grad_shades: Tensor, records: Tensor, *, alone: bool) -> None:
        """Write the gradients of each item into records, but for the colour's."""
        about = self.tiles[-1:], self.sizes.columns, self.sizes.height, self.sizes.width, alone
        lists = self.slots, self.segments, self.shapes, self.strokes, self.pairs, self.items
        launch(programs.shade_backward, self.room.items, grad_shades, records, *lists, *about, warps=2)

    def records(self) -> Tensor:
        """Return zeros (room, 13 + C) for the gradients of each pair."""
        return self.segments.new_zeros(self.room.pairs, self.sizes.record)

    def sums(self, records: Tensor, of_points: Tensor, of_thickness: Tensor, of_strokes: Tensor) -> None:
        """Sum records to gradients of points (N, n, 2), thickness (N, n) and strokes (N, 3 + C): numbers and colour."""
        sizes, of_segments = self.sizes, records.new_empty(self.sizes.segments, self.sizes.record)
        about = sizes.segments_each, sizes.points - sizes.segments_each, sizes.record
        sums, columns = (of_segments, of_points, of_thickness, of_strokes), triton.next_power_of_2(sizes.record)
        launch(sum_gradients, sizes.strokes, records, self.starts, *sums, *about, columns, warps=1)


def side_by_side(count: int, *numbers: Tensor) -> Tensor:
    """Return numbers, (count,), (1,) or (count, k), as the columns of one tensor."""
    return torch.cat([x if x.ndim == 2 else x.expand(count)[:, None] for x in numbers], dim=1)


def _programs(count: int) -> int:
    """Return how many programs prepare so many segments, pairs or tiles."""
    return (count + _LANES - 1) // _LANES


def launch(program: Any, count: int, *args: Tensor | int, warps: int = 4) -> None:
    """Run so many programs; warps: of 32 threads each that share the work of one."""
    # Fusion is asked for, because Triton warns that its default will change.
    program[(count,)](*args, enable_fp_fusion=True, num_warps=warps)
