"""Regions that shapes fill: by the rule of their fill, within their clips; and the lines that hatch them."""

from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from maulstick.drawing.lines import SAME
from maulstick.errors import InputError
from maulstick.storage.arrays import Bools, Floats, Ints

_CHUNK = 2**22  # pairs of face and edge that are looked at together: 100 MB
_MOST_LINES = 100_000  # that hatch one shape: 5 m of the narrowest
_SHORTEST = 1e-5  # metres: a shorter line of a hatch is a speck


def region_of(rings: Sequence[Floats], rule: str) -> BaseGeometry:
    """Return the region that closed polylines (k, 2) fill by the rule, ``nonzero`` or ``evenodd``."""
    closed = [_closed(ring) for ring in rings if len(ring) > 2]
    if not closed:
        return shapely.Polygon()
    if len(closed) == 1 and (polygon := shapely.Polygon(closed[0])).is_valid:
        return polygon
    nodes = shapely.union_all([shapely.LineString(ring) for ring in closed])
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(nodes)))
    if not len(faces):
        return shapely.Polygon()
    winding = _winding(shapely.get_coordinates(shapely.point_on_surface(faces)), closed)
    return shapely.union_all(faces[_filled(winding, rule)])


def hatched(region: BaseGeometry, spacing: float, angle: float) -> list[Floats]:
    """Return parallel lines (2, 2) through a region, metres, to and fro; as `rows_through`."""
    rows = rows_through(region, spacing, angle)
    return [row[::-1] if number % 2 else row for number, row in enumerate(rows)]


def rows_through(region: BaseGeometry, spacing: float, angle: float) -> list[Floats]:
    """Return what of parallel lines lies in a region: rows (2, 2), metres, one line after another.

    spacing: metres between lines.  angle: radians, from the x axis to the y axis. Lines lie on one grid for all.
    Raises InputError where there would be too many.
    """
    if region.is_empty:
        return []
    along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    corners = shapely.get_coordinates(shapely.envelope(region))
    least, most = (corners @ across).min() / spacing, (corners @ across).max() / spacing
    if most - least > _MOST_LINES:
        raise InputError(f"its hatching takes over {_MOST_LINES} lines in one shape; hatch wider")
    points, ring = shapely.get_coordinates(shapely.get_rings(shapely.get_parts(region)), return_index=True)
    goes_on = ring[1:] == ring[:-1]
    place, row = points @ along, points @ across / spacing - 0.5  # in row n is what is n + 1/2 spacings from the origin
    numbers, places = _crossings(
        *(each[:-1][goes_on] for each in (place, row)), *(each[1:][goes_on] for each in (place, row))
    )
    begins, ends = places.reshape(-1, 2).T
    apart = np.ones(len(begins), dtype=np.bool_)
    apart[1:] = (np.diff(numbers[::2]) > 0) | (begins[1:] - ends[:-1] > SAME)  # or two parts touch there
    begins, ends, numbers = begins[apart], ends[np.roll(apart, -1)], numbers[::2][apart]
    rows = np.stack([begins, ends], axis=1)[..., None] * along + (spacing * (numbers + 0.5))[:, None, None] * across
    return list(rows[ends - begins >= _SHORTEST])


def _crossings(places: Floats, rows: Floats, next_places: Floats, next_rows: Floats) -> tuple[Ints, Floats]:
    """Return where edges of rings cross rows, in order: the numbers (k,) of the rows, and the places (k,) along them.

    places, rows: (E,), of the beginning of each edge; next_places, next_rows: of its end, which itself is not crossed.
    """
    first = np.ceil(np.minimum(rows, next_rows)).astype(np.int64)
    counts = np.ceil(np.maximum(rows, next_rows)).astype(np.int64) - first
    edge = np.repeat(np.arange(len(counts)), counts)
    number = first[edge] + np.arange(len(edge)) - np.repeat(np.cumsum(counts) - counts, counts)
    share = (number - rows[edge]) / (next_rows - rows)[edge]
    place = places[edge] + share * (next_places - places)[edge]
    order = np.lexsort([place, number])
    return number[order], place[order]


def _closed(ring: Floats) -> Floats:
    return ring if (ring[0] == ring[-1]).all() else np.concatenate([ring, ring[:1]])


def _winding(places: Floats, rings: Sequence[Floats]) -> Ints:
    """Return how often closed polylines go around each place (n, 2), counted against the clock in a y-up frame."""
    starts = np.concatenate([ring[:-1] for ring in rings])
    ends = np.concatenate([ring[1:] for ring in rings])
    edges = shapely.STRtree(shapely.linestrings(np.stack([starts, ends], axis=1)))
    right = np.column_stack([np.full(len(places), ends[:, 0].max()), places[:, 1]])
    rays = shapely.linestrings(np.stack([places, right], axis=1))
    winding = np.zeros(len(places), dtype=np.int64)
    rows = max(1, _CHUNK // len(starts))
    for begin in range(0, len(places), rows):
        place, edge = edges.query(rays[begin : begin + rows])  # those whose bounds a ray to the right meets
        (x, y), start, end = places[begin + place].T, starts[edge], ends[edge]
        side = (end[:, 0] - start[:, 0]) * (y - start[:, 1]) - (x - start[:, 0]) * (end[:, 1] - start[:, 1])
        up = (start[:, 1] <= y) & (end[:, 1] > y) & (side > 0)
        down = (start[:, 1] > y) & (end[:, 1] <= y) & (side < 0)
        np.add.at(winding, begin + place, up.astype(np.int64) - down)
    return winding


def _filled(winding: Ints, rule: str) -> Bools:
    filled: Bools = winding % 2 != 0 if rule == "evenodd" else winding != 0
    return filled
