"""What drawings in XML share: how they are opened, the names of their elements, and CSS's units."""

from xml.etree.ElementTree import Element

from defusedxml.ElementTree import fromstring  # type: ignore[import-untyped]

from maulstick.errors import InputError

_INCH = 25.4e-3  # metres
METRES = {"mm": 1e-3, "cm": 1e-2, "in": _INCH, "pt": _INCH / 72, "pc": _INCH / 6, "px": _INCH / 96}


def parsed(content: bytes, outermost: str) -> Element:
    """The outermost element of a document. Raises InputError, or the parser's own error, where it is another."""
    root: Element = fromstring(content)
    if local_name(root) != outermost:
        raise InputError(f"its outermost element is <{local_name(root)}>; it must be <{outermost}>")
    return root


def local_name(element: Element) -> str:
    """The name of an element without its namespace."""
    return str(element.tag).rpartition("}")[2]
