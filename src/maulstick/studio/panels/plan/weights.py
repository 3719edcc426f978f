"""Sliders for the weights of the loss, before and during planning."""

from collections.abc import Callable

from nicegui import ui

from maulstick.errors import InputError
from maulstick.studio.state.plans import Plan
from maulstick.studio.state.studio import Studio
from maulstick.studio.widgets.slider import Slider

TERM_LABELS = {
    "tone": "Light and dark",
    "edges": "Outlines",
    "likeness": "What can be recognised",
    "sketch": "Like a sketch of it",
    "text": "The words",
}
"""Labels of the terms of the loss, by name."""

PICTURE_TERMS = ("tone", "edges", "likeness", "sketch")
"""Names of the terms that compare the canvas with a picture."""

_MOST_WEIGHT, _STEP = 3.0, 0.25  # three times the usual weight of 1; steps that a finger can hit


def weight_sliders(weights: dict[str, float], on_change: Callable[[], object] = lambda: None) -> dict[str, Slider]:
    """Make one slider per term; return them by the term's name."""
    return {name: Slider(TERM_LABELS[name], _MOST_WEIGHT, _STEP, weight, on_change) for name, weight in weights.items()}


def check_weights(weights: dict[str, float]) -> dict[str, float]:
    """Return the weights as they are. Raises InputError where all are 0."""
    if not any(weights.values()):
        raise InputError("nothing matters any more, so any painting would do; move one of the sliders up")
    return weights


class PlanWeights(ui.expansion):
    """Sliders whose weights a plan takes while it is made."""

    def __init__(self, studio: Studio, plan: Plan) -> None:
        super().__init__("What matters")
        self._studio, self._plan, self._shown_weights = studio, plan, plan.request.options.weights
        terms = (
            *(PICTURE_TERMS if plan.request.picture is not None else ()),
            *(("text",) if plan.request.options.text else ()),
        )
        usual = {"tone": 1.0, "text": 1.0}
        with self:
            weights = {name: plan.request.options.weights.get(name, usual.get(name, 0.0)) for name in terms}
            self._sliders = weight_sliders(weights, self._weigh)

    def follow(self) -> None:
        """Show the plan's present weights, which another page may have changed."""
        weights = self._plan.request.options.weights
        if weights is self._shown_weights:  # or a slider would slip from under a person's finger
            return
        self._shown_weights = weights
        for name, slider in self._sliders.items():
            slider.set(weights.get(name, slider.value))

    def _weigh(self) -> None:
        weights = check_weights({name: slider.value for name, slider in self._sliders.items()})
        self._studio.plans.weigh(self._plan, weights)
