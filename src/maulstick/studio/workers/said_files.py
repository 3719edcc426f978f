"""Files of what a person says of places on a sheet: for planning, as `RegionFiles` reads them, and for a later canvas.

A map is stretched over the picture, so all of them are in millimetres of the picture's area on the sheet.
"""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
import shapely
from pydantic import ValidationError
from shapely.geometry.base import BaseGeometry

from maulstick.errors import InputError, validation_fault
from maulstick.jobs.plan.request import PlanRequest
from maulstick.painting.fit import place_of
from maulstick.painting.painting import Sheet
from maulstick.painting.picture import read_picture
from maulstick.painting.raster import Canvas, parse_margin
from maulstick.storage.arrays import Floats
from maulstick.storage.files import read_whole
from maulstick.studio.workers.areas import geometry_of, lines_in, polygons
from maulstick.studio.workers.said import Said, SaidGuide, SaidRegion
from maulstick.studio.workers.stroke_marks import after_edits

SAID_FILE: Final = "said.json"
"""File in a plan's folder: the regions and guides that it was planned with, as the canvas has them."""

MAP, SAY, GUIDES = "map.svg", "say.toml", "guides.svg"
"""Files in a plan's folder: its regions on the picture, what holds there, and its guides."""

_FINE = 1e6  # pixels per metre at which the picture's place is found: to the micrometre, whatever it is planned at
_BEYOND = 1e-4  # metres that areas go on beyond the picture: what a map has at its edges holds on the paper around
_LARGEST = 2**26  # bytes of the canvas's own file


def read_said(folder: Path) -> Said:
    """Return what a plan's folder says of places. Raises InputError for a file of another version of Maulstick."""
    if not (file := folder / SAID_FILE).is_file():
        return Said()
    try:
        return Said.model_validate_json(read_whole(file, "file of regions", _LARGEST))
    except ValidationError as error:
        raise InputError(f"{file} is of another version of Maulstick: {validation_fault(error)}; plan anew") from error


def said_files(painting: Path, said: str, request: PlanRequest) -> dict[str, bytes]:
    """Return the files of `Said` in JSON, by their names: for the canvas, and what is seen of it for planning.

    painting: file with the sheet.  request: says how the picture lies on it.
    A region that lies beside the picture, or wholly under later ones, is in none of those for planning.
    Raises InputError where the picture cannot be read.
    """
    places = Said.model_validate_json(said)
    if not (places.regions or places.guides):
        return {}
    left, top, right, bottom = picture_place(after_edits(painting, ()).sheet, request)
    size = right - left, bottom - top
    around = shapely.box(left - _BEYOND, top - _BEYOND, right + _BEYOND, bottom + _BEYOND)
    files = {SAID_FILE: said.encode()}
    if seen := _seen(places.regions, around):
        files[MAP] = _svg(size, [_path(region, area, (left, top)) for region, area in seen])
        files[SAY] = "\n".join(_section(region) for region, _ in seen).encode()
    if lines := _lines(places.guides, shapely.box(left, top, right, bottom), (left, top)):
        files[GUIDES] = _svg(size, lines)
    return files


def picture_place(sheet: Sheet, request: PlanRequest) -> tuple[float, float, float, float]:
    """Return the left, top, right and lower edge of a request's picture on the sheet, metres; beyond it where cut off.

    Raises InputError where the picture cannot be read.
    """
    options = request.options
    shape: tuple[int, ...] = round(_FINE * sheet.height), round(_FINE * sheet.width)  # of a text, which has none
    if request.picture is not None:
        shape = options.edit.shape(read_picture(request.picture, options.read_px, options.least_px).shape)
    margin = parse_margin(options.margin, (sheet.width, sheet.height))
    place = place_of(shape, Canvas(sheet.width, sheet.height, _FINE), options.fit, margin)
    left, top, right, bottom = (edge / _FINE for edge in place)
    return left, top, right, bottom


def _seen(regions: Sequence[SaidRegion], around: BaseGeometry) -> list[tuple[SaidRegion, list[shapely.Polygon]]]:
    """Return the regions of which something is seen, the lowest first, with what of each lies within an area."""
    over: BaseGeometry = shapely.Polygon()
    seen = []
    for region in reversed(regions):
        area = shapely.intersection(geometry_of(region.area), around)
        if polygons(shapely.difference(area, over)):
            seen.append((region, polygons(area)))
        over = shapely.union(over, area)
    return seen[::-1]


def _section(region: SaidRegion) -> str:
    """Return what holds in a region as a table of TOML, whose strings are written as those of JSON."""
    said: dict[str, object] = {"colour": region.colour, "bare": True}
    if not region.bare:
        said = region.model_dump(include={"colour", "style", "hand_size", "brush", "importance", "direction"})
        said["soft"] = f"{1e3 * region.soft:g}mm" if region.soft else None
    there = {name: value for name, value in said.items() if value is not None}
    lines = [f"{name} = {json.dumps(value, ensure_ascii=False)}" for name, value in there.items()]
    return "\n".join([f"[{json.dumps(region.name, ensure_ascii=False)}]", *lines, ""])


def _path(region: SaidRegion, area: Sequence[shapely.Polygon], corner: tuple[float, float]) -> str:
    rings = [ring for part in area for ring in (part.exterior, *part.interiors)]
    drawn = " ".join(f"M{_points(shapely.get_coordinates(ring)[:-1], corner)}Z" for ring in rings)
    return f'<path fill="{region.colour}" fill-rule="evenodd" d="{drawn}"/>'


def _lines(guides: Sequence[SaidGuide], around: BaseGeometry, corner: tuple[float, float]) -> list[str]:
    found = [line for guide in guides for line in lines_in(shapely.LineString(guide.line), around)]
    return [f'<polyline fill="none" stroke="black" points="{_points(line, corner)}"/>' for line in found]


def _points(line: Floats, corner: tuple[float, float]) -> str:
    """Return points, metres on the sheet, as text in millimetres from a corner."""
    return " ".join(f"{x:.4f},{y:.4f}" for x, y in (1e3 * (line - np.array(corner))).tolist())


def _svg(size: tuple[float, float], shapes: Sequence[str]) -> bytes:
    """Return shapes as an SVG. size: of its page, metres."""
    wide, high = (f"{1e3 * side:.4f}" for side in size)
    page = f'width="{wide}mm" height="{high}mm" viewBox="0 0 {wide} {high}"'
    return "\n".join([f'<svg xmlns="http://www.w3.org/2000/svg" {page}>', *shapes, "</svg>", ""]).encode()
