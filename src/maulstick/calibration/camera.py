"""The camera's view of the sheet, from tags or clicked corners: photographs become flat images of the canvas."""

from math import ceil
from pathlib import Path
from typing import Annotated, Final, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, field_validator
from scipy.optimize import least_squares

from maulstick.calibration.tags import found_tags, is_mirrored, repeated_tags
from maulstick.errors import InputError
from maulstick.painting.raster import Canvas
from maulstick.robot.camera.opencv import opencv
from maulstick.robot.camera.tag_frame import TAGS, TagFrame
from maulstick.storage.arrays import Floats, Image
from maulstick.storage.records import read_record, write_record

SCHEMA_VERSION: Final = 1
"""Version of the file of a view."""

_FEWEST = 3  # tags, so that one may be hidden
_USUAL = (0.02, 0.02, 0.3, 0.1)
"""Usual offset of a lens from the middle, and usual distortion, one sigma: what the fit assumes before it sees tags."""

_DOUBT_PX = 0.1  # pixels: error of a tag's corner, one sigma, which weighs corners against the usual lens
_LEAST = 0.1  # least share of its variance that is believed: four tags may fit better by luck
_LOOSE = 0.08  # sides of a tag that a corner may miss its place by; more means that cards or sizes are wrong
_GRID = 15  # places across the sheet at which the standard error is computed
_FINEST = 8  # samples across a pixel of the canvas at most, which bounds the memory
_NEWTON = 8  # steps, enough from a distortion of a few per cent to rounding
_RIM_PX = 1.0  # pixels by which a corner may lie outside: clicks on the rim, and rounding
_FLATTEST = 1e9  # condition of a homography: beyond it the sheet is seen as a line
_NAMES = ("upper left", "upper right", "lower right", "lower left")
_Side = Annotated[int, Field(gt=0)]
_Row = tuple[float, float, float]
_Small = Annotated[float, Field(gt=-1, lt=1)]


class CameraView(BaseModel):
    """View of the sheet in a photograph.

    size: width and height of the photograph, pixels.
    homography: from metres on the sheet to the photograph of a perfect lens, in units in which its middle is (0, 0) and
    its corners are at distance 1.  centre: of the lens, in the same units.  bend: radial distortion, which takes a
    distance r from the centre to r (1 + b0 r² + b1 r⁴).
    tags: the tags that it was found by, none for clicked corners.
    error: standard error of a place on the sheet, metres, root mean square and worst; None for clicked corners.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    schema_version: Literal[1] = SCHEMA_VERSION
    size: tuple[_Side, _Side]
    homography: tuple[_Row, _Row, _Row]
    centre: tuple[_Small, _Small] = (0.0, 0.0)
    bend: tuple[_Small, _Small] = (0.0, 0.0)
    tags: tuple[int, ...] = ()
    error: tuple[float, float] | None = None

    @field_validator("homography")
    @classmethod
    def _shows_an_area(cls, homography: tuple[_Row, _Row, _Row]) -> tuple[_Row, _Row, _Row]:
        if not np.linalg.cond(np.array(homography)) < _FLATTEST:
            raise ValueError("it shows the sheet as a line; look at the sheet again")
        return homography

    @property
    def hidden(self) -> tuple[int, ...]:
        """Tags that were not seen, none where the view is of clicked corners."""
        return tuple(tag for tag in TAGS if tag not in self.tags) if self.tags else ()

    def to_photo(self, points: Floats) -> Floats:
        """Return the pixels (..., 2) of points (..., 2) on the sheet, metres; pixel centres are whole numbers."""
        numbers = np.array([*np.ravel(self.homography), *self.centre, *self.bend])
        return _to_photo(numbers, points) * _scale(self.size) + _middle(self.size)

    def to_canvas(self, pixels: Floats) -> Floats:
        """Return the places (..., 2) on the sheet, metres, of pixels (..., 2) of the photograph."""
        bent = (pixels - _middle(self.size)) / _scale(self.size) - self.centre
        distance = np.linalg.norm(bent, axis=-1, keepdims=True)
        straight, (b0, b1) = distance, self.bend
        for _ in range(_NEWTON):
            excess = straight * (1 + b0 * straight**2 + b1 * straight**4) - distance
            straight = straight - excess / (1 + 3 * b0 * straight**2 + 5 * b1 * straight**4)
        ideal = bent * straight / np.maximum(distance, 1e-12) + self.centre
        return _mapped(np.linalg.inv(np.array(self.homography)), ideal)

    def check_sees(self, width: float, height: float) -> None:
        """Raise InputError where a corner of a sheet of that size, metres, is outside the photograph."""
        _check_seen(self.to_photo(_outline(width, height)), self.size, "let the camera see all of it")

    def rectify(self, photo: Image, canvas: Canvas, margin: float = 0.0) -> Image:
        """Rectify the photograph (H, W, 3): returns the sheet, flat, in the canvas' pixels, (height_px, width_px, 3).

        margin: metres around the sheet that are kept too, which adds `margin_px` pixels on each side.
        What the camera does not see repeats the photograph's edge.  Raises InputError for a photograph of another size.
        """
        if photo.shape[:2] != self.size[::-1]:
            came, wanted = f"{photo.shape[1]} x {photo.shape[0]}", f"{self.size[0]} x {self.size[1]}"
            raise InputError(
                f"the photograph has {came} pixels, and the camera was calibrated with {wanted}; do it again"
            )
        cv2 = opencv()
        around = margin_px(canvas, margin)
        wide, high = canvas.width_px + 2 * around, canvas.height_px + 2 * around
        finer = self._samples(canvas)
        x = (np.arange(wide * finer) + 0.5) / finer - around
        y = (np.arange(high * finer) + 0.5) / finer - around
        places = np.stack(np.meshgrid(x, y), axis=-1) / canvas.pixels_per_metre
        at = self.to_photo(places).astype(np.float32)
        fine = cv2.remap(photo, at, None, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
        flat = cv2.resize(fine, (wide, high), interpolation=cv2.INTER_AREA)
        return np.asarray(flat).clip(0, 1)

    def _samples(self, canvas: Canvas) -> int:
        """Return the number of samples across a pixel of the canvas that leaves out no pixel of the photograph."""
        corners = _outline(canvas.width, canvas.height)
        step = 1 / canvas.pixels_per_metre
        steps = [self.to_photo(corners + np.array(d) * step) - self.to_photo(corners) for d in ((1, 0), (0, 1))]
        return min(max(ceil(float(np.linalg.norm(steps, axis=-1).max())), 1), _FINEST)


def margin_px(canvas: Canvas, margin: float) -> int:
    """Return a margin around the canvas, metres, in whole pixels. Raises InputError where it is below 0."""
    if not margin >= 0:
        raise InputError.of_range("the margin around the sheet", f"{margin:g} m", "at least 0")
    return round(margin * canvas.pixels_per_metre)


def locate(photo: Image, frame: TagFrame) -> CameraView:
    """Find the view in a photograph (H, W, 3), sRGB in [0, 1], of a sheet with its tags.

    Three tags are enough (`CameraView.hidden` says which one is missing).
    Raises InputError where fewer are seen, where they do not lie as the frame says, and where a corner of the sheet is
    outside the photograph.
    """
    found = found_tags(photo)
    if len(found) < _FEWEST:
        if repeated := repeated_tags(photo):
            twice = f"more than one tag {repeated[0]} ({_NAMES[repeated[0]]}) is seen"
            raise InputError(f"{twice}; take away all but the four tags at the corners of the sheet")
        if not found and is_mirrored(photo):
            raise InputError("the photograph is mirrored; turn that off where the camera, or its app, is set")
        seen = f"only {len(found)} of the 4 tags {'is' if len(found) == 1 else 'are'} seen ({_listed(found)})"
        places = ", ".join(f"{tag} ({_NAMES[tag]})" for tag in TAGS if tag not in found)
        raise InputError(f"{seen if found else 'none of the 4 tags is seen'}; uncover and light {places}")
    points = np.concatenate([frame.corners(tag) for tag in found])
    size = (photo.shape[1], photo.shape[0])
    pixels = np.concatenate(list(found.values()))
    numbers, covariance = _fitted(points, pixels, size)
    missed = np.linalg.norm(_to_photo(numbers, points) * _scale(size) + _middle(size) - pixels, axis=1).max()
    if missed > _LOOSE * np.linalg.norm(pixels[1] - pixels[0]):
        far = 1e3 * frame.side * missed / np.linalg.norm(pixels[1] - pixels[0])
        wanted = f"a sheet of {1e3 * frame.width:g} x {1e3 * frame.height:g} mm and tags of {1e3 * frame.side:g} mm"
        raise InputError(
            f"a tag is {far:.0f} mm off its place beside {wanted}; put the cards right or mend those sizes"
        )
    view = _view(size, numbers)
    view.check_sees(frame.width, frame.height)
    error = _standard_error(view, numbers, covariance, frame)
    return view.model_copy(update={"tags": tuple(found), "error": error})


def view_of_corners(corners: Floats, sheet: tuple[float, float], size: tuple[int, int]) -> CameraView:
    """Return the view, by a lens without distortion, in which the sheet's corners were clicked.

    corners: (4, 2) pixels, upper left, upper right, lower right, lower left.  sheet: width and height, metres.
    size: of the photograph, pixels.  Raises InputError where they are not such corners.
    """
    corners = np.asarray(corners, dtype=np.float64)
    if corners.shape != (4, 2) or not np.isfinite(corners).all():
        raise InputError("the sheet's corners must be four points in pixels, each as x,y")
    sides = np.roll(corners, -1, axis=0) - corners
    onwards = np.roll(sides, -1, axis=0)
    if not (sides[:, 0] * onwards[:, 1] - sides[:, 1] * onwards[:, 0] > 1).all():
        raise InputError(f"the corners must go round the sheet as a clock does: {', '.join(_NAMES)}; give them so")
    _check_seen(corners, size, "give its corners in pixels of this photograph")
    homography, _ = opencv().findHomography(_outline(*sheet), (corners - _middle(size)) / _scale(size))
    return _view(size, np.append(homography.ravel(), np.zeros(4)))


def write_view(view: CameraView, path: str | Path) -> None:
    """Write a view as JSON. Raises OutputError where that fails; what was at `path` is then still there."""
    write_record(view, path)


def read_view(path: str | Path) -> CameraView:
    """Read the view in the file at `path`. Raises InputError where there is none."""
    return read_record(CameraView, path, "camera's view")


def _fitted(points: Floats, pixels: Floats, size: tuple[int, int]) -> tuple[Floats, Floats]:
    """Fit the numbers (13,) of a view that take points (N, 2) to pixels (N, 2); returns them and a covariance (12, 12).

    The covariance leaves out the homography's last number, which is 1. The fit is of a homography rather than of a pose
    and a focal length, which cannot be told apart from straight above. The lens' four numbers stay near those of usual
    lenses where the points do not determine them.
    """
    seen = (pixels - _middle(size)) / _scale(size)
    start, _ = opencv().findHomography(points, seen)
    span = np.abs(points).max()
    units = np.array([1 / span, 1 / span, 1, 1 / span, 1 / span, 1, 1 / span, 1 / span, *_USUAL])
    doubt = _DOUBT_PX / _scale(size)

    def misses(scaled: Floats) -> Floats:
        apart = (_to_photo(_with_last(scaled * units), points) - seen) / doubt
        return np.append(apart.ravel(), scaled[8:])

    flat = np.append((start / start[2, 2]).ravel()[:8] / units[:8], np.zeros(4))
    found = least_squares(misses, flat, method="lm")
    apart = misses(found.x)[: 2 * len(points)]
    together = 4 * np.sum(apart**2) / (apart.size - 8)  # the four corners of a tag are wrong together
    slopes = np.asarray(found.jac)
    inverse = np.linalg.inv(slopes.T @ slopes) * max(together, _LEAST)
    return _with_last(found.x * units), inverse * np.outer(units, units)


def _standard_error(view: CameraView, numbers: Floats, covariance: Floats, frame: TagFrame) -> tuple[float, float]:
    """Return the standard error of places all over the sheet, metres: root mean square and worst."""
    x, y = np.linspace(0, frame.width, _GRID), np.linspace(0, frame.height, _GRID)
    places = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    pixels = view.to_photo(places)
    steps = np.sqrt(np.diag(covariance)) * 1e-2
    free = np.delete(numbers, 8)
    slopes = [
        (_view(view.size, _with_last(free + step)).to_canvas(pixels) - places) / step.sum() for step in np.diag(steps)
    ]
    slope = np.stack(slopes, axis=-1)
    squared = np.einsum("nci,ij,ncj->n", slope, covariance, slope)
    return float(np.sqrt(squared.mean())), float(np.sqrt(squared.max()))


def _outline(width: float, height: float) -> Floats:
    """Return the corners (4, 2) of a sheet on itself, metres, as in _NAMES."""
    return np.array([[0, 0], [width, 0], [width, height], [0, height]], dtype=np.float64)


def _check_seen(corners: Floats, size: tuple[int, int], remedy: str) -> None:
    """Raise InputError where one of a sheet's corners (4, 2), pixels, lies outside a photograph of that size."""
    outside = ((corners < -_RIM_PX) | (corners > np.array(size) - 1 + _RIM_PX)).any(axis=1)
    if outside.any():
        first = int(outside.argmax())
        x, y = corners[first]
        raise InputError(
            f"the {_NAMES[first]} corner of the sheet is at {x:.0f},{y:.0f}, outside the photograph of "
            f"{size[0]} x {size[1]} pixels; {remedy}"
        )


def _with_last(free: Floats) -> Floats:
    """Return the numbers (13,) of a view from the free ones (12,), with the homography's last, which is 1."""
    return np.insert(free, 8, 1.0)


def _view(size: tuple[int, int], numbers: Floats) -> CameraView:
    rows = numbers[:9].reshape(3, 3).tolist()
    lens = {"centre": tuple(numbers[9:11].tolist()), "bend": tuple(numbers[11:].tolist())}
    return CameraView.model_validate({"size": size, "homography": rows, **lens})


def _to_photo(numbers: Floats, points: Floats) -> Floats:
    """Return points (..., 2), metres, in the photograph, in units in which its corners are at distance 1."""
    off = _mapped(numbers[:9].reshape(3, 3), points) - numbers[9:11]
    squared = (off**2).sum(axis=-1, keepdims=True)
    return np.asarray(numbers[9:11] + off * (1 + numbers[11] * squared + numbers[12] * squared**2))


def _mapped(homography: Floats, points: Floats) -> Floats:
    mapped = points @ homography[:, :2].T + homography[:, 2]
    return np.asarray(mapped[..., :2] / mapped[..., 2:])


def _middle(size: tuple[int, int]) -> Floats:
    return (np.array(size) - 1) / 2


def _scale(size: tuple[int, int]) -> float:
    return float(np.hypot(*size)) / 2


def _listed(tags: dict[int, Floats]) -> str:
    return ", ".join(map(str, tags))
