"""Reader of SVG: every visible shape is a stroke."""

import io
import re
from collections.abc import Iterable
from xml.etree.ElementTree import Element, tostring

import numpy as np
from svgelements import (  # type: ignore[import-untyped]
    SVG,
    Arc,
    Close,
    CubicBezier,
    Line,
    Move,
    Path,
    QuadraticBezier,
    Shape,
)

from maulstick.errors import InputError
from maulstick.recording.files.curves import polylines
from maulstick.recording.files.markup import METRES, local_name, parsed
from maulstick.recording.files.page import Page
from maulstick.storage.arrays import Floats

_NEVER_DRAWN = ("symbol", "marker", "mask", "pattern", "clipPath")  # elements that are drawn only by reference
_LARGEST = 12 * 2**20  # characters, after every <use> is replaced: takes up to a minute
_ELEMENT = 32  # characters that an element counts in addition to its attributes


def read_svg(content: bytes) -> Page:
    """Read the page of an SVG: one stroke per path, subpath, line and shape, transformed, without times and pressure.

    The unit is known where width and height of the document are lengths, with 96 pixels per inch. Curves are sampled as
    in `curves.polylines`. Text and images are left out.
    Raises InputError where the file cannot be read, grows too large with every <use> replaced, or has no shape.
    """
    root = parsed(content, "svg")
    _check_uses(root)
    _hide(root)
    document = SVG.parse(io.BytesIO(tostring(root)), on_error="raise")
    chains = [c for shape in document.elements() if isinstance(shape, Shape) for c in _chains(Path(shape))]
    if not chains:
        raise InputError("there is no path or shape in it; convert text and objects to paths in the drawing program")
    width, height = float(document.width), float(document.height)
    metres = _metres(root.get("width"))
    unit = metres / width if metres and _metres(root.get("height")) and width > 0 and height > 0 else None
    strokes = [_stroke(points) for points in polylines(chains)]
    return Page(strokes, unit, None if unit is None else (width, height), "SVG")


def _check_uses(root: Element) -> None:
    """Raise InputError where <use> makes a small file very large or endless."""
    named = {element.get("id"): element for element in root.iter()}
    costs: dict[Element, int] = {}
    under_way: set[Element] = set()

    def cost(element: Element) -> int:
        if element in under_way:
            raise InputError("a <use> in it uses itself; take that out")
        if element not in costs:
            under_way.add(element)
            total = _ELEMENT + sum(map(len, element.attrib.values())) + sum(cost(child) for child in element)
            if local_name(element) == "use":
                links = [value[1:] for name, value in element.attrib.items() if name.rpartition("}")[2] == "href"]
                total += sum(cost(named[link]) for link in links if link in named)
            under_way.remove(element)
            costs[element] = total
        return costs[element]

    if cost(root) > _LARGEST:
        raise InputError(f"its shapes come to over {_LARGEST >> 20} MiB, counting every <use> of them; split it")


def _hide(root: Element) -> None:
    """Move elements that are drawn only by reference into <defs>, because svgelements would draw them."""
    for parent in list(root.iter()):
        for index, child in enumerate(parent):
            if local_name(child) in _NEVER_DRAWN:
                parent[index] = hidden = Element(str(child.tag).replace(local_name(child), "defs"))
                child.tag = str(child.tag).replace(local_name(child), "g")
                hidden.append(child)


def _metres(side: str | None) -> float | None:
    """Return a CSS length in metres, or None where it is not one."""
    match = re.fullmatch(r"\s*\+?(\d+\.?\d*|\.\d+)\s*(|px|mm|cm|in|pt|pc)\s*", side or "")
    return float(match[1]) * METRES[match[2] or "px"] if match else None


def _chains(path: Path) -> Iterable[Floats]:
    """Yield each subpath as cubic Béziers (m, 4, 2)."""
    cubics: list[list[complex]] = []
    for segment in path:
        if isinstance(segment, Move) and cubics:
            yield _points(cubics)
            cubics = []
        cubics += _cubics(segment)
    if cubics:
        yield _points(cubics)


def _cubics(segment: object) -> list[list[complex]]:
    if isinstance(segment, Arc):
        return [_complex(c.start, c.control1, c.control2, c.end) for c in segment.as_cubic_curves()]
    if isinstance(segment, CubicBezier):
        return [_complex(segment.start, segment.control1, segment.control2, segment.end)]
    if isinstance(segment, QuadraticBezier):
        start, control, end = _complex(segment.start, segment.control, segment.end)
        return [[start, start + (control - start) * 2 / 3, end + (control - end) * 2 / 3, end]]
    if isinstance(segment, (Line, Close)) and segment.start is not None and segment.end is not None:
        start, end = _complex(segment.start, segment.end)
        return [[start, start + (end - start) / 3, end - (end - start) / 3, end]]
    return []


def _complex(*points: object) -> list[complex]:
    return [complex(point) for point in points]  # type: ignore[call-overload]


def _points(cubics: list[list[complex]]) -> Floats:
    chain = np.array(cubics)
    return np.stack([chain.real, chain.imag], axis=-1)


def _stroke(points: Floats) -> Floats:
    moved = np.concatenate([[True], (np.diff(points, axis=0) != 0).any(axis=1)])
    return np.pad(points[moved], ((0, 0), (1, 1)), constant_values=np.nan)
