"""Strokes and paints in the making, and the canvas that they make."""

from dataclasses import replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from maulstick.colour.palette import nearest_paint
from maulstick.ordering.layers import by_paint, light_to_dark
from maulstick.painting.brush import Brush
from maulstick.painting.raster import Canvas
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.problem import NO_NEIGHBOURS, Neighbours
from maulstick.planning.state import State
from maulstick.rendering.kernels.render import composite
from maulstick.rendering.traj2stroke import Marks, Traj2Stroke
from maulstick.style import Style


class StrokeCanvas:
    """N strokes that keep their rows, M neighbours among them that nothing changes, and how they all are painted.

    Their parameters live with the processor, and the canvas wherever the paper (C, H, W) is.
    paints: (k, C), or None while every stroke has a colour of its own.  paint_of: (N,).
    """

    def __init__(
        self,
        strokes: StrokeParameters,
        paper: Tensor,
        canvas: Canvas,
        brush: Brush,
        style: Style,
        neighbours: Neighbours = NO_NEIGHBOURS,
    ) -> None:
        self.strokes, self.style, self.paper, self._neighbours = strokes, style, paper, neighbours
        count = len(strokes) + len(neighbours.colours)
        self._order = np.arange(count)  # neighbours are the last M rows
        self.paints: Tensor | None = None
        self.paint_of = torch.zeros(len(strokes), dtype=torch.long)
        self._brushes = Traj2Stroke.of([brush] * count)
        self._pixels_per_metre = canvas.pixels_per_metre

    @property
    def order(self) -> NDArray[np.int64]:
        """Rows (N,) of the strokes as they are painted."""
        return self._order[self._own]

    @property
    def _own(self) -> NDArray[np.bool_]:
        return self._order < len(self.strokes)

    @property
    def colours(self) -> Tensor:
        """(N + M, C), by row."""
        own = self.strokes.colours if self.paints is None else self.paints[self.paint_of]
        return torch.cat([own, self._neighbours.colours])

    def drawn(self) -> tuple[Marks, Tensor]:
        """Marks and colours of all N + M in painting order, on the device of the paper."""
        trajectories = torch.cat([self.strokes.trajectories(self.style), self._neighbours.trajectories])[self._order]
        marks = self._brushes.marks(trajectories, self._pixels_per_metre)
        there = {name: tensor.to(self.paper.device) for name, tensor in vars(marks).items()}
        return replace(marks, **there), self.colours[self._order].to(self.paper.device)

    def render(self, wanted: NDArray[np.bool_] | None = None) -> Tensor:
        """The canvas (C, H, W) with all strokes, or of the N with those `wanted`, (N,), alone."""
        marks, colours = self.drawn()
        own = torch.from_numpy(self._own)
        if wanted is not None:
            shown = torch.ones_like(own)
            shown[own] = torch.from_numpy(wanted[self.order])
            marks = Marks(**{name: tensor[shown] for name, tensor in vars(marks).items()})
            colours, own = colours[shown], own[shown]
        numbers = marks.falloff, marks.plateau, marks.opacity
        trainable = own.to(self.paper.device)
        return composite(self.paper, marks.points, marks.thickness, colours, *numbers, trainable=trainable)

    def by_row(self, ordered: Tensor) -> Tensor:
        """What is given in painting order, (N + M, …), by row, (N, …)."""
        rows = torch.empty_like(ordered)
        rows[torch.from_numpy(self._order).to(ordered.device)] = ordered
        return rows[: len(self.strokes)].cpu()

    def sort(self) -> None:
        """Light to dark, while colours are free."""
        if self.paints is None:
            self._order = light_to_dark(as_array(self.colours))

    def quantise(self, paints: Tensor, grouped: bool) -> None:
        """Give every stroke the nearest of the paints (k, C), and if they are to be grouped, paint by paint."""
        self.paints = paints
        self.repaint(torch.from_numpy(nearest_paint(as_array(self.strokes.colours), as_array(paints))), grouped)

    def repaint(self, paint_of: Tensor, grouped: bool) -> None:
        """Give the strokes these paints, (N,)."""
        assert self.paints is not None
        self.paint_of = paint_of
        if grouped:
            theirs = nearest_paint(as_array(self._neighbours.colours), as_array(self.paints))
            self._order = by_paint(np.concatenate([paint_of.numpy(), theirs]), self._order)

    def state(self) -> State:
        """Strokes, paints and order."""
        strokes = {name: tensor.detach().numpy() for name, tensor in self.strokes.each().items()}
        paints = {} if self.paints is None else {"paints": self.paints.detach().numpy()}
        return {**strokes, **paints, "paint_of": self.paint_of.numpy(), "order": self._order}

    def restore(self, state: State) -> None:
        """Go on from there: the same strokes and order; whoever made the paints puts them back."""
        for name, tensor in self.strokes.each().items():
            tensor.detach().copy_(torch.from_numpy(state[name]))
        self.paint_of, self._order = torch.from_numpy(state["paint_of"]), np.array(state["order"])


def as_array(tensor: Tensor) -> NDArray[np.float64]:
    """The same numbers for NumPy."""
    return tensor.detach().cpu().numpy().astype(np.float64)
