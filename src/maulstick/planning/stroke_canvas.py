"""Stroke canvas: the strokes and paints of a plan in the making, rendered in their painting order."""

import numpy as np
import torch
from torch import Tensor

from maulstick.colour.palette import nearest_paint
from maulstick.ordering.layers import by_paint, light_to_dark
from maulstick.planning.drawn_pixels import to_canvas, to_drawn
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.problem import PlanningProblem
from maulstick.planning.result import PlanResult
from maulstick.planning.room import cut_marks, move_into
from maulstick.planning.state import State
from maulstick.rendering.kernels.render import composite
from maulstick.rendering.traj2stroke import Marks, Traj2Stroke
from maulstick.storage.arrays import Bools, Floats, Ints


class StrokeCanvas:
    """N strokes that keep their rows, M neighbours among them that nothing changes, and the order of painting.

    Parameters are on the CPU, and the canvas is on the device of the problem's paper (C, H, W).
    paints: (k, C), or None while every stroke has a colour of its own.  paint_of: (N,), indices of paints.
    in_groups: whether strokes lie in groups of their hands, as `Guides.keep` asks.
    """

    def __init__(self, strokes: StrokeParameters, problem: PlanningProblem, *, in_groups: bool = False) -> None:
        self.strokes, self.style, self.paper = strokes, problem.style, problem.paper
        self._drawn_paper = 1.0, self.paper  # on pixels of that side
        self._neighbours, self._canvas, self._room = problem.neighbours, problem.canvas, problem.room
        self._regions, self._brushes = problem.regions, Traj2Stroke.of(problem.brushes)
        self._ordered = torch.zeros(0, dtype=torch.long), self._brushes[torch.zeros(0, dtype=torch.long)]
        self._guides, self._in_groups = problem.guides, in_groups
        self._order = np.arange(len(strokes) + len(self._neighbours.colours))  # neighbours are the last M rows
        self.paints: Tensor | None = None
        self.paint_of = torch.zeros(len(strokes), dtype=torch.long)
        if self._room is not None or self._regions is not None:
            self.keep_inside()

    @property
    def order(self) -> Ints:
        """Rows (N,) of the strokes in painting order."""
        return self._order[self._own]

    @property
    def order_of_all(self) -> Ints:
        """Rows (N + M,) of all strokes in painting order; neighbours have the last M rows."""
        return self._order

    @property
    def _own(self) -> Bools:
        return self._order < len(self.strokes)

    @property
    def colours(self) -> Tensor:
        """Colours (N + M, C), by row."""
        own = self.strokes.colours if self.paints is None else self.paints.index_select(0, self.paint_of)
        return torch.cat([own, self._neighbours.colours])

    @property
    def _brush_of(self) -> Tensor:
        """Brushes (N + M,), by row."""
        return torch.cat([self.strokes.brush_of, self._neighbours.brush_of])

    def drawn(self, side: float = 1) -> tuple[Marks, Tensor]:
        """Return marks and colours of all N + M strokes in painting order, on the device of the paper.

        side: of the marks' pixels, in those of the canvas.
        """
        own, order = self.strokes.trajectories(self.style), torch.from_numpy(self._order)
        trajectories = torch.cat([own, self._neighbours.trajectories]).index_select(0, order)
        resolution = self._canvas.pixels_per_metre / side
        marks = self._brushes_of(self._brush_of[order]).marks(trajectories, resolution)
        if self._room is not None:
            marks = cut_marks(self._room, marks, resolution)
        *moved, colours = _moved([*vars(marks).values(), self.colours.index_select(0, order)], self.paper.device)
        return Marks(*moved), colours

    def _brushes_of(self, numbers: Tensor) -> Traj2Stroke:
        """Return the brushes of these numbers (N + M,), which are the same for many steps."""
        known, brushes = self._ordered
        if not torch.equal(known, numbers):
            brushes = self._brushes[numbers]
            self._ordered = numbers, brushes
        return brushes

    def render(self, wanted: Bools | None = None, *, side: float = 1) -> Tensor:
        """Return the canvas (C, H, W) with all strokes, or with only those of the N that are `wanted`, (N,).

        side: of the pixels that it is drawn on, in its own; each is the average over its area.
        """
        marks, colours = self.drawn(side)
        own = torch.from_numpy(self._own)
        if wanted is not None:
            shown = torch.ones_like(own)
            shown[own] = torch.from_numpy(wanted[self.order])
            marks = Marks(**{name: tensor[shown] for name, tensor in vars(marks).items()})
            colours, own = colours[shown], own[shown]
        profile = marks.falloff, marks.plateau, marks.opacity
        trainable = own.to(self.paper.device)
        if side != self._drawn_paper[0]:
            self._drawn_paper = side, to_drawn(self.paper, side)
        canvas = composite(self._drawn_paper[1], marks.points, marks.thickness, colours, *profile, trainable=trainable)
        return to_canvas(canvas, side, self.paper)

    def keep_inside(self) -> None:
        """Move each stroke by the least that keeps its path on the canvas, its mark in the room, it in its region.

        It is turned back, too, where guides or regions say a direction.
        """
        if self._regions is not None:
            self._regions.move_in(self.strokes)
        if self._guides is not None:
            self._guides.keep(self.strokes, in_groups=self._in_groups)
        if self._regions is not None:
            self._regions.move_off_bare(self.strokes, self._brushes[self.strokes.brush_of])
        self.strokes.keep_inside(self.style, self._canvas.width, self._canvas.height)
        if self._room is not None:
            move_into(self._room, self.strokes, self.style, self._brushes[self.strokes.brush_of])

    def by_row(self, ordered: Tensor) -> Tensor:
        """Return values in painting order, (N + M, …), by row and without neighbours, (N, …)."""
        rows = torch.empty_like(ordered)
        rows[torch.from_numpy(self._order).to(ordered.device)] = ordered
        return rows[: len(self.strokes)].cpu()

    def sort(self) -> None:
        """Put strokes in order from light to dark, while colours are free."""
        if self.paints is None:
            self._order = light_to_dark(as_array(self.colours), self._brush_of.numpy())

    def quantise(self, paints: Tensor, grouped: bool) -> None:
        """Give every stroke the nearest of the paints (k, C); where `grouped`, order them paint by paint."""
        self.paints = paints
        colours, mixed = as_array(self.strokes.colours), as_array(paints)
        self.repaint(torch.from_numpy(nearest_paint(colours, mixed, self.allowed_paints())), grouped)

    @property
    def mixes(self) -> Bools:
        """Which of the strokes, (N,), have colours that paints are mixed for, where their region names none."""
        if self._regions is None:
            return np.ones(len(self.strokes), dtype=bool)
        free = np.array([region.colours is None for region in self._regions.said])
        return np.asarray(free[self._regions.style.regions_of(self.strokes.codes).numpy()])

    def allowed_paints(self) -> Bools | None:
        """Return which of the paints each stroke may have where it lies, (N, k); None where each may have all."""
        if self._regions is None or self.paints is None:
            return None
        return self._regions.allowed_paints(self._regions.style.regions_of(self.strokes.codes), as_array(self.paints))

    def repaint(self, paint_of: Tensor, grouped: bool) -> None:
        """Give the strokes the paints of these indices, (N,); where `grouped`, order them paint by paint."""
        assert self.paints is not None
        self.paint_of = paint_of
        if grouped:
            theirs = nearest_paint(as_array(self._neighbours.colours), as_array(self.paints))
            self._order = by_paint(np.concatenate([paint_of.numpy(), theirs]), self._brush_of.numpy(), self._order)

    def result(self, kept: Bools) -> PlanResult:
        """Return those of the strokes that are kept, (N,), in painting order, with their paints."""
        assert self.paints is not None
        count, neighbours = len(self.strokes), len(self._neighbours.colours)
        shown = np.append(kept, np.zeros(neighbours, dtype=bool))[self._order]
        rows = torch.from_numpy(self._order[shown])
        before = np.zeros(neighbours, dtype=np.int64)
        before[self._order[~self._own] - count] = np.cumsum(shown)[~self._own]
        return PlanResult(self.strokes[rows], self.paints.detach(), self.paint_of[rows], torch.from_numpy(before))

    def state(self) -> State:
        """Return strokes, paints and order."""
        strokes = {name: tensor.detach().numpy() for name, tensor in self.strokes.each().items()}
        paints = {} if self.paints is None else {"paints": self.paints.detach().numpy()}
        return {**strokes, **paints, "paint_of": self.paint_of.numpy(), "order": self._order}

    def restore(self, state: State) -> None:
        """Put the strokes and the order of a state back; the paints are left to the caller, who may adapt them."""
        for name, tensor in self.strokes.each().items():
            tensor.detach().copy_(torch.from_numpy(state[name]))
        self.paint_of, self._order = torch.from_numpy(state["paint_of"]), np.array(state["order"])


def _moved(tensors: list[Tensor], device: torch.device) -> list[Tensor]:
    """Return tensors of one type on a device; to another than theirs in one copy, since each copy is waited for."""
    if all(tensor.device == device for tensor in tensors):
        return tensors
    together = torch.cat([tensor.flatten() for tensor in tensors]).to(device)
    parts = zip(together.split([tensor.numel() for tensor in tensors]), tensors, strict=True)
    return [(part if tensor.requires_grad else part.detach()).view(tensor.shape) for part, tensor in parts]


def as_array(tensor: Tensor) -> Floats:
    """Return the numbers of a tensor as a NumPy array."""
    return tensor.detach().cpu().numpy().astype(np.float64)
