"""Free style: any smooth stroke within limits of length, learned from nobody."""

import hashlib
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import inf
from typing import Any, Self

import torch
from torch import Generator, Tensor
from torch.autograd.function import once_differentiable

from maulstick.errors import InputError
from maulstick.painting.raster import Canvas
from maulstick.strokes.strokes import POINTS
from maulstick.style import _free
from maulstick.style.pressure import KNOTS
from maulstick.style.shape import spline_basis
from maulstick.style.style import Style

CONTROL_POINTS = 8
"""Control points of a stroke's spline: enough for an S, too few for tremor."""


@dataclass(frozen=True, repr=False)
class FreeStyle(Style):
    """Style of clamped cubic B-splines with 8 control points.

    The first control point is the origin and the last lies on the positive x-axis, so that every code decodes to a
    standardised path. A code is the chord's length and then the six inner control points, in units of `unit`.

    shortest, longest: limits of the length of a stroke, metres.
    """

    shortest: float
    longest: float
    name: str = field(default="free", init=False)
    max_mean_cost: float = field(default=inf, init=False)

    def __post_init__(self) -> None:
        if not 0 < self.shortest < self.longest:
            limits = f"{self.shortest * 1e3:g} to {self.longest * 1e3:g} mm"
            raise InputError.of_range("the length of a stroke", limits, "a range of lengths above 0")

    @classmethod
    def for_canvas(cls, canvas: Canvas) -> Self:
        """Return the style whose strokes are a fiftieth to a half of the canvas's shorter side long."""
        side = min(canvas.width, canvas.height)
        return cls(shortest=side / 50, longest=side / 2)

    @property
    def hash(self) -> str:
        """Hash of all that decoding depends on."""
        return hashlib.sha256(f"free {CONTROL_POINTS} {POINTS} {self.unit!r}".encode()).hexdigest()[:16]

    @property
    def unit(self) -> float:
        """Length in metres that a 1 in a code stands for."""
        return self.longest / 4

    @cached_property
    def _basis(self) -> Tensor:
        return torch.from_numpy(spline_basis(CONTROL_POINTS))

    def encode(self, paths: Tensor) -> Tensor:
        """Return codes (N, 13) of the least-squares B-splines through paths (N, 32, 2), metres; their ends are kept."""
        basis = self._basis.to(paths)
        ends = torch.stack([paths[:, 0], paths[:, -1]], dim=1)
        rest = paths - basis[:, [0, -1]] @ ends
        inner = torch.linalg.pinv(basis[:, 1:-1]) @ rest
        chord = paths[:, -1, :1] - paths[:, 0, :1]
        return torch.cat([chord, inner.flatten(1)], dim=1) / self.unit

    def decode(self, codes: Tensor) -> Tensor:
        """Return paths (N, 32, 2), metres, of codes (N, 13), at equal steps of the spline's parameter."""
        return (self._controls(codes) @ self._points.to(codes)).reshape(len(codes), POINTS, 2)

    def _controls(self, codes: Tensor) -> Tensor:
        """Control points (N, 16), metres: x and y of one after another."""
        nothing = codes.new_zeros(len(codes), 3)
        return torch.cat([nothing[:, :2], codes[:, 1:], codes[:, :1].abs(), nothing[:, 2:]], dim=1) * self.unit

    @cached_property
    def _points(self) -> Tensor:
        """How control points move the points of a path, (16, 64): x and y alike."""
        return torch.kron(self._basis.T.contiguous(), torch.eye(2, dtype=torch.float64))

    def sample(self, k: int, generator: Generator) -> tuple[Tensor, Tensor]:
        """Draw gently bent strokes, (k, 13) and (k, 4), log-uniform in length, each of constant pressure."""
        return self.sample_for(
            self.shortest * (self.longest / self.shortest) ** torch.rand(k, generator=generator), generator
        )

    def sample_around(self, rows: Tensor, generator: Generator) -> tuple[Tensor, Tensor]:
        """Draw as many strokes as `rows` (k,): there is no hand that they could be around."""
        return self.sample(len(rows), generator)

    def nearest(self, paths: Tensor) -> None:
        """Return None: there is no hand whose strokes they could be like."""

    @property
    def arrangement(self) -> None:
        """Return None: there is no hand that arranges strokes."""
        return None

    def sample_for(self, lengths: Tensor, generator: Generator, rows: Tensor | None = None) -> tuple[Tensor, Tensor]:
        """Draw gently bent strokes of these lengths (k,) within the limits, metres, each of constant pressure."""
        k = len(lengths)
        along = torch.linspace(0, 1, CONTROL_POINTS)[1:-1]
        bend = 0.5 * torch.randn(k, 1, generator=generator) * along * (1 - along)
        inner = torch.stack([along.expand(k, -1), bend], dim=-1)
        shapes = torch.cat([torch.ones(k, 1), inner.flatten(1)], dim=1)
        drawn = self.decode(shapes).diff(dim=1).square().sum(-1).sqrt().sum(1, keepdim=True)
        wanted = lengths.to(drawn).clamp(self.shortest, self.longest)[:, None]
        return shapes * wanted / drawn, torch.rand(k, 1, generator=generator).expand(k, KNOTS).clone()

    def lengths(self, count: int) -> None:
        """Return None: strokes may have any length within the limits."""

    def resize(self, codes: Tensor, lengths: Tensor, own: Tensor) -> None:
        """Change codes (N, 13) in place, so that their strokes have these lengths (N,), metres."""
        codes *= (lengths / own).to(codes)[:, None]

    def usual_cost(self, k: int, generator: Generator) -> float:
        """Mean cost of k samples."""
        return float(self.cost(*self.sample(k, generator)).mean())

    def scaled(self, times: float) -> Self:
        """Return the style whose limits are so many times as long; itself for 1."""
        if times == 1:
            return self
        return replace(self, shortest=self.shortest * times, longest=self.longest * times)

    def speeds(self, codes: Tensor) -> Tensor | None:
        """Return None: there is no hand whose speed could be used."""
        return None

    def cost(self, codes: Tensor, pressure_knots: Tensor) -> Tensor:
        """Cost (N,): relative bending of the control polygon, length beyond the limits, and changes of pressure."""
        if all(each.device.type == "cpu" and each.dtype == torch.float32 for each in (codes, pressure_knots)):
            limits = self.unit, self.shortest, self.longest
            costs: Tensor = _Cost.apply(codes.contiguous(), pressure_knots.contiguous(), limits)
            return costs
        return self.plain_cost(codes, pressure_knots)

    def plain_cost(self, codes: Tensor, pressure_knots: Tensor) -> Tensor:
        """Return the same as `cost`, plainly: on any device, in any precision."""
        controls = self._controls(codes)
        steps = (controls[:, 2:] - controls[:, :-2]).reshape(len(codes), CONTROL_POINTS - 1, 2)
        length = steps.square().sum(-1).add(1e-12).sqrt().sum(1)
        even = length[:, None, None] / (CONTROL_POINTS - 1)
        bending = (steps.diff(dim=1) / even).square().sum((1, 2))
        shorter = (torch.log(self.shortest / length)).clamp(min=0)
        longer = (torch.log(length / self.longest)).clamp(min=0)
        return bending + 100 * (shorter + longer).square() + pressure_knots.diff(dim=1).square().sum(1)


class _Cost(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, codes: Tensor, knots: Tensor, limits: tuple[float, float, float]) -> Tensor:
        given, costs = (codes.detach(), knots.detach()), codes.new_empty(len(codes), 1)
        slopes = [torch.empty_like(each) for each in given]
        _free.cost(*(x.numpy() for x in given), *limits, costs.numpy(), *(x.numpy() for x in slopes))
        ctx.save_for_backward(*slopes)
        return costs[:, 0]

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad_out: Tensor) -> tuple[Tensor | None, ...]:
        return *(grad_out[:, None] * slopes for slopes in ctx.saved_tensors), None
