"""Lengths of CSS in pixels."""

import re
from dataclasses import dataclass
from math import hypot
from typing import Final
from xml.etree.ElementTree import Element

from maulstick.recording.files.markup import METRES

FONT_UNITS: Final = {"em": 16.0, "rem": 16.0, "ex": 8.0, "ch": 8.0}
"""Pixels of a usual font, whatever the document's: a drawing has no text."""

_LENGTH = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([a-zA-Z]+|%|)\s*")


def pixels(text: str | None, whole: float = 0.0) -> float | None:
    """Return a length in pixels, 96 per inch, or None where it is none; a percentage is of `whole`."""
    match = _LENGTH.fullmatch(text or "")
    if match is None:
        return None
    number, unit = float(match[1]), match[2].lower()
    if unit == "%":
        return number / 100 * whole
    if unit in FONT_UNITS:
        return number * FONT_UNITS[unit]
    return number * METRES[unit or "px"] / METRES["px"] if unit in (*METRES, "") else None


def page_side(text: str | None) -> float | None:
    """Return a side of the page in pixels, or None where it is no length, or of a whole that a page has not."""
    return None if (text or "").strip().endswith("%") else pixels(text)


@dataclass(frozen=True)
class Viewport:
    """Viewport whose width and height, in user units, percentages are taken of."""

    width: float
    height: float

    def x(self, element: Element, name: str, otherwise: str = "0") -> float:
        """Return an attribute that is a length along x, in user units; `otherwise` where it is none."""
        return _length(element.get(name), otherwise, self.width)

    def y(self, element: Element, name: str, otherwise: str = "0") -> float:
        """Return an attribute that is a length along y, in user units; `otherwise` where it is none."""
        return _length(element.get(name), otherwise, self.height)

    def other(self, text: str | None) -> float:
        """Return a length along neither, as a radius is, in user units."""
        return pixels(text, hypot(self.width, self.height) / 2**0.5) or 0.0

    def radii(self, element: Element) -> tuple[float, float]:
        """Return the radii along x and y, in user units; one that is not given, or below 0, is the other."""
        along = pixels(element.get("rx"), self.width), pixels(element.get("ry"), self.height)
        rx, ry = (None if radius is None or radius < 0 else radius for radius in along)
        return (ry or 0.0) if rx is None else rx, (rx or 0.0) if ry is None else ry


def _length(text: str | None, otherwise: str, whole: float) -> float:
    found = pixels(text, whole)
    return (pixels(otherwise, whole) or 0.0) if found is None else found
