"""Drift of the sheet between two photographs, seen by its edges, or else by what is painted on it."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.optimize import least_squares

from maulstick.calibration.camera import margin_px
from maulstick.calibration.tags import sampled
from maulstick.painting.raster import Canvas
from maulstick.robot.camera.opencv import opencv
from maulstick.storage.arrays import Bools, Floats, Image

MARGIN = 15e-3
"""Metres around the sheet that a photograph should keep, so that its edges are seen wherever it went."""

_STATIONS = 120  # along an edge, at each of which it is searched for
_ENDS = 0.12  # share of an edge at either end that is left out, as a card may lie there
_SMOOTH = 0.5e-3  # metres across an edge by which its profile is smoothed
_LEAST_MARGIN = 3e-3  # metres; in a narrower margin no edge is searched for
_NEAR = 0.6e-3  # metres from a straight edge within which a station counts as on it
_TRUE = 0.05e-3  # metres from it that a station usually lies, the scale of the robust fit
_AGREED = 0.5  # share of the stations that must lie on one straight edge
_INSIDE = 2e-3  # metres inside its place from which a lone edge may be that of a stroke; a sheet is laid more exactly
_CLEAR = 0.06  # sRGB: the least step that counts as an edge
_MARKED = 0.01  # sRGB, standard deviation: with less painted on it, nothing on the sheet can be followed
_ALIKE = 0.6  # least correlation of what is painted in two photographs
_COARSE_PX, _FINE_PX = 250, 700  # longer side of the photographs that are aligned, first and then
_STEPS, _SETTLED, _BLUR_PX = 100, 1e-5, 5  # of findTransformECC: steps at most, the gain that ends it, and a blur
_OUTSTANDING = 0.5  # share of the clearest step at a station that another step needs to be taken for the edge


@dataclass(frozen=True)
class Shift:
    """Shift of the sheet on what it lies on: a turn about its middle by dtheta, then a move by dx, dy.

    dx, dy: metres.  dtheta: radians, from x to y.
    confidence: in [0, 1], the share of the edges that agrees, or the correlation of what is painted.
    """

    dx: float
    dy: float
    dtheta: float
    confidence: float

    def furthest(self, canvas: Canvas) -> float:
        """Return how far the corner of the sheet that moved most went, metres."""
        half = np.array([canvas.width, canvas.height]) / 2
        corners = half * [[-1, -1], [1, -1], [1, 1], [-1, 1]]
        return float(np.linalg.norm(corners @ _turn(self.dtheta).T + (self.dx, self.dy) - corners, axis=1).max())


def shift_between(before: Image, after: Image, canvas: Canvas, margin: float = MARGIN) -> Shift | None:
    """Return how the sheet moved between two flat photographs, or None where that cannot be seen.

    before, after: (H, W, 3) sRGB in [0, 1], as `CameraView.rectify` makes them with the canvas and the margin.
    """
    here, there = sheet_place(before, canvas, margin), sheet_place(after, canvas, margin)
    if here is not None and there is not None:
        dtheta, confidence = there.dtheta - here.dtheta, min(here.confidence, there.confidence)
        # A sheet that lay beside its place turns about its own middle, and not about that of the canvas.
        dx, dy = (there.dx, there.dy) - _turn(dtheta) @ (here.dx, here.dy)
        return Shift(float(dx), float(dy), dtheta, confidence)
    around = margin_px(canvas, margin)
    inner = np.s_[around : around + canvas.height_px, around : around + canvas.width_px]
    return _shift_of_marks(before[inner], after[inner], canvas)


def sheet_place(wide: Image, canvas: Canvas, margin: float = MARGIN) -> Shift | None:
    """Return how far the sheet lies from its place in a flat photograph (H, W, 3) with a margin, by its edges.

    Three edges are enough; returns None where fewer are seen, and where the one whose opposite is not seen may be the
    rim of a broad stroke on the sheet.
    """
    if margin < _LEAST_MARGIN:
        return None
    found = [_edge(wide, canvas, margin, side) for side in range(4)]
    edges = [edge for edge in found if edge is not None]
    if len(edges) < 3 or any(
        edge is not None and opposite is None and edge.inside(canvas) > _INSIDE
        for edge, opposite in zip(found, found[2:] + found[:2], strict=True)
    ):
        return None
    points = np.concatenate([edge.points for edge in edges])
    normals = np.concatenate([np.broadcast_to(edge.normal, edge.points.shape) for edge in edges])
    half = np.array([canvas.width, canvas.height]) / 2
    home = np.abs(normals) @ half

    def misses(place: Floats) -> Floats:
        return np.asarray(((points - half - place[:2]) * (normals @ _turn(place[2]).T)).sum(axis=1) - home)

    dx, dy, dtheta = least_squares(misses, np.zeros(3), x_scale="jac", loss="cauchy", f_scale=_TRUE).x
    return Shift(float(dx), float(dy), float(dtheta), float(np.mean([edge.agreed for edge in edges])))


@dataclass(frozen=True)
class _Edge:
    """Edge of the sheet that was seen.

    points: (N, 2) on it, metres.  normal: (2,) outwards, of the sheet in its place.  agreed: share of stations on it.
    """

    points: Floats
    normal: Floats
    agreed: float

    def inside(self, canvas: Canvas) -> float:
        """Return how far it lies inside the edge of a sheet in its place, metres."""
        half = np.array([canvas.width, canvas.height]) / 2
        return float(np.abs(self.normal) @ half - ((self.points - half) @ self.normal).mean())


def _edge(wide: Image, canvas: Canvas, margin: float, side: int) -> _Edge | None:
    """Return the edge of the sheet on side 0 (right), 1 (bottom), 2 (left) or 3 (top); None where it is not seen."""
    normal = np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])[side]
    along = np.abs(normal[::-1])
    half = np.array([canvas.width, canvas.height]) / 2
    stations = np.linspace(_ENDS, 1 - _ENDS, _STATIONS) * (2 * half @ along)
    step = 0.5 / canvas.pixels_per_metre
    offsets = np.arange(margin, -margin, -step)  # from outside, where there are no strokes
    starts = along * stations[:, None] + normal * (normal > 0) * 2 * half
    places = starts[:, None] + offsets[:, None] * normal
    pixels = places * canvas.pixels_per_metre + margin_px(canvas, margin) - 0.5
    profiles = sampled(wide, pixels).mean(axis=-1, dtype=np.float64)
    sigma = max(_SMOOTH / step, 1.0)
    slope = np.abs(gaussian_filter1d(profiles, sigma, axis=1, order=1)) * sigma * np.sqrt(2 * np.pi)
    inner = slope[:, 1:-1]
    peaks = (inner >= slope[:, :-2]) & (inner > slope[:, 2:]) & (inner > _CLEAR)
    peaks &= inner > _OUTSTANDING * inner.max(axis=1, keepdims=True)
    seen = np.flatnonzero(peaks.any(axis=1))
    if len(seen) < _AGREED * _STATIONS:
        return None
    first = peaks[seen].argmax(axis=1) + 1
    left, top, right = (slope[seen, first + d] for d in (-1, 0, 1))
    finer = (left - right) / (2 * (left - 2 * top + right))
    found = margin - (first + finer) * step
    near = _on_a_line(stations[seen], found)
    points = (starts[seen] + found[:, None] * normal)[near]
    agreed = near.sum() / _STATIONS
    return _Edge(points, normal, float(agreed)) if agreed > _AGREED else None


def _on_a_line(x: Floats, y: Floats) -> Bools:
    """Return which points (N,) are near the straight line that most points are near; it is flatter than 1 in 4."""
    first, second = np.triu_indices(len(x), len(x) // 4)
    slopes = (y[second] - y[first]) / (x[second] - x[first])
    first, slopes = first[np.abs(slopes) < 0.25], slopes[np.abs(slopes) < 0.25]
    if not len(slopes):
        return np.zeros(len(x), dtype=bool)
    near = np.abs(y - y[first, None] - slopes[:, None] * (x - x[first, None])) < _NEAR
    return np.asarray(near[near.sum(axis=1).argmax()])


def _shift_of_marks(before: Image, after: Image, canvas: Canvas) -> Shift | None:
    """Return the shift by what is painted on the sheet in both photographs (H, W, 3), or None where it is not seen."""
    cv2 = opencv()
    warp, alike, pixels = np.eye(2, 3, dtype=np.float32), 0.0, 0.0
    for longest in (_COARSE_PX, _FINE_PX):
        scale = min(1.0, longest / max(before.shape[:2]))
        size = (max(1, round(before.shape[1] * scale)), max(1, round(before.shape[0] * scale)))
        here, there = (_painted(cv2.resize(image, size, interpolation=cv2.INTER_AREA)) for image in (before, after))
        if min(here.std(), there.std()) < _MARKED:
            return None
        if pixels:
            warp[:, 2] *= size[0] / canvas.width / pixels
        else:
            window = cv2.createHanningWindow(size, cv2.CV_32F)
            warp[:, 2] = cv2.phaseCorrelate(here, there, window)[0]
        pixels = size[0] / canvas.width
        steps = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, _STEPS, _SETTLED)
        try:
            alike, warp = cv2.findTransformECC(here, there, warp, cv2.MOTION_EUCLIDEAN, steps, None, _BLUR_PX)
        except cv2.error:  # the photographs have nothing in common
            return None
    if alike < _ALIKE:
        return None
    angle = float(np.arctan2(warp[1, 0], warp[0, 0]))
    middle = np.array([canvas.width, canvas.height]) / 2
    rest = 0.5 / pixels * np.ones(2)  # a pixel's centre is a whole number there
    dx, dy = _turn(angle) @ (middle - rest) + warp[:, 2] / pixels + rest - middle
    return Shift(float(dx), float(dy), angle, float(min(alike, 1.0)))


def _painted(image: Image) -> Image:
    """Return the difference (H, W) of a photograph from its blurred self: what is painted, without the lamp's light."""
    cv2 = opencv()
    grey = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)
    return np.asarray(grey - cv2.GaussianBlur(grey, (0, 0), max(image.shape) / 8))


def _turn(angle: float) -> Floats:
    """Return the rotation (2, 2) by an angle in radians, from x to y."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
