"""Outlines of SVG shapes as chains of cubic Béziers, in the shape's own user units."""

from collections.abc import Callable
from xml.etree.ElementTree import Element

import numpy as np
from svgelements import Ellipse, Path, Rect  # type: ignore[import-untyped]

from maulstick.drawing.document import NO_PLACE
from maulstick.errors import InputError
from maulstick.recording.files.lengths import Viewport
from maulstick.recording.files.markup import local_name
from maulstick.recording.files.svg_paths import CORNERED, chains_of, coordinates, is_whole, parted
from maulstick.storage.arrays import Floats


def outline(element: Element, viewport: Viewport) -> tuple[list[Floats], bool]:
    """Return the subpaths of a shape, each (m, 4, 2) user units, and whether all of its data could be read.

    Of faulty data the part before the fault is returned, as SVG asks for.
    """
    tag = local_name(element)
    if tag == "path":
        return _path(element.get("d", ""))
    if tag in CORNERED:
        return _cornered(element.get("points", ""), closed=tag == "polygon")
    return _OUTLINES[tag](element, viewport), True


def is_shape(tag: str) -> bool:
    """Return whether elements of this name draw something by themselves."""
    return tag == "path" or tag in CORNERED or tag in _OUTLINES


def _path(data: str) -> tuple[list[Floats], bool]:
    path = Path()
    try:
        path.parse(parted(data))
    except (ValueError, TypeError, IndexError, AttributeError, ZeroDivisionError):
        return _chains(path), False
    return _chains(path), is_whole(data)


def _chains(path: Path) -> list[Floats]:
    try:
        return list(chains_of(path))
    except (ValueError, OverflowError, ZeroDivisionError):  # of an arc whose numbers are not finite
        raise InputError(NO_PLACE) from None


def _rect(element: Element, viewport: Viewport) -> list[Floats]:
    x, y = viewport.x(element, "x"), viewport.y(element, "y")
    width, height = viewport.x(element, "width"), viewport.y(element, "height")
    if width <= 0 or height <= 0:
        return []
    across, down = viewport.radii(element)
    rx, ry = min(across, width / 2), min(down, height / 2)
    if rx > 0 and ry > 0:
        return _chains(Path(Rect(x=x, y=y, width=width, height=height, rx=rx, ry=ry)))
    corners = [[x, y], [x + width, y], [x + width, y + height], [x, y + height], [x, y]]
    return [_straight(np.array(corners))]


def _circle(element: Element, viewport: Viewport) -> list[Floats]:
    radius = viewport.other(element.get("r"))
    return _round(element, viewport, radius, radius)


def _ellipse(element: Element, viewport: Viewport) -> list[Floats]:
    return _round(element, viewport, *viewport.radii(element))


def _round(element: Element, viewport: Viewport, rx: float, ry: float) -> list[Floats]:
    if rx <= 0 or ry <= 0:
        return []
    centre = viewport.x(element, "cx"), viewport.y(element, "cy")
    return _chains(Path(Ellipse(cx=centre[0], cy=centre[1], rx=rx, ry=ry)))


def _line(element: Element, viewport: Viewport) -> list[Floats]:
    ends = [[viewport.x(element, f"x{end}"), viewport.y(element, f"y{end}")] for end in (1, 2)]
    return [_straight(np.array(ends))]


def _cornered(text: str, closed: bool) -> tuple[list[Floats], bool]:
    read, whole = coordinates(text)
    if len(read) < 4:
        return [], whole
    return [_straight(np.array([*read, *(read[:2] if closed else [])]).reshape(-1, 2))], whole


def _straight(points: Floats) -> Floats:
    """Return the straight steps between points (n, 2) as cubic Béziers (n - 1, 4, 2)."""
    start, end = points[:-1], points[1:]
    return np.stack([start, start + (end - start) / 3, end - (end - start) / 3, end], axis=1)


_OUTLINES: dict[str, Callable[[Element, Viewport], list[Floats]]] = {
    "rect": _rect,
    "circle": _circle,
    "ellipse": _ellipse,
    "line": _line,
}
