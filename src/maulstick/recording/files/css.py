"""Properties by which SVG elements are drawn, as CSS names them, and what their values mean."""

import re
from collections.abc import Mapping
from functools import cache
from typing import Final

from tinycss2.color4 import parse_color  # type: ignore[import-untyped]

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

MOVES: Final = frozenset({"rotate", "scale", "translate"})
"""Properties that move an element, beside `transform`, and that no attribute says."""

GEOMETRY: Final = frozenset({"cx", "cy", "d", "height", "r", "rx", "ry", "width", "x", "y"})
"""Properties that are read from attributes alone, but for the size of the page."""

_URL = re.compile(r"url\(\s*['\"]?#([^'\")]*)['\"]?\s*\)(.*)")
_PROFILE = re.compile(r" icc-color\(.*")  # beside the colour for who has none
_NO_COLOUR = frozenset({"none", "context-fill", "context-stroke"})
_INITIAL = frozenset({"initial", "revert", ""})
_BLACK = (0.0, 0.0, 0.0)

Rgb = tuple[float, float, float]
"""Colour in sRGB, [0, 1]."""


def inherited(style: Style, own: Style) -> Style:
    """Return the style of an element in which its own properties count before those of its parents."""
    return {**style, **{name: own[name] for name in INHERITED if name in own}} if own else style


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
    """Return the colour of a fill or stroke as the file has it, where it is seen, and of a form that is not read."""
    value = _value(style, name, "none")
    try:
        _parsed(value)
    except ValueError:
        return None if is_zero(style.get(f"{name}-opacity")) else value
    return None


def _value(style: Style, name: str, otherwise: str) -> str:
    value = style.get(name, otherwise).strip()
    if value.lower() == "currentcolor":
        return style.get("color", "black").strip()
    return otherwise if value.lower() in _INITIAL else value


def is_zero(opacity: str | None) -> bool:
    """Return whether an opacity is that of what cannot be seen."""
    try:
        return opacity is not None and float(opacity.rstrip("%")) == 0
    except ValueError:
        return False


@cache
def _parsed(value: str) -> Rgb | None:
    """Return a colour, None where nothing is seen. Raises ValueError for a form that is not read."""
    if (match := _URL.match(value)) is not None:
        return _parsed(match[2].strip()) if match[2].strip() else _BLACK
    if value.lower() in _NO_COLOUR:
        return None
    colour = parse_color(_PROFILE.sub("", value))
    if colour is None or isinstance(colour, str):  # the name of another colour
        raise ValueError(value)
    try:
        red, green, blue = (round(255 * min(max(x, 0.0), 1.0)) / 255 for x in colour.to("srgb").coordinates)
    except NotImplementedError as error:
        raise ValueError(value) from error
    return None if colour.alpha == 0 else (red, green, blue)
