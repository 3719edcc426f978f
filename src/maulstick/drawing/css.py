"""Style of SVG elements: presentation attributes, style sheets of simple selectors, and style attributes."""

import re
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Final
from xml.etree.ElementTree import Element

from svgelements import Color  # type: ignore[import-untyped]

from maulstick.recording.files.markup import local_name

Style = Mapping[str, str]

INHERITED: Final = (
    "clip-rule",
    "color",
    "fill",
    "fill-opacity",
    "fill-rule",
    "stroke",
    "stroke-opacity",
    "stroke-width",
    "visibility",
)
"""Properties that children have from their parents."""

_OWN = (
    "clip-path",
    "display",
    "marker-end",
    "marker-mid",
    "marker-start",
    "mask",
    "overflow",
    "transform",
    "transform-box",
    "transform-origin",
)
_NAMES = (*INHERITED, *_OWN)
_COMMENT = re.compile(r"/\*.*?\*/|<!--|-->", re.DOTALL)
_BRACE = re.compile(r"([^{}]*)([{}])")
_SIMPLE = re.compile(r"(\*|[\w-]*)([.#]?)([\w-]*)")  # tag, .class, #id, tag.class, tag#id
_URL = re.compile(r"url\(\s*['\"]?#([^'\")]*)['\"]?\s*\)(.*)")
_BLACK = (0.0, 0.0, 0.0)

Rgb = tuple[float, float, float]
"""Colour in sRGB, [0, 1]."""


class StyleSheet:
    """Rules of all style sheets in a document, of which the simple selectors count: tag, .class, #id, tag.class."""

    def __init__(self, root: Element) -> None:
        self._rules: dict[tuple[str, str, str], dict[str, str]] = {}
        for element in root.iter():
            if isinstance(element.tag, str) and local_name(element) == "style" and _on_screen(element.get("media", "")):
                for selectors, body in _rules(_COMMENT.sub("", element.text or "")):
                    self._add(selectors, _declared(body))

    def of(self, element: Element) -> dict[str, str]:
        """Return the properties that an element itself has, by name."""
        given = {name: value for name in _NAMES if (value := element.get(name)) is not None}
        if self._rules:
            tag = local_name(element)
            named = [(".", name) for name in element.get("class", "").split()] + [("#", element.get("id", ""))]
            keys = [("", "", ""), (tag, "", ""), *((t, sign, name) for sign, name in named for t in ("", tag))]
            for key in keys:
                given |= self._rules.get(key, {})
        if (style := element.get("style")) is not None:
            given |= _declared(style)
        return {name: value for name, value in given.items() if value != "inherit"}

    def _add(self, selectors: str, declared: dict[str, str]) -> None:
        for selector in selectors.split(","):
            match = _SIMPLE.fullmatch(selector.strip())
            if match is not None and selector.strip():
                key = (match[1].replace("*", ""), match[2], match[3])
                self._rules[key] = self._rules.get(key, {}) | declared


def _rules(text: str) -> Iterator[tuple[str, str]]:
    """Yield the selectors and the declarations of rules, of those in at-rules only what is for every screen."""
    heads: list[str] = []
    for before, brace in _BRACE.findall(text):
        if brace == "{":
            heads.append(before.rpartition(";")[2].strip())  # an @import, which has no block, ends in a semicolon
        elif heads:
            head = heads.pop()
            if not head.startswith("@") and all(_on_screen(each.removeprefix("@media")) for each in heads):
                yield head, before


def _on_screen(media: str) -> bool:
    """Return whether a list of media has every screen in it."""
    return any(each.strip() in ("", "all", "screen", "only screen") for each in media.lower().split(","))


def _declared(text: str) -> dict[str, str]:
    pairs = (each.partition(":") for each in text.split(";"))
    return {name.strip().lower(): value.replace("!important", "").strip() for name, _, value in pairs if value}


def referred(value: str | None) -> str | None:
    """Return the id that a property such as ``url(#clip)`` refers to, or None."""
    match = _URL.match((value or "").strip())
    return None if match is None else match[1]


def colour_of(style: Style, name: str, otherwise: str) -> Rgb | None:
    """Return the colour of a fill or stroke, None where there is none. A gradient or pattern counts as black."""
    value = style.get(name, otherwise).strip()
    if value.lower() == "currentcolor":
        value = style.get("color", "black")
    if _is_zero(style.get(f"{name}-opacity")):
        return None
    return _parsed(value)


def _is_zero(opacity: str | None) -> bool:
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
