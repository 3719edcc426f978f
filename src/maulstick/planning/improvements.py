"""Improvements of a plan that descent cannot find: paints for its strokes, and strokes that it does not need."""

from collections.abc import Callable

import numpy as np
import torch
from torch import Generator, Tensor

from maulstick.colour.palette import mix_paints
from maulstick.planning.canvas_loss import CanvasLoss
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.problem import PlannerSettings, PlanningProblem
from maulstick.planning.stroke_canvas import StrokeCanvas, as_array
from maulstick.planning.stroke_effects import TargetView, coverage, removal_costs
from maulstick.storage.arrays import Bools, Floats

Loss = Callable[[Tensor], Tensor]
"""Loss of a canvas (C, H, W)."""

_NOTHING = 1e-6  # loss of a sheet that already shows its picture: a difference of a quarter of an 8-bit step

_TAKEN_OUT = 0.1  # share of the strokes that are taken out before the others are judged anew


def mix_colours(stroke_canvas: StrokeCanvas, view: TargetView, options: PlannerSettings) -> Floats:
    """Return paints (k, C) mixed for the colours of the strokes, each of which counts by what is seen of it."""
    marks, drawn = stroke_canvas.drawn()
    seen = as_array(stroke_canvas.by_row(coverage(view, stroke_canvas.paper, marks, drawn)))
    colours, own = as_array(stroke_canvas.strokes.colours), stroke_canvas.mixes
    assert options.paints is not None
    return mix_paints(colours[own], np.sqrt(seen.clip(min=1))[own], options.paints, options.seed, options.pinned)


@torch.no_grad()
def repaint(stroke_canvas: StrokeCanvas, loss: Loss, costs: Tensor, *, grouped: bool) -> None:
    """Give strokes other paints, to as many of those that gain most as makes the loss smaller.

    costs: (N, k), estimates of what each paint costs each stroke.
    """
    gain = -costs
    if (allowed := stroke_canvas.allowed_paints()) is not None:
        gain = gain.masked_fill(~torch.from_numpy(allowed), -torch.inf)
    gains, better = gain.max(dim=1)
    candidates = torch.argsort(gains, descending=True, stable=True)[: int((gains > 0).sum())]
    before, was = loss(stroke_canvas.render()), stroke_canvas.paint_of
    while len(candidates):
        stroke_canvas.repaint(was.index_copy(0, candidates, better[candidates]), grouped)
        if loss(stroke_canvas.render()) < before:
            return
        candidates = candidates[: len(candidates) // 2]
    stroke_canvas.repaint(was, grouped)


@torch.no_grad()
def needed(stroke_canvas: StrokeCanvas, loss: Loss, costs: Floats, side: float) -> Bools:
    """Return which strokes, (N,), to keep: the loss does not grow without the others.

    costs: (N,), estimates of what it costs to leave each stroke out.  side: as in `StrokeCanvas.render`.
    """
    before = loss(stroke_canvas.render(side=side))
    kept = np.zeros(len(costs), dtype=bool)
    if loss(stroke_canvas.render(kept, side=side)).item() <= min(before.item(), _NOTHING):
        return kept  # the sheet shows the picture as it is
    candidates = np.argsort(costs, kind="stable")[: int((costs <= 0).sum())]
    while len(candidates):
        kept[:] = True
        kept[candidates] = False
        if loss(stroke_canvas.render(kept, side=side)) <= before:
            return kept
        candidates = candidates[: len(candidates) // 2]
    kept[:] = True
    return kept


def thinned(
    strokes: StrokeParameters, count: int, problem: PlanningProblem, loss: CanvasLoss, generator: Generator
) -> StrokeParameters:
    """Return `count` of the strokes, in their order, without those that the canvas would miss least.

    They go in rounds, since of two strokes over each other each is missed little until the other is gone.
    """
    with torch.no_grad():
        loss.ask(StrokeCanvas(strokes, problem).render(), 0, generator)
    while len(strokes) > count:
        stroke_canvas = StrokeCanvas(strokes, problem)
        costs = removal_costs(loss.view, problem.paper, *stroke_canvas.drawn(), generator)
        out = min(len(strokes) - count, max(1, int(_TAKEN_OUT * len(strokes))))
        strokes = strokes[torch.argsort(stroke_canvas.by_row(costs), stable=True)[out:].sort().values]
    return strokes
