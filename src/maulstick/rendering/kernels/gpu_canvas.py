"""Strokes painted onto a canvas on a GPU, and their gradients, again and again by CUDA graphs."""

import math
import threading
from collections.abc import Callable
from functools import partial
from typing import Self

import torch
import triton
from torch import Tensor

from maulstick.rendering.kernels import gpu_programs as programs
from maulstick.rendering.kernels.gpu_lists import PIXELS, Lists, Room, Sizes, launch, room_for, side_by_side
from maulstick.rendering.kernels.repeated import Repeated

_last = threading.local()  # the canvas of the last call: a plan paints on one of the same sizes in each step


class Canvas:
    """Strokes on a canvas and their gradients, on tensors of its own, which keep what was painted last.

    painted: how often it was painted on.
    """

    def __init__(self, given: list[Tensor]) -> None:
        canvas, points = (x.shape for x in given[:2])
        self.sizes, self.device, self.painted = Sizes(*points[:2], *canvas), given[0].device, 0
        self._given, self._grad_out = [torch.empty_like(x) for x in given], torch.empty_like(given[0])
        self._trainable = torch.empty(points[0], device=self.device)
        self._shapes = canvas, points, points[:2], (points[0], self.sizes.columns - 1)  # of the gradients
        self._gradients = torch.empty(sum(map(math.prod, self._shapes)), device=self.device)
        self._paint, self._return = Repeated(self.device), Repeated(self.device)

    @classmethod
    def of(cls, given: list[Tensor]) -> Self:
        """Return the one of this thread's last call, where that was given tensors as large; else a new one."""
        last = getattr(_last, "canvas", None)
        if last is None or not last._suits(given):
            last = _last.canvas = cls(given)
        return last

    def _suits(self, given: list[Tensor]) -> bool:
        same = all(own.shape == other.shape for own, other in zip(self._given, given, strict=True))
        return same and self.device == given[0].device

    def paint(self, given: list[Tensor], trainable: Tensor | None, check: Callable[[], None]) -> Tensor:
        """Paint strokes onto a canvas (C, H, W).

        given: canvas, points, thickness, colours, falloff, plateau and opacity, as `gpu.composite` takes them.
        trainable: as there.  check: as for `Lists.fit`.
        """
        torch._foreach_copy_(self._given, given)
        if trainable is None:
            self._trainable.fill_(1)
        else:
            self._trainable.copy_(trainable)
        self.painted += 1
        while True:
            room = room_for(self.sizes)
            self._paint(partial(self._forward, room), on=room)
            result = self._out.clone()  # asked for before the GPU is waited for
            if self._lists.fit(check):
                return result

    def gradients(self, grad_out: Tensor) -> list[Tensor]:
        """Return those of canvas, points, thickness and the strokes' numbers (N, 3 + C) for what was painted last."""
        self._grad_out.copy_(grad_out)
        self._return(self._backward, on=self._lists)
        return self._split(self._gradients.clone())

    def _split(self, gradients: Tensor) -> list[Tensor]:
        parts = gradients.split([math.prod(shape) for shape in self._shapes])
        return [part.view(shape) for part, shape in zip(parts, self._shapes, strict=True)]

    @property
    def _about(self) -> tuple[int, int, int, int]:
        sizes = self.sizes
        return sizes.channels, sizes.height, sizes.width, triton.next_power_of_2(sizes.channels)

    def _forward(self, room: Room) -> None:
        canvas, points, thickness, colours, *numbers = self._given
        strokes = side_by_side(self.sizes.strokes, *numbers, self._trainable, colours)
        self._lists = Lists.of(points, thickness, strokes, self.sizes, room)
        self._shades, self._out = points.new_empty(room.items, PIXELS), torch.empty_like(canvas)
        self._lists.shade(self._shades, alone=False)
        lists = self._shades, strokes, self._lists.items, self._lists.tiles
        launch(programs.blend, self.sizes.tiles, canvas, self._out, *lists, *self._about, warps=1)

    def _backward(self) -> None:
        grad_canvas, *of_strokes = self._split(self._gradients)
        records, grad_shades, above = self._lists.records(), *(torch.empty_like(self._shades) for _ in range(2))
        canvases = self._given[0], self._grad_out, grad_canvas
        lists = self._lists.slots, self._lists.strokes, self._lists.items, self._lists.tiles
        scratch = self._shades, above, grad_shades, records
        launch(programs.blend_backward, self.sizes.tiles, *canvases, *scratch, *lists, *self._about, warps=1)
        self._lists.shade_backward(grad_shades, records, alone=False)
        self._lists.sums(records, *of_strokes)
