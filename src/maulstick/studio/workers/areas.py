"""Areas and lines that a person draws on a sheet: what a lasso encloses, a brush covers, and a guide follows."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from maulstick.errors import InputError
from maulstick.storage.arrays import Floats
from maulstick.studio.workers.said import Area, Spot
from maulstick.studio.workers.stroke_marks import after_edits

_STRAY = 1e-4  # metres that a corner may lie beside what was drawn: less than is seen
_DIGITS = 9  # of a metre that count: what is nearer to 0 still is more than shapely can reckon with
_LEAST = 1e-7  # square metres, a tenth of a square millimetre: what is smaller is a slip of the hand


def enclosed(file: Path, points: Sequence[Spot]) -> Area:
    """Return what a line encloses on the sheet of the plan in a file; where it crosses itself, every part of it.

    points: metres. Raises InputError where that is nothing.
    """
    line = _drawn(points)
    area = shapely.make_valid(shapely.Polygon(line)) if len(line) > 2 else shapely.Polygon()
    return _on_sheet(file, area, "draw a line around an area of the sheet")


def brushed(file: Path, points: Sequence[Spot], width: float, before: Area) -> Area:
    """Return what a round brush of a width covers along a line, and the area `before`; metres.

    Raises InputError where that is nothing of the sheet.
    """
    line = _drawn(points)
    dab = shapely.Point(line[0]) if len(line) == 1 else shapely.LineString(line)
    covered = dab.buffer(width / 2, quad_segs=12)
    return _on_sheet(file, shapely.union(covered, geometry_of(before)), "paint on the sheet")


def guide(file: Path, points: Sequence[Spot]) -> tuple[Spot, ...]:
    """Return the longest part of a line that lies on the sheet; metres. Raises InputError where there is none."""
    line = shapely.LineString(_drawn(points)) if len(points) > 1 else shapely.LineString()
    parts = lines_in(shapely.simplify(line, _STRAY), _sheet(file))
    if not parts:
        raise InputError("that line has no length on the sheet; draw it along the way that strokes should take")
    return tuple(map(tuple, max(parts, key=_length).tolist()))


def lines_in(line: BaseGeometry, around: BaseGeometry) -> list[Floats]:
    """Return the parts of a line that lie in an area, (n, 2) each."""
    parts = shapely.get_parts(shapely.line_merge(shapely.intersection(line, around)))
    return [shapely.get_coordinates(part) for part in parts if part.geom_type == "LineString" and part.length > _STRAY]


def geometry_of(area: Area) -> BaseGeometry:
    """Return an area as a valid geometry of shapely."""
    return shapely.make_valid(shapely.MultiPolygon([(rings[0], list(rings[1:])) for rings in area]))


def polygons(shape: BaseGeometry) -> list[shapely.Polygon]:
    """Return the polygons of a geometry that are large enough to be meant; lines and points in it are left out."""
    parts = shapely.get_parts(shapely.get_parts(shape))  # of a collection that has several
    return [part for part in parts if part.geom_type == "Polygon" and part.area >= _LEAST]


def _drawn(points: Sequence[Spot]) -> Floats:
    return np.array(points, dtype=np.float64).round(_DIGITS)


def _on_sheet(file: Path, area: BaseGeometry, remedy: str) -> Area:
    plain = shapely.simplify(shapely.intersection(area, _sheet(file)), _STRAY)
    found = [[shapely.get_coordinates(ring)[:-1].tolist() for ring in _rings(part)] for part in polygons(plain)]
    if not found:
        raise InputError(f"there is no area in that; {remedy}")
    return tuple(tuple(tuple(map(tuple, ring)) for ring in rings) for rings in found)


def _rings(polygon: shapely.Polygon) -> list[shapely.LinearRing]:
    """Return the outline of a polygon, and those of its holes that are large enough to be meant."""
    return [polygon.exterior, *(ring for ring in polygon.interiors if shapely.Polygon(ring).area >= _LEAST)]


def _sheet(file: Path) -> shapely.Polygon:
    sheet = after_edits(file, ()).sheet
    return shapely.box(0, 0, sheet.width, sheet.height)


def _length(line: Floats) -> float:
    return float(np.hypot(*np.diff(line, axis=0).T).sum())
