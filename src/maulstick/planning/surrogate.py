"""Few calls of expensive networks: between two calls, what they said last stands for them."""

import json
from collections.abc import Sequence

import numpy as np
import torch
from torch import Generator, Tensor

from maulstick.planning.objectives import NetworkLoss
from maulstick.planning.problem import Weighted
from maulstick.planning.state import State
from maulstick.rendering.threads import usual_torch_threads

_AT_ONCE = 2
_MEMORY = 0.8
_RADIUS = 0.2


class Surrogate:
    """What network losses think of the canvas, by the slope that they gave when they were last asked.

    A call gives their loss v and its slope at a canvas c0. Until the next one, their loss is taken to be

        v + <slope, c - c0> + pull |c - c0|² / 2

    whose last term keeps the canvas where the slope can be trusted: alone, it would let each pixel move by a radius, as
    the root of the mean square over all of them. Slopes are averaged over calls, since every call sees other views.
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
        which = torch.randperm(self._views, generator=torch_rng)[:_AT_ONCE].tolist()
        parts = {each.term.name: each.weight * each.term.losses(canvas, which).mean() for each in self._network_losses}
        loss = torch.stack(list(parts.values())).sum()
        (slope,) = torch.autograd.grad(loss, canvas)
        self._slope = slope if self.calls == 0 else _MEMORY * self._slope + (1 - _MEMORY) * slope
        self._anchor, self._value = canvas.detach(), loss.item()
        self.parts = {name: part.item() for name, part in parts.items()}
        self.calls += 1

    def loss(self, canvas: Tensor) -> Tensor:
        """What they would say of a canvas (C, H, W) near the one that they saw."""
        moved = canvas - self._anchor
        pull = self._slope.square().mean().sqrt() / _RADIUS
        return self._value + (self._slope * moved).sum() + pull / 2 * moved.square().sum()

    @property
    def proposal(self) -> Tensor:
        """The canvas (C, H, W) that they would rather see, as far as their slope can be trusted."""
        steepness = self._slope.square().mean().sqrt().clamp(min=1e-30)
        return (self._anchor - self._slope * (_RADIUS / steepness)).clamp(0, 1)

    def state(self) -> State:
        """What they said last."""
        last = {"parts": self.parts, "value": self._value, "calls": self.calls}
        judged, slope = self._anchor.cpu().numpy(), self._slope.cpu().numpy()
        return {"anchor": judged, "slope": slope, "last": np.array(json.dumps(last))}

    def restore(self, state: State) -> None:
        """Take that for what they said last."""
        last = json.loads(str(state["last"]))
        self.parts, self._value, self.calls = last["parts"], last["value"], last["calls"]
        self._anchor, self._slope = (torch.from_numpy(state[name]).to(self._anchor) for name in ("anchor", "slope"))
