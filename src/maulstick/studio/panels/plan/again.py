"""Values of the form for a plan that is to be planned again."""

from collections.abc import Mapping
from typing import Any

from maulstick.jobs.plan.options import AUTO, PlanOptions


def values_of(options: PlanOptions, first: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of the form's fields by their keys. first: those of a new form, for what was not asked for."""
    takes_enough = options.strokes == AUTO
    return {
        **first,
        "text": options.text or "",
        "hand_size": options.hand_size,
        "brush": options.brush,
        "size": options.size,
        "kind": "paints" if options.ink is None else "ink",
        "paints": options.mixed_paints or first["paints"],
        "ink": options.ink or first["ink"],
        "strokes": first["strokes"] if takes_enough else options.strokes,
        "enough": takes_enough,
        "drawing": options.drawing,
        "effort": options.steps,
    }
