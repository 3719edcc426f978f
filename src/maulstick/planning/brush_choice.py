"""Choice of a brush for strokes that are placed anew: the one whose stroke serves the canvas best there."""

import numpy as np
import torch
from torch import Generator, Tensor

from maulstick.planning.parameters import StrokeParameters, joined
from maulstick.planning.problem import PlanningProblem
from maulstick.planning.stroke_canvas import StrokeCanvas
from maulstick.planning.stroke_effects import TargetView, insertion_costs


def best_brushes(
    problem: PlanningProblem,
    view: TargetView,
    strokes: StrokeParameters,
    candidates: list[StrokeParameters],
    generator: Generator,
) -> StrokeParameters:
    """Return of the candidates, a set of M strokes at the same places for each brush, the best stroke at each place.

    strokes: that are on the canvas and stay.  Each candidate is judged alone, in its place in the painting order, as
    `insertion_costs` does.
    """
    trial = StrokeCanvas(
        joined([strokes, *candidates]),
        problem.paper,
        problem.canvas,
        problem.brushes,
        problem.style,
        problem.neighbours,
        problem.room,
    )
    trial.sort()
    marks, colours = trial.drawn()
    new = torch.from_numpy(np.isin(trial.order_of_all, np.arange(len(strokes), len(trial.strokes))))
    costs = trial.by_row(insertion_costs(view, problem.paper, marks, colours, new, generator))
    best: Tensor = costs[len(strokes) :].reshape(len(candidates), -1).argmin(dim=0)
    return joined(candidates)[best * len(best) + torch.arange(len(best))]
