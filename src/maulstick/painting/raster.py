"""Canvases: size in metres, resolution, and the only conversion between metres and pixels."""

import re
from dataclasses import dataclass
from typing import Self

from maulstick.errors import InputError

_UNITS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 25.4e-3}  # metres
_PAPERS = {  # portrait, millimetres (ISO 216; US letter)
    "A2": (420, 594),
    "A3": (297, 420),
    "A4": (210, 297),
    "A5": (148, 210),
    "A6": (105, 148),
    "LETTER": (215.9, 279.4),
}
_SMALLEST, _LARGEST = 5e-3, 100.0  # metres a side; anything else is a mistake in the units

FINE, MOST_PX = 5000, 2048
"""Resolution of a rectified photograph of a sheet in pixels per metre, and the most pixels on its longer side."""


@dataclass(frozen=True)
class Canvas:
    """A sheet with square pixels, origin at its upper left corner, x to the right, y down.

    width, height: metres.  pixels_per_metre: resolution in both directions.
    """

    width: float
    height: float
    pixels_per_metre: float

    @classmethod
    def of_height(cls, size: tuple[float, float], height_px: int) -> Self:
        """Return a canvas of `size` (width, height), metres, that is `height_px` pixels high.

        Raises InputError where `height_px` is below 1.
        """
        if height_px < 1:
            raise InputError.of_range("the height in pixels", height_px, "at least 1")
        return cls(size[0], size[1], height_px / size[1])

    @property
    def width_px(self) -> int:
        """Width in whole pixels, at least 1."""
        return max(1, round(self.width * self.pixels_per_metre))

    @property
    def height_px(self) -> int:
        """Height in whole pixels, at least 1."""
        return max(1, round(self.height * self.pixels_per_metre))


def flat_canvas(width: float, height: float) -> Canvas:
    """Return the canvas for a rectified photograph of a sheet of that size, metres."""
    return Canvas(width, height, min(FINE, MOST_PX / max(width, height)))


def parse_length(text: str) -> float:
    """Return metres from a length with its unit, as in ``139mm``, ``13.9cm`` or ``5.5in``. Raises InputError."""
    match = re.fullmatch(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*(mm|cm|m|in)\s*", text)
    if match is None:
        raise InputError(f"{text!r} is not a length; write a number and a unit, as in 139mm, 13.9cm or 5.5in")
    return float(match[1]) * _UNITS[match[2]]


def parse_size(text: str) -> tuple[float, float]:
    """Return (width, height) in metres from ``200x160mm``, ``8x10in``, ``A4``, ``A4-landscape``. Raises InputError."""
    name, _, turn = text.strip().upper().partition("-")
    if name in _PAPERS and turn in ("", "PORTRAIT", "LANDSCAPE"):
        short, long = (x * 1e-3 for x in _PAPERS[name])
        return (long, short) if turn == "LANDSCAPE" else (short, long)
    number = r"(\d+(?:\.\d*)?|\.\d+)"
    match = re.fullmatch(rf"\s*{number}\s*[x\u00d7]\s*{number}\s*(mm|cm|m|in)\s*", text)
    if match is None:
        papers = ", ".join(_PAPERS)
        raise InputError(
            f"{text!r} is not a size; write width x height and a unit, as in 200x160mm, or one of {papers}"
        )
    width, height = (float(x) * _UNITS[match[3]] for x in match.group(1, 2))
    for side in (width, height):
        if not _SMALLEST <= side <= _LARGEST:
            raise InputError.of_range("a side of the canvas", f"{side * 1e3:g} mm", "between 5 mm and 100 m")
    return width, height
