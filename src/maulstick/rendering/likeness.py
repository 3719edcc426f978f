"""How near a painting comes to a picture, over the picture's area."""

from maulstick.painting.edit import PictureEdit
from maulstick.painting.fit import lay_out
from maulstick.painting.metrics import Metrics, compare
from maulstick.painting.painting import Painting
from maulstick.painting.raster import Canvas
from maulstick.rendering.preview import truth
from maulstick.storage.arrays import Image

_PX, _WIDEST_PX = 512, 4096  # height of the sheet, enough for what an eye sees of it, and its width at most


def measured_canvas(painting: Painting) -> Canvas:
    """Return the canvas that paintings are measured on."""
    width, height = painting.sheet.width, painting.sheet.height
    return Canvas(width, height, min(_PX / height, _WIDEST_PX / width))


def likeness(painting: Painting, picture: Image) -> Metrics:
    """Return the metrics of the painting against the picture (H, W, 3), sRGB in [0, 1], over the picture's area.

    The picture is the one that was planned, and is corrected as it was then, by the options in the provenance.
    They are taken at the truth: see `maulstick.rendering.preview.truth`.
    """
    canvas = measured_canvas(painting)
    left, top, right, bottom = (
        round(metres * canvas.pixels_per_metre)
        for metres in (
            *painting.area[:2],
            painting.area[0] + painting.area[2],
            painting.area[1] + painting.area[3],
        )
    )
    painted = truth(painting, canvas)[top : max(bottom, top + 1), left : max(right, left + 1)]
    height, width = painted.shape[:2]
    area = Canvas(width / canvas.pixels_per_metre, height / canvas.pixels_per_metre, canvas.pixels_per_metre)
    return compare(painted, lay_out(PictureEdit.of(painting.provenance.options).applied(picture), area, "cover")[0])
