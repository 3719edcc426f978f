"""Functions that readers of XML share: parsing, names of elements, and CSS's units."""

from xml.etree.ElementTree import Element

from defusedxml.ElementTree import fromstring  # type: ignore[import-untyped]

from maulstick.errors import InputError

_INCH = 25.4e-3  # metres
METRES = {"mm": 1e-3, "cm": 1e-2, "q": 2.5e-4, "in": _INCH, "pt": _INCH / 72, "pc": _INCH / 6, "px": _INCH / 96}
"""CSS's units of length in metres."""


def parsed(content: bytes, outermost: str) -> Element:
    """Parse a document and return its outermost element, which must have the name `outermost`.

    Raises InputError where it has another, or the parser's own error.
    """
    root: Element = fromstring(content)
    if local_name(root) != outermost:
        raise InputError(f"its outermost element is <{local_name(root)}>; it must be <{outermost}>")
    return root


def local_name(element: Element) -> str:
    """Return the name of an element without its namespace."""
    return str(element.tag).rpartition("}")[2]
