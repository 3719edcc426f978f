"""Attributes of an SVG as svgelements can read them.

It knows few selectors, and of CSS's moves `transform` alone. A box without a place or a size gets that of one around
it, an ellipse without a radius one of 1, what is smaller than nothing is drawn, percentages in and after an inner <svg>
are of the wrong viewport, a <symbol> has no viewBox, and ``em`` is an error.
"""

from xml.etree.ElementTree import Element

from svgelements import Matrix  # type: ignore[import-untyped]

from maulstick.recording.files.css import GEOMETRY, INHERITED, MOVES, READ
from maulstick.recording.files.lengths import Viewport
from maulstick.recording.files.markup import local_name
from maulstick.recording.files.style_sheet import StyleSheet
from maulstick.recording.files.svg_paths import PAGE, link_of, parted, view_box, viewed
from maulstick.recording.files.transforms import is_relative, transform_of

_MOVED = MOVES | {"transform-origin"}  # properties for which a transform is written anew
_ALONG_X = {  # lengths of elements, whose others along y are called alike
    "circle": ("cx",),
    "ellipse": ("cx",),
    "line": ("x1", "x2"),
    "rect": ("x", "width"),
    "svg": ("x", "width"),
    "use": ("x",),
}


def write_attributes(root: Element) -> None:
    """Write what style sheets and styles say of elements into their attributes, moves as matrices, lengths in pixels.

    The outermost element is not moved, and gets only what is inherited and whether it is shown.
    """
    sheet = StyleSheet(root)
    styles = {element: sheet.of(element) for element in root.iter()}
    root.attrib.update({name: styles[root][name] for name in (*INHERITED, "display") if name in styles[root]})
    symbols = {f"#{element.get('id')}": element for element in root.iter() if local_name(element) == "symbol"}
    _write(root, styles, symbols, _inside(root, Viewport(PAGE, PAGE)))


def _write(
    parent: Element, styles: dict[Element, dict[str, str]], symbols: dict[str, Element], viewport: Viewport
) -> None:
    for element in parent:
        own = styles[element]
        if own.keys() & _MOVED or is_relative(own.get("transform", "")):
            m = transform_of(own, viewport.width, viewport.height)
            own = {**own, "transform": _in_words(m)}
        for name in READ:
            element.attrib.pop(name, None)
        element.attrib.update({name: own[name] for name in (*READ, *GEOMETRY) if name in own})
        element.attrib.pop("style", None)
        if local_name(element) == "style":
            element.text = ""
        if local_name(element) == "path":
            element.set("d", parted(element.get("d", "")))
        _write_lengths(element, viewport)
        if local_name(element) == "use" and (symbol := symbols.get(link_of(element))) is not None:
            _place(element, symbol, viewport)
        _write(element, styles, symbols, _inside(element, viewport))


def _write_lengths(element: Element, viewport: Viewport) -> None:
    tag = local_name(element)
    for x in _ALONG_X.get(tag, ()):
        y = x.replace("x", "y").replace("width", "height")
        whole = "100%" if (tag, x) == ("svg", "width") else "0"
        element.set(x, repr(viewport.x(element, x, whole)))
        element.set(y, repr(viewport.y(element, y, whole)))
    if tag in ("ellipse", "rect"):
        for name, radius in zip(("rx", "ry"), viewport.radii(element), strict=True):
            element.set(name, repr(radius))
    if tag == "circle":
        element.set("r", repr(max(viewport.other(element.get("r")), 0.0)))
    if tag in ("rect", "svg"):
        width, height = element.get("width", ""), element.get("height", "")
        if min(float(width), float(height)) <= 0:  # svgelements would draw one below 0, or end there
            element.set("display", "none")
        elif tag == "svg" and view_box(element) is None:  # or svgelements would not move it
            element.set("viewBox", f"0 0 {width} {height}")


def _place(use: Element, symbol: Element, viewport: Viewport) -> None:
    """Let a <use> move its <symbol> from the viewBox to the place and the size that the two of them say."""
    across, down = (symbol if use.get(name) is None else use for name in ("width", "height"))
    width, height = viewport.x(across, "width", "100%"), viewport.y(down, "height", "100%")
    if min(width, height) <= 0:
        use.set("display", "none")
        return
    matrix, _ = viewed(symbol, (viewport.x(symbol, "x"), viewport.y(symbol, "y"), width, height))
    corner = f"translate({use.attrib.pop('x')} {use.attrib.pop('y')})"
    use.set("transform", f"{use.get('transform', '')} {corner} {_in_words(matrix)}")


def _in_words(m: Matrix) -> str:
    return f"matrix({m.a!r} {m.b!r} {m.c!r} {m.d!r} {m.e!r} {m.f!r})"


def _inside(element: Element, outside: Viewport) -> Viewport:
    """Return the viewport inside an element; most have none of their own."""
    if local_name(element) not in ("svg", "symbol"):
        return outside
    if (view := view_box(element)) is not None:
        return Viewport(view[2], view[3])
    width, height = outside.x(element, "width", "100%"), outside.y(element, "height", "100%")
    return Viewport(width or outside.width, height or outside.height)
