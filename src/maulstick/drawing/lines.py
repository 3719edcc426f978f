"""Polylines of curves, and polylines cut at the edges of a region."""

from collections.abc import Sequence
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from maulstick.drawing.document import NO_PLACE
from maulstick.errors import InputError
from maulstick.storage.arrays import Floats, Ints

FLATNESS: Final = 1.5e-5
"""Metres that a polyline departs from its Béziers at most, which leaves room for what they depart from an arc."""

MOST_POINTS: Final = 4_000_000
"""Points of all polylines of a drawing: they take some 2 GB as a painting."""

SAME: Final = 1e-9
"""Metres, or a share of a step: less is rounding."""

_MOST_PARTS = 10_000  # of one curve: one of 20 m with the tightest bend takes fewer
_FARTHEST = 1e5  # metres: beyond, numbers are damaged


def bounds_of(chains: Sequence[Floats]) -> Floats:
    """Return the least and the largest coordinates, (2, 2), of chains of cubic Béziers (m, 4, 2), at least one."""
    p, q, r, s = np.moveaxis(np.concatenate(chains), 1, 0)
    a, b, c = s - p + 3 * (q - r), 2 * (p - 2 * q + r), q - p  # of the slope, a t² + b t + c
    root = np.sqrt(np.maximum(b * b - 4 * a * c, 0))
    half = -0.5 * (b + np.where(b < 0, -root, root))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        turns = [np.nan_to_num(t, nan=0, posinf=0, neginf=0).clip(0, 1) for t in (half / a, c / half)]
    points = np.stack([p, s, *(_at(t, p, q, r, s) for t in turns)])
    return np.stack([points.min(axis=(0, 1)), points.max(axis=(0, 1))])


def _at(t: Floats, p: Floats, q: Floats, r: Floats, s: Floats) -> Floats:
    """Return cubic Béziers of these points at t, which are alike in shape."""
    u = 1 - t
    point: Floats = u * u * u * p + 3 * (u * u * t) * q + 3 * (u * t * t) * r + t * t * t * s
    return point


def polylines(chains: Sequence[Floats], turn: Floats, shift: Floats) -> list[Floats]:
    """Return polylines (k, 2), metres, of chains of cubic Béziers (m, 4, 2), to within `FLATNESS`.

    turn (2, 2), shift (2,): metres = points @ turn + shift.
    Raises InputError where a point has no place, or the polylines take more than `MOST_POINTS`.
    """
    if not chains:
        return []
    cubics = np.concatenate(chains) @ turn + shift
    if not (np.abs(cubics) < _FARTHEST).all():
        raise InputError(NO_PLACE)
    parts = _parts(cubics)
    if parts.sum() + len(chains) > MOST_POINTS:
        raise InputError(f"its curves come to over {MOST_POINTS} points; draw it in parts")
    which = np.repeat(np.arange(len(cubics)), parts)
    last = np.cumsum(parts)
    t = ((np.arange(len(which)) - (last - parts)[which] + 1) / parts[which])[:, None]
    points = _at(t, *(cubics[which, i] for i in range(4)))
    sizes = np.array([len(chain) for chain in chains])
    firsts = np.cumsum(sizes) - sizes
    ends = last[firsts + sizes - 1]
    begins = np.concatenate([[0], ends[:-1]])
    return [np.concatenate([cubics[first, :1], points[i:j]]) for first, i, j in zip(firsts, begins, ends, strict=True)]


def _parts(cubics: Floats) -> Ints:
    """Return into how many equal parts of its parameter each curve is cut, (M,): Wang's bound."""
    bend = np.linalg.norm(np.diff(cubics, n=2, axis=1), axis=2).max(axis=1)
    bend[bend < SAME] = 0.0
    parts: Ints = np.ceil(np.sqrt(0.75 * bend / FLATNESS)).clip(1, _MOST_PARTS).astype(np.int64)
    return parts


def lengths(lines: Sequence[Floats]) -> Floats:
    """Return the length of each polyline (k, 2), metres."""
    return np.array([np.hypot(*np.diff(line, axis=0).T).sum() for line in lines])


def cut(lines: Sequence[Floats], region: BaseGeometry) -> list[list[Floats]]:
    """Return the pieces of each polyline (k, 2) that lie in a region, its edges included, in their order.

    Each step is cut by itself, so that a line that crosses itself stays in one piece.
    """
    shapely.prepare(region)
    pieces: list[list[Floats]] = []
    parts, corners = shapely.get_parts(region), shapely.STRtree(shapely.points(shapely.get_coordinates(region)))
    tree = shapely.STRtree(parts) if region.geom_type == "MultiPolygon" else None
    for line, inside in zip(lines, _inside(lines, region), strict=True):
        if inside is not None:
            pieces.append([line] if inside else [])
        elif tree is None:
            pieces.append(_pieces(line, region, corners))
        else:  # of many parts few are near
            near = shapely.multipolygons(parts[tree.query(shapely.LineString(line))])
            pieces.append(_pieces(line, near, corners))
    return pieces


def _inside(lines: Sequence[Floats], region: BaseGeometry) -> list[bool | None]:
    """Return of each line whether it lies in the region, or None where only a part of it does."""
    if not lines:
        return []
    points = np.concatenate([line[[0, *range(len(line))]] if len(line) == 1 else line for line in lines])
    owners = np.repeat(np.arange(len(lines)), [max(len(line), 2) for line in lines])
    shapes = shapely.linestrings(points, indices=owners)
    covered, touched = shapely.covers(region, shapes), shapely.intersects(region, shapes)
    dots = np.array([np.ptp(line, axis=0).max() < SAME for line in lines])
    if dots.any():
        places = np.array([line[0] for line, dot in zip(lines, dots, strict=True) if dot])
        covered[dots] = touched[dots] = shapely.covers(region, shapely.points(places))
    return [True if all_of else (None if any_of else False) for all_of, any_of in zip(covered, touched, strict=True)]


def _pieces(line: Floats, region: BaseGeometry, corners: shapely.STRtree) -> list[Floats]:
    starts, steps = line[:-1], np.diff(line, axis=0)
    moving = np.flatnonzero(np.hypot(*steps.T) > SAME)
    starts, steps = starts[moving], steps[moving]
    found = shapely.intersection(_through(corners, np.stack([starts, starts + steps], axis=1)), region)
    parts, which = shapely.get_parts(found, return_index=True)
    kept = (shapely.get_type_id(parts) == shapely.GeometryType.LINESTRING) & ~shapely.is_empty(parts)
    parts, which = parts[kept], which[kept]
    if not len(parts):
        return []
    ends = np.stack([shapely.get_coordinates(shapely.get_point(parts, end)) for end in (0, -1)], axis=1)
    along = steps[which] / (steps[which] ** 2).sum(axis=1, keepdims=True)
    shares = np.sort(((ends - starts[which][:, None]) * along[:, None]).sum(axis=2), axis=1)
    shares[np.abs(shares) < SAME], shares[np.abs(shares - 1) < SAME] = 0.0, 1.0
    pieces: list[list[Floats]] = []
    last, left = -1, 0.0  # the step of the latest piece, and the share of it where that ended
    for i in np.lexsort([shares[:, 0], which]):
        step, (begin, end) = int(which[i]), shares[i]
        if begin == end:  # rounding, where the line only touches the region
            continue
        goes_on = begin == left if step == last else step == last + 1 and (left, begin) == (1.0, 0.0)
        if not pieces or not goes_on:
            pieces.append([starts[step] + begin * steps[step]])
        pieces[-1].append(starts[step] + end * steps[step])
        last, left = step, end
    return [np.array(piece) for piece in pieces]


def _through(corners: shapely.STRtree, steps: Floats) -> NDArray[np.object_]:
    """Return steps (k, 2, 2) as lines with a point at each corner on them, or rounding puts edges out of a region."""
    lines = np.atleast_1d(shapely.linestrings(steps))
    step, corner = corners.query(lines, predicate="dwithin", distance=SAME)
    with_corners, owner = np.unique(step, return_inverse=True)
    if len(step):
        on_them = shapely.multipoints(corners.geometries[corner], indices=owner)
        lines[with_corners] = shapely.snap(lines[with_corners], on_them, SAME)
    return lines
