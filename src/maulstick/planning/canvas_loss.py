"""Loss of a canvas: the cheap terms as they are, and network losses by their surrogate."""

from collections.abc import Callable

import torch
from torch import Generator, Tensor

from maulstick.planning.problem import PlannerSettings, PlanningProblem
from maulstick.planning.state import State
from maulstick.planning.stroke_effects import TargetView
from maulstick.planning.surrogate import Surrogate


class CanvasLoss:
    """Loss of a problem.

    pool: pixels, each way, that are averaged where a canvas is compared with the target.
    """

    def __init__(self, problem: PlanningProblem, options: PlannerSettings) -> None:
        self._problem, self._ask_every = problem, options.ask_every
        self._surrogate = Surrogate(problem.network_losses, problem.paper) if problem.network_losses else None
        self.pool = 1
        if options.in_ink:  # greys are made of lines, which only a blurred view shows as grey
            self.pool = max(1, round(4 * problem.brushes[0].widest * problem.canvas.pixels_per_metre))

    @property
    def view(self) -> TargetView:
        """How a canvas is compared with the target, or without one, with what the surrogate proposes."""
        target = self._problem.target
        if target is None:
            assert self._surrogate is not None
            target = self._surrogate.proposal
        return TargetView(target, self._problem.weights, self.pool, self._problem.pull)

    def ask(self, canvas: Tensor, step: int, torch_rng: Generator) -> None:
        """Ask networks about a canvas (C, H, W), in those steps in which they are asked."""
        if self._surrogate is not None and step % self._ask_every == 0:
            self._surrogate.ask(canvas, torch_rng)

    def of(self, canvas: Tensor, now: float) -> tuple[Tensor, dict[str, float]]:
        """Return the loss of a canvas (C, H, W), and its weighted terms by name; network losses' as last evaluated.

        now: share of planning that is done.
        """
        parts = {each.term.name: each.weight * each.term.loss(canvas, now) for each in self._problem.objectives}
        values = {name: part.item() for name, part in parts.items()}
        loss = sum(parts.values(), torch.zeros((), device=canvas.device))
        if self._surrogate is not None:
            loss, values = loss + self._surrogate.loss(canvas), values | self._surrogate.parts
        return loss, values

    def at(self, now: float) -> Callable[[Tensor], Tensor]:
        """Return the loss of a canvas (C, H, W) at this share of planning, as a function."""
        return lambda canvas: self.of(canvas, now)[0]

    def state(self) -> State:
        """Return what the next step depends on."""
        return {} if self._surrogate is None else self._surrogate.state()

    def restore(self, state: State) -> None:
        """Go on from a state."""
        if self._surrogate is not None and "slope" in state:  # there may have been no network losses before
            self._surrogate.restore(state)
