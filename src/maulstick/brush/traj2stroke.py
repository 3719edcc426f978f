"""Traj2Stroke (paper; design §4): from commanded trajectories and a brush's numbers to marks on a canvas."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import torch
from torch import Tensor

from maulstick.brush.kernels.cpu import composite
from maulstick.medium import Brush

_SOFT_ENOUGH = 4.0
"""Pixels. Edges at least this wide are sampled well enough by the pixels' centres."""


def place(paths: Tensor, poses: Tensor) -> Tensor:
    """Commanded paths R(dθ)(x, y) + (dx, dy), (N, n, 2) metres, of standardised paths and poses (N, 3)."""
    cos, sin = poses[:, 2:3].cos(), poses[:, 2:3].sin()
    x, y = paths.unbind(-1)
    return torch.stack([cos * x - sin * y + poses[:, :1], sin * x + cos * y + poses[:, 1:2]], dim=-1)


@dataclass(frozen=True)
class Marks:
    """What the kernels draw. points: (N, n, 2) pixels; thickness: (N, n) pixels; c, q, o: (N,)."""

    points: Tensor
    thickness: Tensor
    c: Tensor
    q: Tensor
    o: Tensor


@dataclass(frozen=True)
class Traj2Stroke:
    """The numbers of one brush a stroke, as tensors: scale and shift (N, 2), the others (N,); metres."""

    scale: Tensor
    shift: Tensor
    alpha: Tensor
    beta: Tensor
    c: Tensor
    plateau: Tensor
    opacity: Tensor

    @classmethod
    def of(cls, brushes: Sequence[Brush]) -> Self:
        """The numbers of `brushes`, one a stroke."""
        rows = [(b.m_x, b.m_y, b.b_x, b.b_y, b.alpha, b.beta, b.c, b.plateau, b.opacity) for b in brushes]
        numbers = torch.tensor(rows, dtype=torch.float32).reshape(-1, 9)
        return cls(numbers[:, 0:2], numbers[:, 2:4], *numbers[:, 4:].unbind(1))

    def marks(self, trajectories: Tensor, pixels_per_metre: float) -> Marks:
        """Marks of commanded trajectories (N, n, 3) of x, y in metres and press in [0, 1].

        An edge narrower than pixels can show is drawn two pixels wide, and a mark thinner than that paler, such
        that its ink per millimetre stays what it is: a ramp of two pixels adds up to the same ink wherever it lies
        between their centres. So no optimiser can gain by a place on the grid, and a plan looks alike at every
        resolution.
        """
        start = trajectories[:, :1, :2]
        points = start + self.scale[:, None] * (trajectories[..., :2] - start) + self.shift[:, None]
        half_width = (self.alpha[:, None] * trajectories[..., 2] + self.beta[:, None]) * pixels_per_metre
        inked = self.plateau + (1 - self.plateau) / (self.c + 1)  # half-width of a hard mark with as much ink
        mean = half_width.clamp(min=1e-3).mean(dim=1)
        slope = torch.where(self.c > 1, (2 / (self.c * (self.c + 1))).sqrt(), self.c)
        edge = (1 - self.plateau) * slope * mean  # how wide a cone's would be that is as hard to sample
        hard = inked * mean
        q = ((hard - 1) / (hard + 1)).clamp(min=0)
        even = (hard * 2 / (1 + q)).clamp(min=2) / mean
        soft = edge >= _SOFT_ENOUGH
        return Marks(
            points * pixels_per_metre,
            torch.where(soft, 1.0, even)[:, None] * half_width,
            torch.where(soft, self.c, 1.0),
            torch.where(soft, self.plateau, q),
            torch.where(soft, self.opacity, self.opacity * hard.clamp(max=1)),
        )


def paint(
    canvas: Tensor, trajectories: Tensor, colours: Tensor, brushes: Traj2Stroke, pixels_per_metre: float
) -> Tensor:
    """The canvas (C, H, W) after all strokes, in order: trajectories (N, n, 3), colours (N, C)."""
    marks = brushes.marks(trajectories, pixels_per_metre)
    return composite(canvas, marks.points, marks.thickness, colours, marks.c, marks.q, marks.o)
