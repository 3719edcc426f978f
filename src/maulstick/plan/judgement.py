"""Few calls of expensive networks: between two calls, what they said last stands for them."""

import json
from collections.abc import Sequence

import numpy as np
import torch
from torch import Generator, Tensor

from maulstick.plan.commission import Weighted
from maulstick.plan.objectives import Judge
from maulstick.plan.state import State

_AT_ONCE = 4
_MEMORY = 0.5


class Judgement:
    """What judges think of the canvas, by the slope that they gave when they were last asked.

    A call gives their loss and its slope at a canvas c0. Until the next one their loss is taken to be
    v + <slope, c - c0> + pull |c - c0|² / 2, the last term keeping the canvas where the slope can be trusted.
    """

    def __init__(self, judges: Sequence[Weighted[Judge]], paper: Tensor, radius: float = 0.1) -> None:
        self._judges = judges
        self._views = min(judge.term.views for judge in judges)
        self._radius = radius
        self._anchor = self._slope = torch.zeros_like(paper)
        self._value = 0.0
        self.calls = 0
        self.parts: dict[str, float] = {}

    def ask(self, canvas: Tensor, chance: Generator) -> None:
        """Call all judges, each for some of its views of the canvas (C, H, W)."""
        which = torch.randperm(self._views, generator=chance)[:_AT_ONCE].tolist()
        canvas = canvas.detach().requires_grad_()
        losses = {judge.term.name: judge.weight * judge.term.losses(canvas, which).mean() for judge in self._judges}
        loss = torch.stack(list(losses.values())).sum()
        (slope,) = torch.autograd.grad(loss, canvas)
        self._slope = slope if self.calls == 0 else _MEMORY * self._slope + (1 - _MEMORY) * slope
        self._anchor, self._value = canvas.detach(), loss.item()
        self.parts = {name: part.item() for name, part in losses.items()}
        self.calls += 1

    def state(self) -> State:
        """What they said last."""
        last = {"parts": self.parts, "value": self._value, "calls": self.calls}
        return {
            "judged": self._anchor.cpu().numpy(),
            "slope": self._slope.cpu().numpy(),
            "last": np.array(json.dumps(last)),
        }

    def restore(self, state: State) -> None:
        """Take that for what they said last."""
        last = json.loads(str(state["last"]))
        self.parts, self._value, self.calls = last["parts"], last["value"], last["calls"]
        self._anchor, self._slope = (torch.from_numpy(state[name]).to(self._anchor) for name in ("judged", "slope"))

    @property
    def proposal(self) -> Tensor:
        """The canvas (C, H, W) that they would rather see, as far as their slope can be trusted."""
        step = self._slope * (self._radius / self._slope.square().mean().sqrt().clamp(min=1e-30))
        return (self._anchor - step).clamp(0, 1)

    def loss(self, canvas: Tensor) -> Tensor:
        """What they would say of a canvas (C, H, W) near the one that they saw."""
        moved = canvas - self._anchor
        pull = self._slope.square().mean().sqrt() / self._radius
        return self._value + (self._slope * moved).sum() + pull / 2 * moved.square().sum()
