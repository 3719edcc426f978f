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
    trial = StrokeCanvas(joined([strokes, *candidates]), problem)
    trial.sort()
    marks, colours = trial.drawn()
    new = torch.from_numpy(np.isin(trial.order_of_all, np.arange(len(strokes), len(trial.strokes))))
    costs = trial.by_row(insertion_costs(view, problem.paper, marks, colours, new, generator))
    of_brushes = costs[len(strokes) :].reshape(len(candidates), -1)
    if (regions := problem.regions) is not None:
        there = regions.at(candidates[0].centres).tolist()
        allowed = [[regions.said[number].brushes[brush] for number in there] for brush in range(len(candidates))]
        of_brushes = of_brushes.masked_fill(~torch.tensor(allowed), torch.inf)
    best: Tensor = of_brushes.argmin(dim=0)
    return joined(candidates)[best * len(best) + torch.arange(len(best))]
