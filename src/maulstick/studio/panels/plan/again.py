"""Values of the form for a plan that is to be planned again."""

from typing import Any

from maulstick.jobs.plan.options import AUTO, PlanOptions
from maulstick.jobs.plan.request import PlanRequest
from maulstick.painting.raster import parse_length, parse_size, size_of
from maulstick.robot.machines import kind_of
from maulstick.studio.panels.plan.sheet import OWN
from maulstick.studio.state.settings import Choices
from maulstick.studio.wording import PLANNED_FOR


def values_of(request: PlanRequest) -> dict[str, Any]:
    """Return the values of the form's fields by their keys; the usual ones for what was not asked for."""
    options = request.options
    usual, takes_enough = Choices().model_dump(), options.strokes == AUTO
    width, height = parse_size(size_of(options.size))
    machine = kind_of(options.robot or "")
    return {
        **usual,
        "text": options.text or "",
        "machine": machine if machine in PLANNED_FOR else "",
        "style": options.style,
        "hand_size": options.hand_size,
        "brush": options.brush,
        "size": OWN,
        "own_size": size_of(options.size),
        "turned": "lying" if width > height else "standing",
        "fit": options.fit,
        "margin": 1e3 * parse_length(options.margin),
        "kind": "paints" if options.ink is None else "ink",
        "paints": options.mixed_paints or usual["paints"],
        "ink": options.inks[0] if options.inks else usual["ink"],
        "more_inks": list(options.inks[1:]),
        "strokes": usual["strokes"] if takes_enough else options.strokes,
        "enough": takes_enough,
        "drawing": options.drawing,
        "weights": options.weights or usual["weights"],
        "arrange": options.arrange,
        "effort": options.steps,
        "paper": usual["paper"] if options.paper == PlanOptions().paper else options.paper,
        "unmixed": options.paints_from is not None,
        "tries": request.tries,
    }
