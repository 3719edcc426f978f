"""Sketch of a sheet with its picture, before anything is planned: drawn by what lays pictures out for plans."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from maulstick.painting.edit import PictureEdit
from maulstick.painting.fit import lay_out
from maulstick.painting.picture import encode_jpeg, read_picture
from maulstick.painting.raster import Canvas, parse_margin, parse_size
from maulstick.storage.arrays import Pixels

_LONGEST_PX = 480  # of the sheet: as fine as the thumbnail that is laid on it
_NONE = 5e-4  # metres of bare paper that nobody sees
_NO_CUT = 0.01  # share of a picture that pixels round off


@dataclass(frozen=True)
class Sketch:
    """Pictures for the form, JPEGs: the picture as it is turned and toned, before it is cut; and the sheet with it.

    told: how large the sheet is, where it stays bare, and what of the picture is cut off.
    ratio: of width to height of the sheet inside its margin, in shares of the picture's.
    """

    picture: bytes
    sheet: bytes
    told: str
    ratio: float


def sketch(thumbnail: Path, edit: PictureEdit, size: str, fit: str, margin: str) -> Sketch:
    """Return the sketch of a picture; size, fit and margin are those of `PlanOptions`.

    Raises InputError where the picture cannot be read, and for a size or a margin that cannot be.
    """
    whole = edit.toned(edit.turned(read_picture(thumbnail)))
    picture = edit.cut(whole)
    width, height = parse_size(size)
    inset = parse_margin(margin, (width, height))
    canvas = Canvas(width, height, _LONGEST_PX / max(width, height))
    laid, area = lay_out(picture, canvas, fit, margin=inset)
    ratio = (width - 2 * inset) / (height - 2 * inset) * whole.shape[0] / whole.shape[1]
    return Sketch(encode_jpeg(whole), encode_jpeg(laid), _told(picture, (width, height), area), ratio)


def _told(picture: Pixels, sheet: tuple[float, float], area: tuple[float, float, float, float]) -> str:
    """Return sentences on the sheet (width, height) with a picture (h, w, 3) in an area, metres."""
    said = [f"A sheet of {1e3 * sheet[0]:g} by {1e3 * sheet[1]:g} mm."]
    beside, above = ((side - taken) / 2 for side, taken in zip(sheet, area[2:], strict=True))
    if np.isclose(beside, above, atol=_NONE) and beside > _NONE:
        said.append(f"{1e3 * beside:.0f} mm of bare paper all around.")
    else:
        ways = {"left and right": beside, "above and below": above}
        bare = [f"{1e3 * wide:.0f} mm {way}" for way, wide in ways.items() if wide > _NONE]
        said += [f"Bare paper: {', '.join(bare)}."] if bare else []
    stretch = area[2] / area[3] * picture.shape[0] / picture.shape[1]
    cut = 1 - min(stretch, 1 / stretch)
    if cut > _NO_CUT:
        ends = ("above", "below") if stretch > 1 else ("left", "right")
        said.append(f"{cut:.0%} of the picture is cut off, half of it {ends[0]}, half {ends[1]}.")
    return " ".join(said)
