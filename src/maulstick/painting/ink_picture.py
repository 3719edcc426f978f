"""Picture of ink: the drawing as it was recorded, and nothing beside it."""

import numpy as np
from PIL import Image as Pillow
from PIL import ImageDraw

from maulstick.storage.arrays import Image
from maulstick.strokes.ink import Ink

_FINER = 3  # times larger it is drawn before it is scaled down, against jagged edges
_LINE = 0.5e-3  # metres: width of a stroke
_PAPER, _LINE_COLOUR = 255, 30  # greys, of 255


def ink_picture(ink: Ink, longest_px: int) -> Image:
    """Draw the ink on its sheet, (H, W, 3), sRGB in [0, 1]. longest_px: pixels of the longer side."""
    scale = longest_px / max(ink.size)
    width, height = (max(1, round(scale * side)) for side in ink.size)
    picture = Pillow.new("L", (_FINER * width, _FINER * height), _PAPER)
    draw = ImageDraw.Draw(picture)
    line = max(round(_FINER * scale * _LINE), _FINER)
    for stroke in ink.strokes():
        places = [(x, y) for x, y in (_FINER * scale * stroke[:, 1:3]).tolist()]
        draw.line(places, _LINE_COLOUR, line, joint="curve")
        draw.circle(places[0], line / 2, _LINE_COLOUR)  # a dot has no length
    grey = np.asarray(picture.resize((width, height), Pillow.Resampling.BOX), dtype=np.float32) / 255
    return np.repeat(grey[..., None], 3, axis=2)
