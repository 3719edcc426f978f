"""What readers of SVG share: viewBoxes, paths as chains of cubic Béziers, points, and a bound on <use>."""

import re
from collections.abc import Iterator
from typing import Final
from xml.etree.ElementTree import Element

import numpy as np
from svgelements import (  # type: ignore[import-untyped]
    Arc,
    Close,
    CubicBezier,
    Line,
    Matrix,
    Move,
    Path,
    QuadraticBezier,
    Viewbox,
)

from maulstick.errors import InputError
from maulstick.recording.files.lengths import Viewport
from maulstick.recording.files.markup import local_name
from maulstick.storage.arrays import Floats

CORNERED: Final = ("polyline", "polygon")
"""Elements that are drawn through points."""

PAGE: Final = 1000.0
"""Pixels of each side of a page whose file does not say it, as svgelements and vpype have it."""

_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_COORDINATE = re.compile(rf"({_NUMBER.pattern})\s*,?\s*")
_FOREIGN = re.compile(r"[^MmZzLlHhVvCcSsQqTtAaEe\d.,+\-\s]")  # to a path's data: svgelements ends there in silence
_TURN = re.compile(r"([QqTt][^A-DF-Za-df-z]*(?=[Ss])|[CcSs][^A-DF-Za-df-z]*(?=[Tt]))")  # to a curve of another kind
_ELEMENT = 32  # characters that an element counts in addition to its attributes


def chains_of(path: Path) -> Iterator[Floats]:
    """Yield each subpath as cubic Béziers (m, 4, 2), each starting where the last one ended."""
    cubics: list[list[complex]] = []
    for segment in path:
        if isinstance(segment, Move) and cubics:
            yield _points(cubics)
            cubics = []
        cubics += _cubics(segment)
    if cubics:
        yield _points(cubics)


def parted(data: str) -> str:
    """Return a path's data with a step of no length before each S behind a quadratic curve, and each T behind a cubic.

    Such a curve takes no direction of the one before (SVG 1.1, 8.3.6), but svgelements has it go on as that ended.
    """
    return _TURN.sub(r"\1l0 0", data)


def is_whole(data: str) -> bool:
    """Return whether a path's data has nothing in it at which svgelements ends in silence."""
    return data.strip() == "none" or _FOREIGN.search(data) is None


def numbers(text: str | None) -> list[float]:
    """Return all numbers in a text such as a viewBox."""
    return [float(number) for number in _NUMBER.findall(text or "")]


def link_of(use: Element) -> str:
    """Return what a <use> refers to, ``#`` and an id, or another file."""
    return use.get("href") or use.get("{http://www.w3.org/1999/xlink}href") or ""


def view_box(element: Element) -> list[float] | None:
    """Return the viewBox (x, y, width, height) of an element, or None where it has none that can be used."""
    view = numbers(element.get("viewBox"))
    return view if len(view) == 4 and view[2] > 0 and view[3] > 0 else None


def viewed(element: Element, place: tuple[float, float, float, float]) -> tuple[Matrix, Viewport]:
    """Return the matrix from the inside of an element with a viewBox to its outside, and the viewport inside.

    place: x, y, width and height of the element outside.
    """
    view = view_box(element)
    if view is None:
        return Matrix.translate(*place[:2]), Viewport(*place[2:])
    aspect = " ".join(element.get("preserveAspectRatio", "xMidYMid").replace("defer", "").split())
    return Matrix(Viewbox.viewbox_transform(*place, *view, aspect or "xMidYMid")), Viewport(*view[2:])


def coordinates(text: str) -> tuple[list[float], bool]:
    """Return the coordinates of points up to a fault, x and y in turn, and whether there is no fault."""
    read: list[float] = []
    end = len(text) - len(text.lstrip())
    while match := _COORDINATE.match(text, end):  # one expression for all of them would need 1 kB for each
        read.append(float(match[1]))
        end = match.end()
    return read[: len(read) // 2 * 2], end == len(text) and len(read) % 2 == 0


def _cubics(segment: object) -> list[list[complex]]:
    if isinstance(segment, (Line, Close)):
        if segment.start is None or segment.end is None:
            return []
        return _straight(segment)
    if isinstance(segment, Arc):
        if segment.rx == 0 or segment.ry == 0:  # then it is a line (SVG 1.1, F.6.2)
            return _straight(segment)
        return [_complex(c.start, c.control1, c.control2, c.end) for c in segment.as_cubic_curves()]
    if isinstance(segment, CubicBezier):
        return [_complex(segment.start, segment.control1, segment.control2, segment.end)]
    if isinstance(segment, QuadraticBezier):
        start, control, end = _complex(segment.start, segment.control, segment.end)
        return [[start, start + (control - start) * 2 / 3, end + (control - end) * 2 / 3, end]]
    return []


def _straight(segment: Line | Close | Arc) -> list[list[complex]]:
    start, end = _complex(segment.start, segment.end)
    return [[start, start + (end - start) / 3, end - (end - start) / 3, end]]


def _complex(*points: object) -> list[complex]:
    return [complex(point) for point in points]  # type: ignore[call-overload]


def _points(cubics: list[list[complex]]) -> Floats:
    chain = np.array(cubics)
    return np.stack([chain.real, chain.imag], axis=-1)


def check_uses(root: Element, most: int) -> None:
    """Raise InputError where <use> makes a small file very large or endless: over `most` characters in all."""
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

    if cost(root) > most:
        raise InputError(f"its shapes come to over {most >> 20} MiB, counting every <use> of them; split it")
