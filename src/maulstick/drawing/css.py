"""Properties by which SVG elements are drawn, as CSS names them, and what their values mean."""

import re
from collections.abc import Mapping
from functools import cache
from typing import Final

from svgelements import Color  # type: ignore[import-untyped]

Style = Mapping[str, str]

INHERITED: Final = (
    "clip-rule",
    "color",
    "fill",
    "fill-opacity",
    "fill-rule",
    "stroke",
    "stroke-dasharray",
    "stroke-opacity",
    "stroke-width",
    "visibility",
)
"""Properties that children have from their parents."""

READ: Final = (
    *INHERITED,
    "clip-path",
    "display",
    "marker-end",
    "marker-mid",
    "marker-start",
    "mask",
    "opacity",
    "overflow",
    "transform",
    "transform-box",
    "transform-origin",
)
"""Properties that are read, these among them."""

GEOMETRY: Final = frozenset({"cx", "cy", "d", "height", "r", "rx", "ry", "width", "x", "y"})
"""Properties that are read from attributes alone, but for the size of the page."""

_URL = re.compile(r"url\(\s*['\"]?#([^'\")]*)['\"]?\s*\)(.*)")
_BLACK = (0.0, 0.0, 0.0)

Rgb = tuple[float, float, float]
"""Colour in sRGB, [0, 1]."""


def referred(value: str | None) -> str | None:
    """Return the id that a property such as ``url(#clip)`` refers to, or None."""
    match = _URL.match((value or "").strip())
    return None if match is None else match[1]


def colour_of(style: Style, name: str, otherwise: str) -> Rgb | None:
    """Return the colour of a fill or stroke, None where there is none. A gradient or pattern counts as black."""
    value = style.get(name, otherwise).strip()
    if value.lower() == "currentcolor":
        value = style.get("color", "black")
    if is_zero(style.get(f"{name}-opacity")):
        return None
    return _parsed(value)


def is_zero(opacity: str | None) -> bool:
    """Return whether an opacity is that of what cannot be seen."""
    try:
        return opacity is not None and float(opacity.rstrip("%")) == 0
    except ValueError:
        return False


@cache
def _parsed(value: str) -> Rgb | None:
    if (match := _URL.match(value)) is not None:
        return _parsed(match[2].strip()) if match[2].strip() else _BLACK
    if value.lower() in ("none", "transparent", "context-fill", "context-stroke"):
        return None
    try:
        colour = Color(value)
    except (ValueError, TypeError, IndexError):
        return _BLACK
    if colour.value is None or colour.alpha == 0:
        return None
    return colour.red / 255, colour.green / 255, colour.blue / 255
