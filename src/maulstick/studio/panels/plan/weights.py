"""Sliders for the weights of the loss, before, during and after planning."""

from collections.abc import Awaitable, Callable

from nicegui import ui

from maulstick.studio.state.plan import Plan
from maulstick.studio.state.studio import Studio
from maulstick.studio.state.weighing import TERM_LABELS, check_weights, weights_of
from maulstick.studio.widgets.slider import Slider

Reweigh = Callable[[Plan, dict[str, float]], Awaitable[Plan]]
"""Makes a version of a finished plan with other weights, and shows it."""

_MOST_WEIGHT, _STEP = 3.0, 0.25  # three times the usual weight of 1; steps that a finger can hit


def weight_sliders(weights: dict[str, float], on_change: Callable[[], object] = lambda: None) -> dict[str, Slider]:
    """Make one slider per term; return them by the term's name. Words that count nothing would be left out."""
    least = {"text": _STEP}
    return {
        name: Slider(TERM_LABELS[name], _MOST_WEIGHT, _STEP, weight, on_change, least=least.get(name, 0.0))
        for name, weight in weights.items()
    }


class PlanWeights(ui.expansion):
    """Sliders whose weights a plan takes while it is made, and a version of it once it is finished."""

    def __init__(self, studio: Studio, plan: Plan, reweigh: Reweigh) -> None:
        super().__init__("What matters")
        self._studio, self._plan, self._reweigh = studio, plan, reweigh
        self._shown_weights, self._makes_version = plan.request.options.weights, False
        with self:
            self._sliders = weight_sliders(weights_of(plan.request), self._weigh)

    def follow(self) -> None:
        """Show the plan's present weights, which another page may have changed."""
        weights = self._plan.request.options.weights
        if weights is not self._shown_weights:  # or a slider would slip from under a person's finger
            self._shown_weights = weights
            self._show()

    def open_at(self, term: str) -> None:
        """Open, with the focus on the slider of a term."""
        self.open()
        self._sliders[term].focus()

    def _show(self) -> None:
        weights = weights_of(self._plan.request)
        for name, slider in self._sliders.items():
            slider.set(weights[name])

    def _weights(self) -> dict[str, float]:
        return {name: slider.value for name, slider in self._sliders.items()}

    async def _weigh(self) -> None:
        weights = check_weights(self._weights())
        if self._makes_version or weights == weights_of(self._plan.request):
            return
        if not self._plan.is_busy:
            await self._make_version(weights)
        elif self._plan.can_be_weighed:
            self._studio.plans.weigh(self._plan, weights)
        else:
            self._show()

    async def _make_version(self, weights: dict[str, float]) -> None:
        self._makes_version = True
        try:
            version = await self._reweigh(self._plan, weights)
            if (moved_on := self._weights()) != weights and any(moved_on.values()):
                self._studio.plans.weigh(version, moved_on)
        finally:
            self._makes_version = False
            if not self.is_deleted:  # with the panel
                self._show()
        if not self.is_deleted:
            self.close()
