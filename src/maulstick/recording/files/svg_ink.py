"""Reader of SVG: every visible shape is a stroke."""

import io
import re
from xml.etree.ElementTree import Element, tostring

import numpy as np
from svgelements import SVG, Path, Shape  # type: ignore[import-untyped]

from maulstick.errors import InputError
from maulstick.recording.files.curves import polylines
from maulstick.recording.files.markup import METRES, local_name, parsed
from maulstick.recording.files.page import Page
from maulstick.recording.files.svg_paths import chains_of, check_uses
from maulstick.storage.arrays import Floats

_NEVER_DRAWN = ("symbol", "marker", "mask", "pattern", "clipPath")  # elements that are drawn only by reference
_LARGEST = 12 * 2**20  # characters, after every <use> is replaced: takes up to a minute


def read_svg(content: bytes) -> Page:
    """Read the page of an SVG: one stroke per path, subpath, line and shape, transformed, without times and pressure.

    The unit is known where width and height of the document are lengths, with 96 pixels per inch. Curves are sampled as
    in `curves.polylines`. Text and images are left out.
    Raises InputError where the file cannot be read, grows too large with every <use> replaced, or has no shape.
    """
    root = parsed(content, "svg")
    check_uses(root, _LARGEST)
    _hide(root)
    document = SVG.parse(io.BytesIO(tostring(root)), on_error="raise")
    shapes = [shape for shape in document.elements() if isinstance(shape, Shape) and _is_visible(shape)]
    chains = [chain for shape in shapes for chain in chains_of(Path(shape))]
    if not chains:
        raise InputError("there is no path or shape in it; convert text and objects to paths in the drawing program")
    width, height = float(document.width), float(document.height)
    metres = _metres(root.get("width"))
    unit = metres / width if metres and _metres(root.get("height")) and width > 0 and height > 0 else None
    strokes = [_stroke(points) for points in polylines(chains)]
    return Page(strokes, unit, None if unit is None else (width, height), "SVG")


def _hide(root: Element) -> None:
    """Move elements that are drawn only by reference into <defs>, because svgelements would draw them."""
    for parent in list(root.iter()):
        for index, child in enumerate(parent):
            if local_name(child) in _NEVER_DRAWN:
                parent[index] = hidden = Element(str(child.tag).replace(local_name(child), "defs"))
                child.tag = str(child.tag).replace(local_name(child), "g")
                hidden.append(child)


def _is_visible(shape: Shape) -> bool:
    """Return whether a shape is seen; svgelements itself leaves out what has no display."""
    return shape.values.get("visibility") not in ("hidden", "collapse")


def _metres(side: str | None) -> float | None:
    """Return a CSS length in metres, or None where it is not one."""
    match = re.fullmatch(r"\s*\+?(\d+\.?\d*|\.\d+)\s*(|px|mm|cm|in|pt|pc)\s*", side or "")
    return float(match[1]) * METRES[match[2] or "px"] if match else None


def _stroke(points: Floats) -> Floats:
    moved = np.concatenate([[True], (np.diff(points, axis=0) != 0).any(axis=1)])
    return np.pad(points[moved], ((0, 0), (1, 1)), constant_values=np.nan)
