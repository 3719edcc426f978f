"""Price of strokes that are less likely than a style allows, for a plan's loss."""

from math import exp

import torch
from torch import Tensor

from maulstick.planning.parameters import StrokeParameters
from maulstick.style import Style

_LEAST = 1e-5  # weight of the style's cost, at least and at first: next to nothing beside a loss of tones
_GROWTH = 30.0  # exponent of that weight per plan while strokes cost twice what the style allows
_SAMPLES = 256  # strokes, at least, whose mean cost counts as usual for the style: enough for a steady mean


class StylePrice:
    """Price by the style, with a weight that grows while strokes are less likely than it allows, and then falls.

    So strokes keep to a style alike with a broad brush or a thin pen. Strokes of hands without a bound keep the least
    weight, whatever others beside them cost.
    start: the strokes that a plan is to go on from, which may cost as much as they do. The last few of a painting never
    have a hand's whole distribution, and would be pulled towards it, away from the picture.
    """

    def __init__(self, style: Style, strokes: int, seed: int, start: StrokeParameters | None = None) -> None:
        usual = style.usual_cost(max(_SAMPLES, strokes), torch.Generator().manual_seed(seed))
        self._style, self._allowed = style, style.max_mean_cost * usual  # nats
        if start is not None and (bounded := style.is_bounded(start.codes)).any():
            held = style.cost(start.codes, start.pressure_knots)[bounded]
            self._allowed = max(self._allowed, held.mean().item())
        self.weight = _LEAST
        self._excess = 0.0

    def of(self, strokes: StrokeParameters) -> Tensor:
        """Return the weighted price of strokes; few that are far off cost more than many that are little."""
        costs = self._style.cost(strokes.codes, strokes.pressure_knots)
        bounded = self._style.is_bounded(strokes.codes)
        held, free = costs[bounded], costs[~bounded]
        self._excess = min(held.mean().item() / self._allowed - 1, 1.0) if len(held) else -1.0
        dear = held * (1 + held / self._allowed)
        return self.weight * (dear.sum() / len(costs)) + _LEAST * (free.sum() / len(costs))

    def adapt(self, stride: float) -> None:
        """Adapt the weight to the strokes of the last price. stride: share of planning that a step is."""
        self.weight = max(self.weight * exp(_GROWTH * stride * self._excess), _LEAST)
