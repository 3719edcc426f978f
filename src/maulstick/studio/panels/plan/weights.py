"""What matters in a plan, and how much: sliders, also while it is planned."""

from collections.abc import Callable

from nicegui import ui

from maulstick.errors import InputError
from maulstick.studio.state.plans import Plan
from maulstick.studio.state.studio import Studio
from maulstick.studio.widgets.slider import Slider

CALLED = {
    "tone": "Light and dark",
    "edges": "Outlines",
    "likeness": "What is in it",
    "sketch": "Like a sketch of it",
    "text": "The text",
}
"""Terms of the loss, in a person's words."""

OF_A_PICTURE = ("tone", "edges", "likeness", "sketch")
"""Those that compare with a picture."""

_MOST, _STEP = 3.0, 0.25


def weight_sliders(weights: dict[str, float], on_change: Callable[[], object] = lambda: None) -> dict[str, Slider]:
    """A slider a term, by its name."""
    return {name: Slider(CALLED[name], _MOST, _STEP, weight, on_change) for name, weight in weights.items()}


def checked(weights: dict[str, float]) -> dict[str, float]:
    """The weights themselves. Raises InputError where none counts."""
    if not any(weights.values()):
        raise InputError("nothing matters any more, so any painting would do; move one of the sliders up")
    return weights


class PlanWeights(ui.expansion):
    """Sliders that a plan follows as it is made."""

    def __init__(self, studio: Studio, plan: Plan) -> None:
        super().__init__("What matters")
        self._studio, self._plan, self._followed = studio, plan, plan.asked.options.weights
        terms = (
            *(OF_A_PICTURE if plan.asked.picture is not None else ()),
            *(("text",) if plan.asked.options.text else ()),
        )
        usual = {"tone": 1.0, "text": 1.0}
        with self:
            weights = {name: plan.asked.options.weights.get(name, usual.get(name, 0.0)) for name in terms}
            self._sliders = weight_sliders(weights, self._weigh)

    def follow(self) -> None:
        """Show what the plan is weighed by now, which another page may have changed."""
        if self._plan.asked.options.weights is self._followed:  # or a slider would slip from under a person's finger
            return
        self._followed = self._plan.asked.options.weights
        for name, slider in self._sliders.items():
            slider.set(self._plan.asked.options.weights.get(name, slider.value))

    def _weigh(self) -> None:
        weights = checked({name: slider.value for name, slider in self._sliders.items()})
        self._studio.plans.weigh(self._plan, weights)
