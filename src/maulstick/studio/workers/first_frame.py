"""Picture of a painting at once, without PyTorch: each stroke as a line of its mean width."""

import numpy as np
from PIL import Image, ImageDraw

from maulstick.painting.painting import Painting, hex_colour
from maulstick.painting.picture import encode_jpeg
from maulstick.painting.raster import Canvas
from maulstick.painting.refined import refined

_PX, _FINER = (
    640,
    2,
)  # pixels of the longer side, as of pictures of the order; drawn so many times larger, for its edges


def first_frame(painting: Painting) -> bytes:
    """Return a JPEG of a painting."""
    painting, sheet = refined(painting), painting.sheet
    canvas = Canvas(sheet.width, sheet.height, _FINER * _PX / max(sheet.width, sheet.height))
    picture = Image.fromarray(np.uint8(255 * sheet.image(canvas)))
    draw = ImageDraw.Draw(picture)
    for stroke in painting.strokes:
        paint = painting.paints[stroke.paint]
        points, widths, _ = painting.brushes[paint.brush].bare_mark(np.array(stroke.trajectory, dtype=np.float64))
        line = points * canvas.pixels_per_metre
        wide = max(2 * float(widths.clip(min=0).mean()) * canvas.pixels_per_metre, 1.0)
        colour = hex_colour(paint.colour)
        draw.line([tuple(each) for each in line.tolist()], colour, round(wide))
        for x, y in line:  # Pillow's own joints leave notches where points are close together
            draw.ellipse((x - wide / 2, y - wide / 2, x + wide / 2, y + wide / 2), colour)
    return encode_jpeg(np.asarray(picture.reduce(_FINER), dtype=np.float32) / np.float32(255))
