"""Strokes and paints in the making, and the canvas that they make."""

from dataclasses import replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from maulstick.brush.kernels.render import composite
from maulstick.brush.traj2stroke import Marks, Traj2Stroke
from maulstick.canvas import Canvas
from maulstick.medium import Brush
from maulstick.order import by_paint, light_to_dark
from maulstick.palette import nearest_paint
from maulstick.plan.parameters import StrokeParameters
from maulstick.plan.state import State
from maulstick.style import Style


class Work:
    """N strokes that keep their rows; `order` says how they are painted.

    Their parameters live with the processor, and the canvas wherever the paper (C, H, W) is.
    paints: (k, C), or None while every stroke has a colour of its own.  paint_of: (N,).
    """

    def __init__(self, strokes: StrokeParameters, paper: Tensor, canvas: Canvas, brush: Brush, style: Style) -> None:
        self.strokes, self.style, self.paper = strokes, style, paper
        self.order = np.arange(len(strokes))
        self.paints: Tensor | None = None
        self.paint_of = torch.zeros(len(strokes), dtype=torch.long)
        self._brushes = Traj2Stroke.of([brush] * len(strokes))
        self._pixels_per_metre = canvas.pixels_per_metre

    @property
    def colours(self) -> Tensor:
        """(N, C), by row."""
        return self.strokes.colours if self.paints is None else self.paints[self.paint_of]

    def drawn(self) -> tuple[Marks, Tensor]:
        """Marks and colours in painting order, on the device of the paper."""
        trajectories = self.strokes.trajectories(self.style)[self.order]
        marks = self._brushes.marks(trajectories, self._pixels_per_metre)
        there = {name: tensor.to(self.paper.device) for name, tensor in vars(marks).items()}
        return replace(marks, **there), self.colours[self.order].to(self.paper.device)

    def render(self, wanted: NDArray[np.bool_] | None = None) -> Tensor:
        """The canvas (C, H, W) with all strokes, or with those `wanted`, (N,), alone."""
        marks, colours = self.drawn()
        shown = slice(None) if wanted is None else torch.from_numpy(np.flatnonzero(wanted[self.order]))
        points, thickness, colours = marks.points[shown], marks.thickness[shown], colours[shown]
        return composite(self.paper, points, thickness, colours, marks.c[shown], marks.q[shown], marks.o[shown])

    def by_row(self, ordered: Tensor) -> Tensor:
        """What is given in painting order, (N, …), by row."""
        rows = torch.empty_like(ordered)
        rows[torch.from_numpy(self.order).to(ordered.device)] = ordered
        return rows.cpu()

    def sort(self) -> None:
        """Light to dark, while colours are free."""
        if self.paints is None:
            self.order = light_to_dark(as_array(self.strokes.colours))

    def snap(self, paints: Tensor, grouped: bool) -> None:
        """Give every stroke the nearest of the paints (k, C), and if they are to be grouped, paint by paint."""
        self.paints = paints
        self.paint_of = torch.from_numpy(nearest_paint(as_array(self.strokes.colours), as_array(paints)))
        if grouped:
            self.order = by_paint(self.paint_of.numpy(), self.order)

    def state(self) -> State:
        """Strokes, paints and order."""
        strokes = {name: tensor.detach().numpy() for name, tensor in self.strokes.each().items()}
        paints = {} if self.paints is None else {"paints": self.paints.detach().numpy()}
        return {**strokes, **paints, "paint_of": self.paint_of.numpy(), "order": self.order}

    def restore(self, state: State) -> None:
        """Go on from there: the same strokes and order; whoever made the paints puts them back."""
        for name, tensor in self.strokes.each().items():
            tensor.detach().copy_(torch.from_numpy(state[name]))
        self.paint_of, self.order = torch.from_numpy(state["paint_of"]), np.array(state["order"])


def as_array(tensor: Tensor) -> NDArray[np.float64]:
    """The same numbers for NumPy."""
    return tensor.detach().cpu().numpy().astype(np.float64)
