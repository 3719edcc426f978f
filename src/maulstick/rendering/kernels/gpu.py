"""Fast renderer on a GPU, in Triton: the signatures, values and gradients of `reference`, in float32.

Segments are listed by the tiles that they may mark, so that time and memory grow with the number of touched tiles.
Every number is written by one program and summed in one order: the same strokes give the same bits.
"""

from collections.abc import Sequence
from functools import partial
from typing import Any

import torch
from torch import Tensor
from torch.autograd.function import once_differentiable

from maulstick.rendering.kernels.arguments import (
    check_canvas,
    check_colours,
    check_shapes,
    check_size,
    check_strokes,
    plain,
)
from maulstick.rendering.kernels.gpu_canvas import Canvas
from maulstick.rendering.kernels.gpu_lists import Lists, Sizes, room_for, side_by_side


def darkness(
    points: Tensor, thickness: Tensor, falloff: Tensor, plateau: Tensor, opacity: Tensor, *, height: int, width: int
) -> Tensor:
    """Draw each stroke alone on an image of its own, as `reference.darkness` does; float32."""
    points, thickness, falloff, plateau, opacity = plain(points, thickness, falloff, plateau, opacity)
    check_shapes(points, thickness, falloff=falloff, plateau=plateau, opacity=opacity)
    check_size(height, width)
    check = partial(check_strokes, points, thickness, falloff, plateau, opacity)
    with torch.cuda.device_of(points):
        result: Tensor = _Darkness.apply(points, thickness, falloff, plateau, opacity, height, width, check)
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

    given = canvas, points, thickness, colours, falloff, plateau, opacity
    with torch.cuda.device_of(points):
        result: Tensor = _Composite.apply(*given, trainable, check)
    return result


def _as_given(gradients: Tensor, numbers: Sequence[Tensor], needed: Sequence[bool]) -> list[Tensor | None]:
    """Return the gradients (N, 3 + C) of numbers, (N,) or (1,), in their shapes; None where none is needed."""

    def of(column: int, number: Tensor) -> Tensor:
        gradient = gradients[:, column]
        return gradient if number.shape == gradient.shape else gradient.sum(0, keepdim=True)

    return [of(i, x) if need else None for i, (x, need) in enumerate(zip(numbers, needed, strict=True))]


class _Darkness(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, *args: Any) -> Tensor:
        points, thickness, falloff, plateau, opacity, height, width, check = args
        sizes = Sizes(points.shape[0], points.shape[1], 0, height, width)
        strokes = side_by_side(points.shape[0], falloff, plateau, opacity, points.new_ones(1))
        lists = Lists.of(points, thickness, strokes, sizes, room_for(sizes))
        while not lists.fit(check):
            lists = Lists.of(points, thickness, strokes, sizes, room_for(sizes))
        images: Tensor = points.new_zeros(points.shape[0], height, width)
        lists.shade(images, alone=True)
        ctx.save_for_backward(points, thickness, falloff, plateau, opacity)
        ctx.lists = lists
        return images

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad_images: Tensor) -> tuple[Tensor | None, ...]:
        points, thickness, *numbers = ctx.saved_tensors
        of_points, of_thickness = torch.empty_like(points), torch.empty_like(thickness)
        of_strokes, records = points.new_empty(points.shape[0], 3), ctx.lists.records()
        ctx.lists.shade_backward(grad_images.contiguous(), records, alone=True)
        ctx.lists.sums(records, of_points, of_thickness, of_strokes)
        return of_points, of_thickness, *_as_given(of_strokes, numbers, ctx.needs_input_grad[2:5]), None, None, None


class _Composite(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, *args: Any) -> Tensor:
        *given, trainable, check = args
        painting = Canvas.of(given)
        result = painting.paint(given, trainable, check)
        ctx.save_for_backward(*given, trainable)
        ctx.painting, ctx.painted = painting, painting.painted
        return result

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad_out: Tensor) -> tuple[Tensor | None, ...]:
        *given, trainable = ctx.saved_tensors
        painting: Canvas = ctx.painting
        if painting.painted != ctx.painted:  # on the same tensors something else was painted since
            painting.paint(given, trainable, lambda: None)
        of_canvas, of_points, of_thickness, of_strokes = painting.gradients(grad_out)
        of_numbers = _as_given(of_strokes, given[4:7], ctx.needs_input_grad[4:7])
        return of_canvas, of_points, of_thickness, of_strokes[:, 3:], *of_numbers, None, None
