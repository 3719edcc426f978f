"""Layout: where a picture lies on its sheet, and at which resolution it is planned."""

from dataclasses import dataclass
from functools import cached_property

from maulstick.errors import InputError
from maulstick.painting.brush import Brush
from maulstick.painting.fit import lay_out
from maulstick.painting.painting import Sheet
from maulstick.painting.raster import Canvas
from maulstick.planning.attention import Face, find_faces
from maulstick.planning.room import Room, room_of
from maulstick.storage.arrays import Image

HEIGHT_PX = 256
"""Least pixels over a picture's height by default: shows the detail that a usual brush can paint on a usual sheet."""

LONGEST_PX = 2048
"""Longest side of a canvas that is planned in one piece by default; larger ones are planned in windows."""

_MOST_PX = 6144  # longest side in one piece at all, since memory grows with the square of it
_MOST_IN_WINDOWS_PX = 32_768  # longest side in windows: at most 32 by 32 of them, which bounds the time


@dataclass(frozen=True)
class Layout:
    """A picture on a sheet.

    under: (H, W, 3), the sheet as it is.  target: (H, W, 3), as it should be, or None where there is no picture.
    area: (x, y, width, height) of the picture on the sheet, metres.
    room: left, top, right and lower edge, metres, of what ink must not leave, None for the whole sheet.
    """

    canvas: Canvas
    sheet: Sheet
    under: Image
    target: Image | None
    area: tuple[float, float, float, float]
    room: Room | None = None

    def crop(self, image: Image) -> Image:
        """Return the part of an image of the canvas, (H, W, 3), that the picture covers, as a view of it."""
        left, top, width, height = (round(x * self.canvas.pixels_per_metre) for x in self.area)
        return image[top : top + max(height, 1), left : left + max(width, 1)]

    @cached_property
    def faces(self) -> tuple[Face, ...]:
        """The faces in the picture, in pixels of the part that `crop` returns. Looking for them takes a while."""
        return () if self.target is None else tuple(find_faces(self.crop(self.target)))


def lay_out_for(
    picture: Image | None,
    sheet: Sheet,
    brush: Brush,
    fit: str = "contain",
    height_px: int | None = None,
    margin: float = 0.0,
) -> Layout:
    """Lay out a picture (h, w, 3), or none, on a sheet, at the resolution to plan it in: see `canvas_for`.

    margin: metres at each edge of the sheet; with one, no ink may leave the picture's area.
    Raises InputError for a sheet that is too narrow or too large in pixels.
    """
    canvas = canvas_for(picture, sheet, brush, fit, height_px, margin)
    if (longest := max(canvas.width_px, canvas.height_px)) > _MOST_PX:
        raise InputError.of_range("the canvas", f"{longest} pixels long", f"at most {_MOST_PX} in one piece")
    under = sheet.image(canvas)
    if picture is None:
        target, area = None, (margin, margin, sheet.width - 2 * margin, sheet.height - 2 * margin)
    else:
        target, area = lay_out(picture, canvas, fit, under, margin)
    return Layout(canvas, sheet, under, target, area, room_of(area) if margin else None)


def pixel_size(picture: Image, sheet: Sheet, fit: str, margin: float = 0.0) -> float:
    """Return the side of a pixel of the picture (h, w, 3) on the sheet, metres."""
    sides = (sheet.height - 2 * margin) / picture.shape[0], (sheet.width - 2 * margin) / picture.shape[1]
    return float(max(sides) if fit == "cover" else min(sides))


def canvas_for(
    picture: Image | None,
    sheet: Sheet,
    brush: Brush,
    fit: str = "contain",
    height_px: int | None = None,
    margin: float = 0.0,
) -> Canvas:
    """Return the sheet's canvas at the resolution to plan a picture (h, w, 3) in.

    height_px: pixels over the height of the picture, or without one of the sheet; when left out, at least 256 and as
    many as show the brush's thinnest mark with a half-width of a pixel, while no side of the canvas exceeds 2048.
    Raises InputError for a sheet that is too narrow or too large in pixels.
    """
    height = sheet.height
    if picture is not None:
        height = min(picture.shape[0] * pixel_size(picture, sheet, fit, margin), sheet.height - 2 * margin)
    longest = max(sheet.width, sheet.height)
    if height_px is None:
        resolution = min(max(HEIGHT_PX / height, 1 / brush.finest), LONGEST_PX / longest)
    elif height_px < 1:
        raise InputError.of_range("the height of the picture", f"{height_px} pixels", "at least 1")
    else:
        resolution = height_px / height
    if resolution * longest > _MOST_IN_WINDOWS_PX:
        allowed = f"less, so that no side of the sheet has more than {_MOST_IN_WINDOWS_PX}"
        raise InputError.of_range("the height of the picture", f"{height_px} pixels", allowed)
    canvas = Canvas(sheet.width, sheet.height, resolution)
    if min(canvas.width_px, canvas.height_px) < 2:
        pixels = f"{canvas.width_px} x {canvas.height_px}"
        raise InputError.of_range("the sheet in pixels", pixels, "at least 2 x 2; choose a less narrow size")
    return canvas
