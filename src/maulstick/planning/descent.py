"""Gradient descent with one rate per kind of parameter. All rates rise and fall together."""

from math import cos, pi

import numpy as np
import torch
from torch import Tensor

from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.state import State, optimiser_state, restore_optimiser

_RATES = {"codes": 0.02, "angles": 0.05, "pressure_knots": 0.03, "colours": 0.02}
"""Rates of Adam, about the largest step of each kind: in units of the code, radians, pressure and sRGB in [0, 1]."""

_CENTRES_IN_SPACINGS = 0.1  # rate of centres in spacings between strokes, so that it suits sheets of any size
_PAINTS = 0.005  # rate of paints in sRGB: lower than that of free colours, since many strokes share a paint
_WARM_UP = 20  # steps over which the rates rise, while Adam's averages are over few gradients
_LAST = 0.02  # share that is added to the cosine, so that the last steps still move something


class Descent:
    """Adam over the parameters of strokes, and later of paints.

    spacing: metres between strokes, which a step of their centres is measured by.
    turning: share of the usual rate at which strokes turn.
    """

    def __init__(self, strokes: StrokeParameters, spacing: float, turning: float = 1.0) -> None:
        self.strokes = strokes
        self._paints: Tensor | None = None
        self._steps = 0
        rates = {**_RATES, "centres": _CENTRES_IN_SPACINGS * spacing, "angles": turning * _RATES["angles"]}
        groups = [
            {"params": [tensor], "full_rate": rates[name]}
            for name, tensor in strokes.each().items()
            if tensor.requires_grad
        ]
        self._adam = torch.optim.Adam(groups, lr=1.0, betas=(0.9, 0.99))

    def add_paints(self, paints: Tensor) -> None:
        """Adapt the colours (k, C) of the paints too."""
        self._paints = paints
        self._adam.add_param_group({"params": [paints], "full_rate": _PAINTS})

    def step(self, loss: Tensor, progress: float) -> None:
        """Take a step down the loss, of a size that follows half a cosine over progress in [0, 1]."""
        self._steps += 1
        rate = min(1.0, self._steps / _WARM_UP) * (0.5 + 0.5 * cos(pi * progress)) + _LAST
        for group in self._adam.param_groups:
            group["lr"] = group["full_rate"] * rate
        self._adam.zero_grad(set_to_none=True)
        loss.backward()
        self._adam.step()
        self._clamp()

    def replace(self, rows: Tensor, others: StrokeParameters) -> None:
        """Put other strokes in some rows, and forget what Adam knows of these rows."""
        self.strokes.replace_rows(rows, others)
        for tensor in self.strokes.each().values():
            if tensor in self._adam.state:
                for moment in ("exp_avg", "exp_avg_sq"):
                    self._adam.state[tensor][moment][rows] = 0

    def state(self) -> State:
        """Return all that the next step depends on, without the strokes and paints themselves."""
        return {"steps": np.array(self._steps), **optimiser_state(self._adam)}

    def restore(self, state: State) -> None:
        """Put a state from `state` back."""
        self._steps = int(state["steps"])
        restore_optimiser(state, self._adam)

    @torch.no_grad()
    def _clamp(self) -> None:
        self.strokes.pressure_knots.clamp_(0, 1)
        self.strokes.colours.clamp_(0, 1)
        if self._paints is not None:
            self._paints.clamp_(0, 1)
