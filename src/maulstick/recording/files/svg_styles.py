"""Styles of an SVG for svgelements, which knows few selectors, and of CSS's moves `transform` alone."""

from xml.etree.ElementTree import Element

from maulstick.recording.files.css import GEOMETRY, INHERITED, MOVES, READ
from maulstick.recording.files.lengths import pixels
from maulstick.recording.files.markup import local_name
from maulstick.recording.files.style_sheet import StyleSheet
from maulstick.recording.files.svg_paths import PAGE, view_box
from maulstick.recording.files.transforms import transform_of

_MOVED = MOVES | {"transform-origin"}  # properties for which a transform is written anew

Size = tuple[float, float]
"""Width and height of a viewport, in user units: what percentages are of."""


def write_styles(root: Element) -> None:
    """Write what style sheets and styles say of the elements of a document into their attributes, moves as matrices.

    The outermost element is not moved, and gets only what is inherited and whether it is shown.
    """
    sheet = StyleSheet(root)
    styles = {element: sheet.of(element) for element in root.iter()}
    root.attrib.update({name: styles[root][name] for name in (*INHERITED, "display") if name in styles[root]})
    _write(root, styles, _viewport(root, (PAGE, PAGE)))


def _write(parent: Element, styles: dict[Element, dict[str, str]], size: Size) -> None:
    for element in parent:
        own = styles[element]
        if own.keys() & _MOVED:
            m = transform_of(own, *size)
            own = {**own, "transform": f"matrix({m.a!r} {m.b!r} {m.c!r} {m.d!r} {m.e!r} {m.f!r})"}
        for name in READ:
            element.attrib.pop(name, None)
        element.attrib.update({name: own[name] for name in (*READ, *GEOMETRY) if name in own})
        element.attrib.pop("style", None)
        if local_name(element) == "style":
            element.text = ""
        _write(element, styles, _viewport(element, size))


def _viewport(element: Element, outside: Size) -> Size:
    """Return the size of the viewport inside an element; most have none of their own."""
    if local_name(element) not in ("svg", "symbol"):
        return outside
    if (view := view_box(element)) is not None:
        return view[2], view[3]
    sides = [pixels(element.get(name, "100%"), whole) for name, whole in zip(("width", "height"), outside, strict=True)]
    return sides[0] or outside[0], sides[1] or outside[1]
