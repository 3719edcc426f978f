"""Fast renderer on the CPU: the signatures, values and gradients of `reference`, in float32."""

from typing import Any

import torch
from torch import Tensor
from torch.autograd.function import once_differentiable

from maulstick.rendering.kernels import _cpu
from maulstick.rendering.kernels.arguments import (
    check_canvas,
    check_colours,
    check_shapes,
    check_size,
    check_strokes,
    plain,
)

INSTRUCTION_SETS: tuple[str, ...] = tuple(_cpu.instruction_sets())
"""Instruction sets that this processor can run, the fastest first."""

THREADS = torch.get_num_threads()
"""Default number of threads: as many as torch uses at its start."""

TRACES = 512
"""Most memory, in MiB, for what strokes leave behind for the way back; what finds no room there is painted again."""


def darkness(
    points: Tensor,
    thickness: Tensor,
    falloff: Tensor,
    plateau: Tensor,
    opacity: Tensor,
    *,
    height: int,
    width: int,
    instructions: str = INSTRUCTION_SETS[0],
    threads: int = THREADS,
) -> Tensor:
    """Draw each stroke alone on an image of its own, as `reference.darkness` does; float32."""
    points, thickness, falloff, plateau, opacity = plain(points, thickness, falloff, plateau, opacity)
    _check_strokes(points, thickness, falloff, plateau, opacity)
    check_size(height, width)
    result: Tensor = _Darkness.apply(
        points, thickness, *_one_each(points, falloff, plateau, opacity), height, width, instructions, threads
    )
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
    instructions: str = INSTRUCTION_SETS[0],
    threads: int = THREADS,
) -> Tensor:
    """Paint all strokes onto one canvas in order, as `reference.composite` does; float32."""
    canvas, points, thickness, colours, falloff, plateau, opacity = plain(
        canvas, points, thickness, colours, falloff, plateau, opacity
    )
    _check_strokes(points, thickness, falloff, plateau, opacity)
    check_canvas(canvas, points, colours, trainable)
    check_colours(colours)
    if trainable is None:
        trainable = torch.ones(points.shape[0], dtype=torch.bool)
    result: Tensor = _Composite.apply(
        canvas,
        points,
        thickness,
        colours,
        *_one_each(points, falloff, plateau, opacity),
        trainable.to(torch.uint8).contiguous(),
        instructions,
        threads,
        torch.is_grad_enabled(),
    )
    return result


def _check_strokes(points: Tensor, thickness: Tensor, falloff: Tensor, plateau: Tensor, opacity: Tensor) -> None:
    """Check as `check_strokes` does, which is asked only where not all is as it should be at a glance."""
    check_shapes(points, thickness, falloff=falloff, plateau=plateau, opacity=opacity)
    strokes = points, thickness, falloff, plateau, opacity
    if not _cpu.drawable(*_bare(*strokes)):
        check_strokes(*strokes)


def _one_each(points: Tensor, *numbers: Tensor) -> list[Tensor]:
    return [x.expand(points.shape[0]).contiguous() for x in numbers]


def _bare(*tensors: Tensor) -> tuple[Any, ...]:
    """Return the tensors as arrays over the same memory, which the native module accepts."""
    return tuple(x.detach().numpy() for x in tensors)


def _split(gradients: Tensor, points: int, channels: int) -> tuple[Tensor, ...]:
    """Split the native module's records into gradients of points, thickness, colours, falloff, plateau, opacity."""
    count = gradients.shape[0]
    at_points = gradients[:, : 3 * points].reshape(count, points, 3)
    colours, numbers = gradients[:, 3 * points :].split([channels, 3], dim=1)
    return at_points[..., :2], at_points[..., 2], colours, *numbers.unbind(1)


class _Darkness(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, *args: Any) -> Tensor:
        *tensors, height, width, instructions, threads = args
        ctx.save_for_backward(*tensors)
        ctx.how = instructions, threads
        out: Tensor = tensors[0].new_empty(tensors[0].shape[0], height, width)
        _cpu.darkness(instructions, threads, *_bare(*tensors, out))
        return out

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad_out: Tensor) -> tuple[Tensor | None, ...]:
        tensors = ctx.saved_tensors
        count, points = tensors[1].shape
        gradients = tensors[0].new_empty(count, 3 * points + 3)
        _cpu.darkness_backward(*ctx.how, *_bare(*tensors, grad_out.contiguous(), gradients))
        xy, thickness, _, *numbers = _split(gradients, points, 0)
        return xy, thickness, *numbers, None, None, None, None


class _Composite(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, *args: Any) -> Tensor:
        *tensors, trainable, instructions, threads, with_gradients = args
        out = torch.empty_like(tensors[0])
        if with_gradients and any(ctx.needs_input_grad):
            ctx.save_for_backward(*tensors, trainable)
            ctx.how = instructions, threads
            ctx.shapes = any(ctx.needs_input_grad[4:6])  # of falloff and plateau, which few ask for
            ctx.traces = _cpu.composite_traced(*ctx.how, TRACES, *_bare(*tensors, trainable), ctx.shapes, *_bare(out))
        else:
            _cpu.composite(instructions, threads, *_bare(*tensors, out))
        return out

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad_out: Tensor) -> tuple[Tensor | None, ...]:
        canvas, xy, thickness, *rest = ctx.saved_tensors
        (count, points), channels = thickness.shape, canvas.shape[0]
        wanted = ctx.needs_input_grad[0]
        grad_canvas = canvas.new_empty(canvas.shape if wanted else (0, 0, 0))
        gradients = canvas.new_empty(count, 3 * points + channels + 3)
        _cpu.composite_backward(
            *ctx.how,
            *_bare(canvas, xy, *rest),
            ctx.shapes,
            ctx.traces,
            *_bare(grad_out.contiguous(), grad_canvas, gradients),
        )
        return grad_canvas if wanted else None, *_split(gradients, points, channels), None, None, None, None
