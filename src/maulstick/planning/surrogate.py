"""Surrogate of network losses, so that few calls of expensive networks are needed."""

import json
from collections.abc import Sequence

import numpy as np
import torch
from torch import Generator, Tensor

from maulstick.planning.objectives import NetworkLoss
from maulstick.planning.problem import Weighted
from maulstick.planning.state import State
from maulstick.rendering.threads import usual_torch_threads

_VIEWS_PER_CALL = 2  # views of each network loss that a call evaluates: time and memory grow with them
_SLOPE_MOMENTUM = 0.8  # share of earlier slopes in the average, since a call sees two views of 32
_RADIUS = 0.2  # change in sRGB, rms over pixels, up to which a slope is trusted; an adaptive one did worse


class Surrogate:
    """A quadratic model of network losses, from their value and slope at the last call.

    A call gives their loss v and its slope at a canvas c0. Until the next call, their loss is modelled as

        v + <slope, c - c0> + pull |c - c0|² / 2

    whose last term is a trust region: pull is chosen so that slope and pull alone would move the canvas by a fixed
    radius, as the root of the mean square over all pixels. Slopes are averaged over calls, since every call sees other
    views.
    """

    def __init__(self, network_losses: Sequence[Weighted[NetworkLoss]], paper: Tensor) -> None:
        self._network_losses = network_losses
        self._views = min(network_loss.term.views for network_loss in network_losses)
        self._anchor = self._slope = torch.zeros_like(paper)
        self._value = 0.0
        self.calls = 0
        self.parts: dict[str, float] = {}

    @usual_torch_threads()
    def ask(self, canvas: Tensor, torch_rng: Generator) -> None:
        """Call all network losses, each for some of its views of the canvas (C, H, W)."""
        canvas = canvas.detach().requires_grad_()
        which = torch.randperm(self._views, generator=torch_rng)[:_VIEWS_PER_CALL].tolist()
        parts = {each.term.name: each.weight * each.term.losses(canvas, which).mean() for each in self._network_losses}
        loss = torch.stack(list(parts.values())).sum()
        (slope,) = torch.autograd.grad(loss, canvas)
        self._slope = slope if self.calls == 0 else _SLOPE_MOMENTUM * self._slope + (1 - _SLOPE_MOMENTUM) * slope
        self._anchor, self._value = canvas.detach(), loss.item()
        self.parts = {name: part.item() for name, part in parts.items()}
        self.calls += 1

    def loss(self, canvas: Tensor) -> Tensor:
        """Return the modelled loss of a canvas (C, H, W) near the one of the last call."""
        moved = canvas - self._anchor
        pull = self._slope.square().mean().sqrt() / _RADIUS
        return self._value + (self._slope * moved).sum() + pull / 2 * moved.square().sum()

    @property
    def proposal(self) -> Tensor:
        """The canvas (C, H, W) that has the least modelled loss."""
        steepness = self._slope.square().mean().sqrt().clamp(min=1e-30)
        return (self._anchor - self._slope * (_RADIUS / steepness)).clamp(0, 1)

    def state(self) -> State:
        """Return what the last call gave."""
        values = {"parts": self.parts, "value": self._value, "calls": self.calls}
        anchor, slope = self._anchor.cpu().numpy(), self._slope.cpu().numpy()
        return {"anchor": anchor, "slope": slope, "network_losses": np.array(json.dumps(values))}

    def restore(self, state: State) -> None:
        """Go on as if the last call had given this state."""
        values = json.loads(str(state["network_losses"]))
        self.parts, self._value, self.calls = values["parts"], values["value"], values["calls"]
        self._anchor, self._slope = (torch.from_numpy(state[name]).to(self._anchor) for name in ("anchor", "slope"))
