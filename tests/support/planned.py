"""A picture that is planned in a second: a dark disc and a red corner on white, in 24 strokes of loops."""

from functools import cache

import numpy as np

from maulstick.painting.painting import Painting, Sheet
from maulstick.planning.from_picture import as_painting, problem_of, provenance_of
from maulstick.planning.layout import lay_out_for
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings
from maulstick.storage.arrays import Image
from maulstick.style import load_style
from tests.support.nominal import nominal

SIDE, PIXELS, STROKES, STEPS = 0.06, 48, 24, 40


def picture() -> Image:
    """The picture, (PIXELS, PIXELS, 3), sRGB in [0, 1]."""
    down, across = np.mgrid[:PIXELS, :PIXELS] / PIXELS
    image = np.ones((PIXELS, PIXELS, 3), dtype=np.float32)
    image[np.hypot(down - 0.4, across - 0.35) < 0.28] = 0.05
    image[(down > 0.6) & (across > 0.6)] = (0.8, 0.1, 0.1)
    return image


@cache
def planned() -> Painting:
    """Return the planned painting, for the nominal marker."""
    sheet, brush = Sheet(width=SIDE, height=SIDE), nominal("marker")
    layout = lay_out_for(picture(), sheet, brush, "contain", PIXELS)
    style = load_style("loops", layout.canvas)
    options = PlannerSettings(STROKES, exact=True, paints=2, steps=STEPS)
    provenance = provenance_of(
        options, more={"style": "loops", "fit": "contain", "px": PIXELS, "weights": {"tone": 1.0}}
    )
    return as_painting(plan(problem_of(layout, (brush,), style, options), options), layout, (brush,), style, provenance)
