"""Reader of SVG: every shape that is not hidden is a stroke, also one without an outline and a fill."""

import io
from xml.etree.ElementTree import Element, tostring

import numpy as np
from svgelements import SVG, Path, Rect, Shape  # type: ignore[import-untyped]

from maulstick.errors import InputError
from maulstick.recording.files.curves import polylines
from maulstick.recording.files.lengths import page_side, pixels
from maulstick.recording.files.markup import METRES, local_name, parsed
from maulstick.recording.files.page import Page
from maulstick.recording.files.svg_paths import CORNERED, chains_of, check_uses, coordinates, is_whole
from maulstick.recording.files.svg_styles import write_attributes
from maulstick.recording.files.transforms import moved
from maulstick.storage.arrays import Floats

_NEVER_DRAWN = ("symbol", "marker", "mask", "pattern", "clipPath")  # elements that are drawn only by reference
_FAULTY = "faulty"  # attribute of elements whose points were cut at a fault
_NEAR_EDGE = 0.5  # pixels from the page's edge that its paper may begin or end at: programs round lengths
_LARGEST = 12 * 2**20  # characters, after every <use> is replaced: takes up to a minute


def read_svg(content: bytes) -> Page:
    """Read the page of an SVG: one stroke per path, subpath, line and shape, transformed, without times and pressure.

    The unit is known where width and height of the document are lengths, with 96 pixels per inch. Curves are sampled as
    in `curves.polylines`. Text, images and the page's paper are left out.
    Raises InputError where the file cannot be read, grows too large with every <use> replaced, or has no shape.
    """
    root = parsed(content, "svg")
    check_uses(root, _LARGEST)
    write_attributes(root)
    _hide(root)
    _cut_at_faults(root)
    is_sized = _write_sides(root)
    if is_sized and root.get("viewBox") is None:  # without one svgelements swaps what 100 % of each side is
        root.set("viewBox", f"0 0 {root.get('width')} {root.get('height')}")
    # svgelements' own moving of shapes knows no turned rectangle, and no arc that is skewed.
    document = SVG.parse(io.BytesIO(tostring(root)), on_error="raise", reify=False)
    elements = () if document is None else document.elements()  # None where its outermost element has no display
    shapes = [shape for shape in elements if isinstance(shape, Shape) and _is_visible(shape)]
    has_page = root.get("viewBox") is not None or (root.get("width") and root.get("height"))
    drawn = [shape for shape in shapes if not (has_page and _is_paper(shape, document.width, document.height))]
    chains = [moved(chain, shape.transform) for shape in drawn for chain in chains_of(Path(shape))]
    if not chains:
        there_is = "nothing but the page's paper" if shapes and not drawn else "no path or shape"
        raise InputError(f"there is {there_is} in it; convert text and objects to paths in the drawing program")
    strokes = [_stroke(points) for points in polylines(chains)]
    unit, size = (METRES["px"], (document.width, document.height)) if is_sized else (None, None)
    return Page(strokes, unit, size, "SVG", sum(map(_is_faulty, drawn)))


def _write_sides(root: Element) -> bool:
    """Write the sides of the page in pixels, without what is no length; return whether both are known."""
    sides = {name: page_side(root.get(name)) for name in ("width", "height")}
    for name, side in sides.items():
        if side is not None:
            root.set(name, repr(side))
        elif pixels(root.get(name)) is None:
            root.attrib.pop(name, None)
    return all(side is not None and side > 0 for side in sides.values())


def _hide(root: Element) -> None:
    """Move elements that are drawn only by reference into <defs>, because svgelements would draw them."""
    for parent in list(root.iter()):
        for index, child in enumerate(parent):
            if local_name(child) in _NEVER_DRAWN:
                parent[index] = hidden = Element(str(child.tag).replace(local_name(child), "defs"))
                child.tag = str(child.tag).replace(local_name(child), "g")
                hidden.append(child)


def _cut_at_faults(root: Element) -> None:
    """Let polylines and polygons end before a fault in their points, as paths do; svgelements goes on behind it."""
    for element in root.iter():
        if local_name(element) in CORNERED:
            sound, is_whole = coordinates(element.get("points", ""))
            if not is_whole:
                element.set("points", " ".join(map(repr, sound or [0.0, 0.0])))  # without any it would not be counted
                element.set(_FAULTY, "")


def _is_faulty(shape: Shape) -> bool:
    """Return whether a shape is drawn no further than to a fault in its data."""
    data = str(shape.values.get("d", "")) if isinstance(shape, Path) else ""
    return _FAULTY in shape.values or not is_whole(data)


def _is_visible(shape: Shape) -> bool:
    """Return whether a shape is seen; svgelements itself leaves out what has no display."""
    return str(shape.values.get("visibility")).lower() not in ("hidden", "collapse")


def _is_paper(shape: Shape, width: float, height: float) -> bool:
    """Return whether a shape is a rectangle without an outline over the whole page, as programs lay under a drawing."""
    if not isinstance(shape, Rect) or shape.stroke.value is not None or (box := shape.bbox()) is None:
        return False
    left, upper, right, lower = box
    return bool(max(left, upper) < _NEAR_EDGE and min(right - width, lower - height) > -_NEAR_EDGE)


def _stroke(points: Floats) -> Floats:
    moved = np.concatenate([[True], (np.diff(points, axis=0) != 0).any(axis=1)])
    return np.pad(points[moved], ((0, 0), (1, 1)), constant_values=np.nan)
