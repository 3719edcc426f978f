"""Weights of the terms of a plan's loss, as a person sets them."""

from collections.abc import Mapping

from maulstick.errors import InputError
from maulstick.jobs.plan.request import PlanRequest

TERM_LABELS = {
    "tone": "Light and dark",
    "edges": "Outlines",
    "likeness": "What can be recognised",
    "sketch": "Like a sketch of it",
    "text": "The words",
}
"""Labels of the terms, by name."""

PICTURE_TERMS = ("tone", "edges", "likeness", "sketch")
"""Names of the terms that compare the canvas with a picture."""

_USUAL = {"tone": 1.0, "text": 1.0}


def weights_of(request: PlanRequest) -> dict[str, float]:
    """Return the weights of all terms that a plan can have, by name, the usual ones where it names none."""
    picture = PICTURE_TERMS if request.picture is not None else ()
    terms = (*picture, "text") if request.options.text else picture
    return {name: request.options.weights.get(name, _USUAL.get(name, 0.0)) for name in terms}


def check_weights(weights: dict[str, float]) -> dict[str, float]:
    """Return the weights as they are. Raises InputError where all are 0."""
    if not any(weights.values()):
        raise InputError("nothing matters any more, so any painting would do; move one of the sliders up")
    return weights


def weights_in_words(before: Mapping[str, float], now: Mapping[str, float]) -> str:
    """Return the weights that are others than before: ``“Outlines” at 1.5 instead of 0``."""
    changed = [name for name in now if now[name] != before.get(name, 0.0)]
    return ", ".join(f"“{TERM_LABELS[name]}” at {now[name]:g} instead of {before.get(name, 0.0):g}" for name in changed)
