"""Frame of the canvas, from the markers at three of its corners."""

from dataclasses import dataclass
from itertools import combinations, permutations

import numpy as np
from scipy.signal import savgol_filter

from maulstick.errors import InputError
from maulstick.recording.mocap.take import Take
from maulstick.storage.arrays import Bools, Floats, Ints

CORNERS = ("upper-left", "upper-right", "lower-right", "lower-left")
"""Corners of the sheet, as seen by the person who draws, clockwise: places of the marker at the right angle."""

_LEAST_SIDE, _MOST_SIDE = 0.02, 20.0  # metres between markers; anything else is a mistake in the units
_SKEW = np.radians(5.0)  # largest difference from a right angle
_MISFIT = 2e-3  # metres: a larger error of the distance between two markers is a swap or a reflection
_STILL = 2e-3  # metres: a smaller movement of the canvas counts as none
_BRIEF = 0.1  # seconds for which a canvas is assumed to move at constant speed
_SMOOTHED = 0.2  # seconds: window of the smoothing of markers


@dataclass(frozen=True)
class CanvasPath:
    """Frames of the canvas at F times.

    origins: (F, 3), upper left corner in the frame of the capture system, metres; NaN where it is unknown.
    rotations: (F, 3, 3); the columns are x (right), y (down) and z (into the paper, away from the pen).
    size: (width, height), metres.
    skew: angle at the corner minus a right angle, radians.
    swapped, mended, guessed: numbers of frames in which markers had swapped names, only two were usable, or fewer.
    """

    origins: Floats
    rotations: Floats
    size: tuple[float, float]
    skew: float
    swapped: int
    mended: int
    guessed: int

    def capture_to_canvas(self, points: Floats) -> Floats:
        """Transform points (F, 3), one per frame, metres, from the capture system to the canvas."""
        local: Floats = np.einsum("fji,fj->fi", self.rotations, points - self.origins)
        return local


def canvas_path(take: Take, corner: str = "upper-left") -> CanvasPath:
    """Find the canvas in each frame of a take; its marker at the right angle is in this `corner` of the sheet.

    The markers are identified anew in every frame, by their distances and the side that the pen is on, so that their
    names do not matter. In a frame with two markers the third moves with them from its interpolated place. In a frame
    with fewer, the canvas is interpolated, or unknown if it moved in between. The markers are then smoothed over a
    fifth of a second, and a rigid triangle is fitted to them.

    Raises InputError where the take shows no canvas, or no right angle.
    """
    check_corner(corner)
    whole: Bools = np.all(np.isfinite(take.canvas_markers), axis=(1, 2))
    if not whole.any():
        raise InputError("the three markers of the canvas are never seen together; let the cameras see all three")
    order = _order(take.canvas_markers[whole], _pen_body(take)[whole])
    ordered = np.full_like(take.canvas_markers, np.nan)
    ordered[whole] = np.take_along_axis(take.canvas_markers[whole], order[:, :, None], axis=1)
    sides = np.median(_sides(ordered[whole]), axis=0)
    skew = _skew(sides)
    good = whole.copy()
    good[whole] = (np.abs(_sides(ordered[whole]) - sides) < _MISFIT).all(axis=1)
    if good.sum() < whole.sum() / 2:
        raise InputError("the markers of the canvas move against each other; fasten them to it and record again")
    mended = _mend(take, ordered, good, sides)
    known = _guess(take.times, ordered, good | mended)
    template, size = _template(sides, skew, corner)
    origins, rotations = _fit(template, _smooth(take.times, ordered))
    origins[~known] = np.nan
    _, counts = np.unique(order[good[whole]], axis=0, return_counts=True)
    swapped = int(counts.sum() - counts.max())
    return CanvasPath(origins, rotations, size, skew, swapped, int(mended.sum()), int((known & ~good & ~mended).sum()))


def check_corner(corner: str) -> None:
    """Raise InputError for what is none of the `CORNERS`."""
    if corner not in CORNERS:
        raise InputError.of_choice("corner", corner, CORNERS)


def _pen_body(take: Take) -> Floats:
    """Centre (F, 3) of the visible markers of the pen; the origin of its rigid body may have been moved to the tip."""
    seen = np.isfinite(take.pen_markers)
    middles = np.where(seen, take.pen_markers, 0).sum(axis=1) / np.maximum(1, seen.sum(axis=1))
    return np.where(seen.any(axis=1), middles, take.pen_positions)


def _sides(triangles: Floats) -> Floats:
    """Distances (F, 3) between markers 0 and 1, 0 and 2, 1 and 2 of triangles (F, 3, 3)."""
    sides: Floats = np.linalg.norm(triangles[:, [0, 0, 1]] - triangles[:, [1, 2, 2]], axis=2)
    return sides


def _order(triangles: Floats, pen: Floats) -> Ints:
    """Indices (F, 3) of the marker at the right angle, then of the others, clockwise as seen from the pen."""
    corner = 2 - np.argmax(_sides(triangles), axis=1)  # opposite the longest side
    order = np.stack([corner, (corner + 1) % 3, (corner + 2) % 3], axis=1)
    at, first, second = (np.take_along_axis(triangles, order[:, [i], None], axis=1)[:, 0] for i in range(3))
    normals = np.cross(first - at, second - at)
    usual = np.linalg.eigh(normals.T @ normals)[1][:, -1]  # the canvas may turn, but not over
    middle = (first + second) / 2
    near = np.linalg.norm(pen - middle, axis=1) < np.linalg.norm(first - second, axis=1)
    heights = (pen - middle) @ usual
    seen = np.isfinite(heights)
    if not seen.any():
        raise InputError("the pen and the canvas are never seen together; let the cameras see both")
    away = usual * -np.sign(np.median(heights[near] if near.any() else heights[seen]))
    turned = normals @ away < 0
    order[turned] = order[turned][:, [0, 2, 1]]
    return order


def _skew(sides: Floats) -> float:
    """Angle between sides 0 and 1 minus a right angle, radians. Raises InputError where it is too large."""
    if not (sides.min() >= _LEAST_SIDE and sides.max() <= _MOST_SIDE):
        raise InputError(
            f"the markers of the canvas are {sides.min():.4g} to {sides.max():.4g} m apart; they must be 2 cm to 20 m "
            "apart: put them at three corners of the sheet, and check the units of the recording"
        )
    squares = sides**2
    cosines = [
        (squares.sum() - 2 * squares[i]) / (2 * sides[j] * sides[k]) for i, j, k in ((2, 0, 1), (1, 0, 2), (0, 1, 2))
    ]
    angles = np.arccos(np.clip(cosines, -1, 1))
    skew = float(angles[0] - np.pi / 2)
    if abs(skew) > _SKEW:
        raise InputError(
            "the markers of the canvas make angles of {:.0f}, {:.0f} and {:.0f} degrees; one must be a right angle, "
            "within 5 degrees: put them at three corners of the sheet".format(*np.degrees(angles))
        )
    return skew


def _mend(take: Take, ordered: Floats, good: Bools, sides: Floats) -> Bools:
    """Fill `ordered` (F, 3, 3) in frames that are not good, from any two markers at the right distance.

    Returns a mask (F,) of the frames in which that was possible.
    """
    frames = np.flatnonzero(~good)
    expected = _interpolate(take.times, ordered, good, frames)
    markers = take.canvas_markers[frames]
    best = np.full(len(frames), np.inf)
    for side, (i, j) in enumerate(combinations(range(3), 2)):
        for k, m in permutations(range(3), 2):
            moved = np.stack([markers[:, k] - expected[:, i], markers[:, m] - expected[:, j]])
            far = np.linalg.norm(moved, axis=2).sum(axis=0)
            apart = np.linalg.norm(markers[:, k] - markers[:, m], axis=1)
            better = (np.abs(apart - sides[side]) < _MISFIT) & (far < best)
            best[better] = far[better]
            shifted = expected[better] + moved[:, better].mean(axis=0)[:, None]
            shifted[:, i], shifted[:, j] = markers[better, k], markers[better, m]
            ordered[frames[better]] = shifted
    mended = np.zeros_like(good)
    mended[frames] = np.isfinite(best)
    return mended


def _guess(times: Floats, ordered: Floats, seen: Bools) -> Bools:
    """Interpolate `ordered` (F, 3, 3) in frames that were not seen; return a mask (F,) of the frames to be trusted."""
    frames, sightings = np.flatnonzero(~seen), np.flatnonzero(seen)
    ordered[frames] = _interpolate(times, ordered, seen, frames)
    place = np.searchsorted(sightings, frames)
    before, after = sightings[np.maximum(place - 1, 0)], sightings[np.minimum(place, len(sightings) - 1)]
    moved = np.linalg.norm(ordered[after] - ordered[before], axis=2).max(axis=1)
    known = np.ones_like(seen)
    known[frames] = (moved < _STILL) | (times[after] - times[before] < _BRIEF)
    return known


def _interpolate(times: Floats, values: Floats, known: Bools, frames: Ints) -> Floats:
    flat = values.reshape(len(values), -1)
    columns = [np.interp(times[frames], times[known], column[known]) for column in flat.T]
    return np.stack(columns, axis=1).reshape(-1, *values.shape[1:])


def _smooth(times: Floats, triangles: Floats) -> Floats:
    if len(times) < 2:
        return triangles
    half = round(_SMOOTHED / 2 / float(np.median(np.diff(times))))
    window = 2 * min(half, (len(times) - 1) // 2) + 1
    smooth: Floats = savgol_filter(triangles, window, 2, axis=0) if window > 3 else triangles
    return smooth


def _template(sides: Floats, skew: float, corner: str) -> tuple[Floats, tuple[float, float]]:
    """Return the places (3, 2) of the ordered markers on the sheet, and its size; both legs share the skew equally."""
    turns = CORNERS.index(corner)
    angles = np.array([-skew / 2, np.pi / 2 + skew / 2]) + turns * np.pi / 2
    first, second = sides[:2]
    width, height = (float(first), float(second)) if turns % 2 == 0 else (float(second), float(first))
    at = np.array([(0, 0), (width, 0), (width, height), (0, height)][turns])
    legs = np.stack([np.cos(angles), np.sin(angles)], axis=1) * sides[:2, None]
    return np.concatenate([at[None], at + legs]), (width, height)


def _fit(template: Floats, triangles: Floats) -> tuple[Floats, Floats]:
    """Fit origins (F, 3) and rotations (F, 3, 3) that put the flat template (3, 2) onto triangles (F, 3, 3).

    Least squares; since three points lie in a plane, Kabsch's problem is one of a single angle in it.
    """
    middles, middle = triangles.mean(axis=1), template.mean(axis=0)
    first = triangles[:, 1] - triangles[:, 0]
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    normals = np.cross(first, triangles[:, 2] - triangles[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    second = np.cross(normals, first)
    centred, offsets = triangles - middles[:, None], template - middle
    u, v = np.einsum("fmi,fi->fm", centred, first), np.einsum("fmi,fi->fm", centred, second)
    angles = np.arctan2(v @ offsets[:, 0] - u @ offsets[:, 1], u @ offsets[:, 0] + v @ offsets[:, 1])[:, None]
    x = np.cos(angles) * first + np.sin(angles) * second
    y = np.cross(normals, x)
    return middles - middle[0] * x - middle[1] * y, np.stack([x, y, normals], axis=2)
