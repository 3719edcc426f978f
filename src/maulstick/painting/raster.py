"""Canvases: size in metres, resolution, and the only conversion between metres and pixels."""

import re
from dataclasses import dataclass, replace
from typing import Self

from maulstick.errors import InputError, option

_UNITS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 25.4e-3}  # metres
_PAPERS = {  # portrait, millimetres (ISO 216; US letter)
    "A2": (420, 594),
    "A3": (297, 420),
    "A4": (210, 297),
    "A5": (148, 210),
    "A6": (105, 148),
    "LETTER": (215.9, 279.4),
}
_LARGEST = 100.0  # metres a side; more is a mistake in the units

_AUTO = "-auto"  # after a size: turned as the picture that is painted on it

SMALLEST = 5e-3
"""Least side of a canvas in metres; less is a mistake in the units."""

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

    def inset(self, margin: float) -> Self:
        """Return the canvas of what a margin on all sides leaves of this one, metres."""
        return replace(self, width=self.width - 2 * margin, height=self.height - 2 * margin)

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


def parse_margin(text: str, size: tuple[float, float]) -> float:
    """Return metres of a margin with its unit, as in ``10mm``, around a sheet of this size (width, height), metres.

    Raises InputError where it is no length, or leaves less than 5 mm of the sheet.
    """
    margin = parse_length(text)
    most = max((min(size) - SMALLEST) / 2, 0.0)
    if margin > most:
        sheet = f"{1e3 * size[0]:g} x {1e3 * size[1]:g} mm"
        raise InputError.of_range(option("margin"), text, f"at most {1e3 * most:g}mm on a sheet of {sheet}")
    return margin


def parse_length(text: str) -> float:
    """Return metres from a length with its unit, as in ``139mm``, ``13.9cm`` or ``5.5in``. Raises InputError."""
    match = re.fullmatch(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*(mm|cm|m|in)\s*", text)
    if match is None:
        raise InputError(f"{text!r} is not a length; write a number and a unit, as in 139mm, 13.9cm or 5.5in")
    return float(match[1]) * _UNITS[match[2]]


def parse_size(text: str, longest: float = _LARGEST) -> tuple[float, float]:
    """Return (width, height) in metres from ``200x160mm``, ``8 by 10 in``, ``A4``, ``A4-landscape``. Raises InputError.

    Any size may be turned: ``200x160mm-portrait``.  longest: metres of a side, at most.
    """
    size, _, turn = text.strip().upper().partition("-")
    if size in _PAPERS:
        width, height = (x * 1e-3 for x in _PAPERS[size])
    else:
        width, height = _sides(size, text, longest)
    if turn not in ("", "PORTRAIT", "LANDSCAPE"):
        raise _no_size(text)
    if turn:
        short, long = sorted((width, height))
        return (short, long) if turn == "PORTRAIT" else (long, short)
    return width, height


def parse_sheet(text: str, picture: tuple[int, ...] | None) -> tuple[float, float]:
    """Return (width, height) in metres of a size, as `parse_size`, or one as ``A4-auto``. Raises InputError.

    That one stands where a picture of this shape (h, w, ...) stands, lies where it lies, and is as it was said for a
    square picture, or none.
    """
    width, height = parse_size(size_of(text))
    if not is_turned_by_picture(text) or picture is None or picture[0] == picture[1]:
        return width, height
    short, long = sorted((width, height))
    return (short, long) if picture[0] > picture[1] else (long, short)


def is_turned_by_picture(text: str) -> bool:
    """Return whether a size ends in ``-auto``, so that the sheet is turned as the picture."""
    return text.strip().lower().endswith(_AUTO)


def size_of(text: str) -> str:
    """Return a size as for `parse_size` of one as for `parse_sheet`."""
    return text.strip()[: -len(_AUTO)] if is_turned_by_picture(text) else text


def _sides(size: str, text: str, longest: float) -> tuple[float, float]:
    """Return width and height in metres of upper-case letters as ``200X160MM``. Raises InputError, naming the text."""
    number = r"(\d+(?:\.\d*)?|\.\d+)"
    match = re.fullmatch(rf"\s*{number}\s*(?:[X\u00d7]|BY)\s*{number}\s*(MM|CM|M|IN)\s*", size)
    if match is None:
        raise _no_size(text)
    width, height = (float(x) * _UNITS[match[3].lower()] for x in match.group(1, 2))
    for side in (width, height):
        if not SMALLEST <= side <= longest:
            allowed = f"between {1e3 * SMALLEST:g} mm and {longest:g} m"
            raise InputError.of_range("a side of the canvas", f"{side * 1e3:g} mm", allowed)
    return width, height


def _no_size(text: str) -> InputError:
    papers = ", ".join(_PAPERS)
    return InputError(f"{text!r} is not a size; write width x height and a unit, as in 200x160mm, or one of {papers}")
