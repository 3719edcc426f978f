"""Progress and result of planning."""

from collections.abc import Callable
from dataclasses import dataclass, field

import torch
from torch import Tensor

from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.state import State


@dataclass(frozen=True)
class PlanProgress:
    """Progress after a step: the share of planning that is done, the loss, its parts by name, and the canvas (C, H, W).

    canvas: at first in squares of the same colour, the coarse pixels that it is drawn on.
    state: returns all that planning needs to go on from here; must be called before the next step.
    """

    done: float
    loss: float
    parts: dict[str, float]
    canvas: Tensor
    state: Callable[[], State]


@dataclass(frozen=True)
class PlanResult:
    """N strokes in painting order, the paints (k, 3), sRGB in [0, 1], and the index of each stroke's paint, (N,).

    before: (M,), how many of the strokes are painted before each neighbour.
    """

    strokes: StrokeParameters
    paints: Tensor
    paint_of: Tensor
    before: Tensor = field(default_factory=lambda: torch.zeros(0, dtype=torch.long))
