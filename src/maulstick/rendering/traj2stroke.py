"""Traj2Stroke (paper; docs/equations.md): from commanded trajectories and a brush's numbers to marks on a canvas."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, Self

import torch
from torch import Tensor
from torch.autograd.function import once_differentiable

from maulstick.painting.brush import CURVE_PRESSURES, Brush
from maulstick.rendering import _laying
from maulstick.rendering.kernels.render import composite

_PIECES = len(CURVE_PRESSURES) + 1  # linear pieces of a brush's curve, equally long
_SHORTEST = 1e-9  # metres: keeps lengths and lags of 0 out of the denominators


@dataclass(frozen=True)
class Marks:
    """Marks that the kernels draw. points: (N, n, 2) pixels; thickness: (N, n) half-widths, pixels.

    falloff, plateau, opacity: (N,), the paper's c, and q and o beyond the paper.
    """

    points: Tensor
    thickness: Tensor
    falloff: Tensor
    plateau: Tensor
    opacity: Tensor

    def evened(self, counts: Tensor) -> Self:
        """Return the same marks where strokes have `counts` (N,) points of their own, and the others repeat the last.

        Those divide the longest step of their stroke evenly instead: a repeated point would draw a dot of its own.
        """
        if (most := self.points.shape[1]) == 1:
            return self
        longest = self.points.diff(dim=1).square().sum(dim=2).argmax(dim=1, keepdim=True)
        missing, places = most - counts[:, None], torch.arange(most)
        within = longest + (places - longest) / (missing + 1)
        place = torch.minimum(places, torch.maximum(within, places - missing))
        before = place.long().clamp(max=most - 2)
        share = place - before

        def at(values: Tensor) -> Tensor:
            return values.gather(1, before).lerp(values.gather(1, before + 1), share)

        x, y = self.points.unbind(-1)
        return replace(self, points=torch.stack([at(x), at(y)], dim=-1), thickness=at(self.thickness))


@dataclass(frozen=True)
class Traj2Stroke:
    """Numbers of one brush per stroke as tensors, metres; `Brush` explains them.

    scale, shift: (N, 2) m and b.  curve: (N, 7).  nib, touch: (N, 2).  The others: (N,).
    """

    scale: Tensor
    shift: Tensor
    curve: Tensor
    nib: Tensor
    touch: Tensor
    alpha: Tensor
    beta: Tensor
    falloff: Tensor
    plateau: Tensor
    opacity: Tensor
    lag: Tensor
    faint: Tensor
    solid: Tensor

    @classmethod
    def of(cls, brushes: Sequence[Brush]) -> Self:
        """Return the numbers of `brushes`, one brush per stroke."""
        rows = [
            (
                *(b.m_x, b.m_y, b.b_x, b.b_y, *b.curve, *b.nib, *b.touch),
                *(b.alpha, b.beta, b.falloff, b.plateau, b.opacity, b.lag, b.faint, b.solid),
            )
            for b in brushes
        ]
        numbers = torch.tensor(rows, dtype=torch.float32).reshape(-1, 16 + len(CURVE_PRESSURES))
        scale, shift, curve, nib, touch, alone = numbers.split([2, 2, len(CURVE_PRESSURES), 2, 2, 8], dim=1)
        return cls(scale, shift, curve, nib, touch, *alone.unbind(1))

    def __getitem__(self, rows: Tensor) -> Self:
        """Return those of some rows (N,), in their order."""
        return type(self)(**{name: tensor[rows] for name, tensor in self._each().items()})

    def _each(self) -> dict[str, Tensor]:
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def at_mean_pressure(self, pressure: Tensor) -> Self:
        """Return the same with the opacity at these mean pressures (N,), whatever the points that are drawn have."""
        return replace(self, opacity=self.opacity * self._flow(pressure), faint=torch.ones_like(self.faint))

    def marks(self, trajectories: Tensor, pixels_per_metre: float) -> Marks:
        """Return the marks of commanded trajectories (N, n, 3) of x, y in metres and pressure in [0, 1]."""
        given = trajectories.device.type, trajectories.dtype, len(trajectories)
        if self._is_simple and given == ("cpu", torch.float32, len(self.alpha)):
            points, thickness, opacity = _Marks.apply(trajectories.contiguous(), self._numbers, pixels_per_metre)
            return Marks(points, thickness, self.falloff, self.plateau, opacity)
        return self.plain_marks(trajectories, pixels_per_metre)

    @cached_property
    def _is_simple(self) -> bool:
        """Whether no tip trails or is broader one way, and no number is sought."""
        trailing = self.lag.any() or self.touch.any() or self.nib.any()
        plain = all(not tensor.requires_grad and tensor.dtype == torch.float32 for tensor in self._each().values())
        return plain and not bool(trailing)

    @cached_property
    def _numbers(self) -> Tensor:
        """What the native module takes of each brush, (N, 18)."""
        alone = torch.stack([self.alpha, self.beta, self.opacity, self.faint, self.solid], dim=1)
        return torch.cat([self.scale, self.shift, self._ends, alone], dim=1)

    def plain_marks(self, trajectories: Tensor, pixels_per_metre: float) -> Marks:
        """Return the same as `marks`, plainly: on any device, in any precision, with slopes of the brush too."""
        start, pressure = trajectories[:, :1, :2], trajectories[..., 2]
        tips = self._dragged(trajectories[..., :2])
        points = start + self.scale[:, None] * (tips - start) + self.shift[:, None]
        half_width = self.alpha[:, None] * self._risen(pressure) + self.beta[:, None]
        return Marks(
            points * pixels_per_metre,
            half_width * self._broad(points) * pixels_per_metre,
            self.falloff,
            self.plateau,
            self.opacity * self._flow(pressure.mean(dim=1)),
        )

    def _flow(self, pressure: Tensor) -> Tensor:
        """Share of the opacity at each mean pressure (N,)."""
        return self.faint + (1 - self.faint) * (pressure / self.solid).clamp(max=1)

    def _risen(self, pressure: Tensor) -> Tensor:
        """Share of alpha at each pressure (N, n), linear within each piece of the curve."""
        ends = self._ends
        piece = (pressure.detach() * _PIECES).long().clamp(0, _PIECES - 1)
        below, above = ends.gather(1, piece), ends.gather(1, piece + 1)
        return below + (above - below) * (pressure * _PIECES - piece)

    @property
    def _ends(self) -> Tensor:
        """Share of alpha at both ends of each piece of the curve, (N, 9)."""
        return torch.nn.functional.pad(torch.nn.functional.pad(self.curve, (1, 0)), (0, 1), value=1.0)

    def _dragged(self, path: Tensor) -> Tensor:
        """Positions of the tip at the commanded points (N, n, 2), as in `Brush.mark`."""
        if not (self.lag.any() or self.touch.any() or self.touch.requires_grad):
            return path
        lag = self.lag[:, None].clamp(min=_SHORTEST)
        steps = path[:, 1:] - path[:, :-1]
        lengths = (steps.square().sum(-1, keepdim=True) + _SHORTEST**2).sqrt()
        lags = lengths / lag[:, None]  # of each step; `expm1` keeps the slope of one that goes hardly anywhere
        fading = torch.nn.functional.pad((-lags).exp(), (0, 0, 1, 0))
        behind = torch.cat([self.touch[:, None], (-lags).expm1() / lags * steps], dim=1)
        reach = 1  # points back that `behind` knows of: each is what is left of the one before, and its own
        while reach < behind.shape[1]:
            left, own = fading[:, reach:], behind[:, reach:]
            behind = torch.cat([behind[:, :reach], own + left * behind[:, :-reach]], dim=1)
            fading = torch.cat([fading[:, :reach], left * fading[:, :-reach]], dim=1)
            reach *= 2
        return path + behind

    def _broad(self, points: Tensor) -> Tensor:
        """Width of the mark relative to its mean at each point, (N, n) or (N, 1), for the direction of travel there."""
        if points.shape[1] < 2 or not (self.nib.any() or self.nib.requires_grad):
            return points.new_ones(points.shape[0], 1)
        along = torch.cat(
            [points[:, 1:2] - points[:, :1], points[:, 2:] - points[:, :-2], points[:, -1:] - points[:, -2:-1]], 1
        )
        places = torch.arange(along.shape[1]).to(along.device)
        moving = torch.where(along.detach().any(-1), places, 0).cummax(dim=1).values  # a repeated end goes on as before
        x, y = along.gather(1, moving[..., None].expand_as(along)).unbind(-1)
        squared = x * x + y * y + _SHORTEST**2
        return 1 + (self.nib[:, :1] * (x * x - y * y) + self.nib[:, 1:] * 2 * x * y) / squared


class _Marks(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, trajectories: Tensor, numbers: Tensor, pixels_per_metre: float) -> tuple[Tensor, ...]:
        ctx.save_for_backward(trajectories, numbers)
        ctx.pixels_per_metre = pixels_per_metre
        count, points, _ = trajectories.shape
        empty = trajectories.new_empty
        drawn = empty(count, points, 2), empty(count, points), empty(count)
        given = trajectories.detach().numpy(), numbers.numpy(), pixels_per_metre
        _laying.mark(*given, *(tensor.numpy() for tensor in drawn))
        return drawn

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, *grad_out: Tensor) -> tuple[Tensor, None, None]:
        trajectories, numbers = (tensor.detach() for tensor in ctx.saved_tensors)
        slopes = torch.empty_like(trajectories)
        given = trajectories.numpy(), numbers.numpy(), ctx.pixels_per_metre
        _laying.mark_backward(*given, *(tensor.contiguous().numpy() for tensor in grad_out), slopes.numpy())
        return slopes, None, None


def paint(
    canvas: Tensor, trajectories: Tensor, colours: Tensor, brushes: Traj2Stroke, pixels_per_metre: float
) -> Tensor:
    """Return the canvas (C, H, W) after all strokes in order.

    trajectories: (N, n, 3) of x, y in metres and pressure in [0, 1].  colours: (N, C).

    Raises InputError for what cannot be drawn.
    """
    marks = brushes.marks(trajectories, pixels_per_metre)
    return composite(canvas, marks.points, marks.thickness, colours, marks.falloff, marks.plateau, marks.opacity)
