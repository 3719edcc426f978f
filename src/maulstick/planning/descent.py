"""Gradient descent with one rate per kind of parameter. All rates rise and fall together."""

from math import cos, pi

import numpy as np
import torch
from torch import Tensor

from maulstick.planning.adam import Adam
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.state import State

_RATES = {"codes": 0.03, "angles": 0.075, "pressure_knots": 0.045, "colours": 0.03}
"""Rates of Adam, about the largest step of each kind: in units of the code, radians, pressure and sRGB in [0, 1]."""

_CENTRES_IN_SPACINGS = 0.15  # rate of centres in spacings between strokes, so that it suits sheets of any size
_BETAS = (0.8, 0.9)  # short averages: the slope of a stroke turns as those around it move (docs/planning.md)
_PAINTS = 0.005  # rate of paints in sRGB: lower than that of free colours, since many strokes share a paint
_WARM_UP = 20  # steps over which the rates rise, while Adam's averages are over few gradients
_LAST = 0.02  # share that is added to the cosine, so that the last steps still move something


class Descent:
    """Adam over the parameters of strokes, and later of paints.

    spacing: metres between strokes, which a step of their centres is measured by.
    turning: share of the usual rate at which strokes turn.  lightest: (k,), least pressure of each brush.
    """

    def __init__(self, strokes: StrokeParameters, spacing: float, lightest: Tensor, turning: float = 1.0) -> None:
        self.strokes, self._lightest = strokes, lightest
        self._paints: Tensor | None = None
        self._steps = 0
        rates = {**_RATES, "centres": _CENTRES_IN_SPACINGS * spacing, "angles": turning * _RATES["angles"]}
        self._adam = Adam(_BETAS)
        for name, tensor in strokes.each().items():
            if tensor.requires_grad:
                self._adam.add(tensor, rates[name])

    def add_paints(self, paints: Tensor, pinned: Tensor) -> None:
        """Adapt the colours (k, C) of the paints too, but for those that are pinned, (k,)."""
        self._paints = paints
        if pinned.any():
            paints.register_hook(lambda slope: slope.masked_fill(pinned[:, None], 0))
        self._adam.add(paints, _PAINTS)

    def step(self, loss: Tensor, progress: float) -> None:
        """Take a step down the loss, of a size that follows half a cosine over progress in [0, 1]."""
        self._steps += 1
        self._adam.step(loss, min(1.0, self._steps / _WARM_UP) * (0.5 + 0.5 * cos(pi * progress)) + _LAST)
        self._clamp()

    def replace(self, rows: Tensor, others: StrokeParameters) -> None:
        """Put other strokes in some rows, and forget what Adam knows of these rows."""
        self.strokes.replace_rows(rows, others)
        self._adam.forget(list(self.strokes.each().values()), rows)

    def state(self) -> State:
        """Return all that the next step depends on, without the strokes and paints themselves."""
        return {"steps": np.array(self._steps), **self._adam.state()}

    def restore(self, state: State) -> None:
        """Put a state from `state` back."""
        self._steps = int(state["steps"])
        self._adam.restore(state)

    @torch.no_grad()
    def _clamp(self) -> None:
        knots, lightest = self.strokes.pressure_knots, self._lightest[self.strokes.brush_of, None]
        torch.maximum(knots.clamp_(max=1), lightest, out=knots)
        self.strokes.colours.clamp_(0, 1)
        if self._paints is not None:
            self._paints.clamp_(0, 1)
