"""Few calls of expensive networks: between two calls, what they said last stands for them."""

import json
from collections.abc import Sequence

import numpy as np
import torch
from torch import Generator, Tensor

from maulstick.plan.commission import Weighted
from maulstick.plan.objectives import Judge
from maulstick.plan.state import State
from maulstick.threads import usual_torch_threads

_SEEN_AGAIN, _NEW = 2, 2
_MEMORY = 0.5
_RADIUS, _SMALLEST, _LARGEST = 0.1, 0.02, 0.5
_KEPT, _BROKEN = 0.5, 0.1
_WIDER, _NARROWER = 1.3, 0.7


class Judgement:
    """What judges think of the canvas, by the slope that they gave when they were last asked.

    A call gives their loss v and its slope at a canvas c0. Until the next one, their loss is taken to be

        v + <slope, c - c0> + pull |c - c0|² / 2

    whose last term keeps the canvas where the slope can be trusted: its minimum lies one radius, the root of the mean
    square over pixels, from c0. A call looks through some views a second time, so that what was promised can be
    compared with what came, and the radius grows or shrinks with it (a trust region). Slopes are averaged over
    calls, since every call sees other views.
    """

    def __init__(self, judges: Sequence[Weighted[Judge]], paper: Tensor) -> None:
        self._judges = judges
        self._views = min(judge.term.views for judge in judges)
        self._anchor = self._slope = torch.zeros_like(paper)
        self._value, self._radius = 0.0, _RADIUS
        self._seen: dict[int, float] = {}
        self.calls = 0
        self.parts: dict[str, float] = {}

    @usual_torch_threads()
    def ask(self, canvas: Tensor, chance: Generator) -> None:
        """Call all judges, each for some of its views of the canvas (C, H, W)."""
        canvas = canvas.detach().requires_grad_()
        which = self._choose(chance)
        losses = {each.term.name: each.weight * each.term.losses(canvas, which) for each in self._judges}
        of_views = torch.stack(list(losses.values())).sum(dim=0)
        (slope,) = torch.autograd.grad(of_views.mean(), canvas)
        self._trust(canvas.detach(), dict(zip(which, of_views.tolist(), strict=True)))
        self._slope = slope if self.calls == 0 else _MEMORY * self._slope + (1 - _MEMORY) * slope
        self._anchor, self._value = canvas.detach(), of_views.mean().item()
        self.parts = {name: part.mean().item() for name, part in losses.items()}
        self.calls += 1

    def loss(self, canvas: Tensor) -> Tensor:
        """What they would say of a canvas (C, H, W) near the one that they saw."""
        moved = canvas - self._anchor
        pull = self._slope.square().mean().sqrt() / self._radius
        return self._value + (self._slope * moved).sum() + pull / 2 * moved.square().sum()

    @property
    def proposal(self) -> Tensor:
        """The canvas (C, H, W) that they would rather see, as far as their slope can be trusted."""
        steepness = self._slope.square().mean().sqrt().clamp(min=1e-30)
        return (self._anchor - self._slope * (self._radius / steepness)).clamp(0, 1)

    def state(self) -> State:
        """What they said last."""
        last = {name: getattr(self, name) for name in ("_value", "_radius", "calls", "parts")}
        seen = np.array(list(self._seen.items()), dtype=np.float64).reshape(-1, 2)
        judged, slope = self._anchor.cpu().numpy(), self._slope.cpu().numpy()
        return {"judged": judged, "slope": slope, "seen": seen, "last": np.array(json.dumps(last))}

    def restore(self, state: State) -> None:
        """Take that for what they said last."""
        for name, value in json.loads(str(state["last"])).items():
            setattr(self, name, value)
        self._seen = {int(view): loss for view, loss in state["seen"].tolist()}
        self._anchor, self._slope = (torch.from_numpy(state[name]).to(self._anchor) for name in ("judged", "slope"))

    def _choose(self, chance: Generator) -> list[int]:
        """Views to look through: some of the last ones first, then others."""
        order = torch.randperm(self._views, generator=chance).tolist()
        again = [view for view in order if view in self._seen][:_SEEN_AGAIN]
        others = [view for view in order if view not in self._seen]
        return (again + others)[: _SEEN_AGAIN + _NEW]

    def _trust(self, canvas: Tensor, seen: dict[int, float]) -> None:
        """Compare what came with what was promised, through the views that were looked through both times."""
        again = [view for view in seen if view in self._seen]
        promised = -(self._slope * (canvas - self._anchor)).sum().item()
        if again and promised > 0:
            came = sum(self._seen[view] - seen[view] for view in again) / len(again)
            change = _WIDER if came > _KEPT * promised else _NARROWER if came < _BROKEN * promised else 1.0
            self._radius = min(max(self._radius * change, _SMALLEST), _LARGEST)
        self._seen = seen
