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
_FUNCTION = re.compile(r"(rgb|hsl)a?\((.*)\)", re.IGNORECASE)
_BETWEEN = re.compile(r"[\s,/]+")  # numbers of a function, as of today and before
_BLACK = (0.0, 0.0, 0.0)
_SAID_BLACK = re.compile(r"|black|#.*|(?:rgb|hsl)a?\(.*", re.IGNORECASE | re.DOTALL)

Rgb = tuple[float, float, float]
"""Colour in sRGB, [0, 1]."""


def referred(value: str | None) -> str | None:
    """Return the id that a property such as ``url(#clip)`` refers to, or None."""
    match = _URL.match((value or "").strip())
    return None if match is None else match[1]


def colour_of(style: Style, name: str, otherwise: str) -> Rgb | None:
    """Return the colour of a fill or stroke, None where there is none.

    A gradient or pattern counts as black, and so does what is `unread`.
    """
    if is_zero(style.get(f"{name}-opacity")):
        return None
    try:
        return _parsed(_value(style, name, otherwise))
    except ValueError:
        return _BLACK


def unread(style: Style, name: str) -> str | None:
    """Return the colour of a fill or stroke as it stands in the file, where it is of a form that is not read."""
    value = _value(style, name, "none")
    try:
        _parsed(value)
    except ValueError:
        return value
    return None


def _value(style: Style, name: str, otherwise: str) -> str:
    value = style.get(name, otherwise).strip()
    return style.get("color", "black").strip() if value.lower() == "currentcolor" else value


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
        colour = Color(_plain(value))
    except (TypeError, IndexError) as error:
        raise ValueError(value) from error
    if colour.value is None or colour.alpha == 0:
        return None
    rgb = colour.red / 255, colour.green / 255, colour.blue / 255
    if rgb == _BLACK and _SAID_BLACK.fullmatch(value) is None:  # as svgelements has all that it does not know
        raise ValueError(value)
    return rgb


def _plain(value: str) -> str:
    """Return a colour in a form that svgelements reads: commas, whole numbers of RGB, and no opacity but 0."""
    value = value.partition(" icc-color(")[0]
    if (function := _FUNCTION.fullmatch(value)) is None:
        return value
    name, numbers = function[1].lower(), _BETWEEN.split(function[2].strip())
    if name == "rgb":
        numbers[:3] = [each if each.endswith("%") else f"{float(each):.0f}" for each in numbers[:3]]
    else:
        numbers[0] = numbers[0].removesuffix("deg")
    return f"{name}a({','.join(numbers[:3])},{0 if is_zero(''.join(numbers[3:]) or None) else 1})"
