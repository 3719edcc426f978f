"""Windows: the parts of a trial's photographs around its stroke, checked and corrected for the light."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import ndimage
from scipy.signal import correlate
from skimage.measure import label

from maulstick.brush_fit.trials import Trial
from maulstick.errors import InputError
from maulstick.storage.arrays import Bools, Floats, Pixels
from maulstick.strokes.strokes import resample

STRAY = 2.5e-3
"""Largest distance from the commanded path, metres, at which a change is taken for a part of the stroke."""

SEEN = 0.08
"""Least change of a pixel that counts as covered, where the photographs are not noisier than that."""

_NOISES = 7  # least change of a covered pixel, in quartiles of the change of bare paper
_LOOSE_PX = 1  # pixels around a speck that are left out too, because of its soft edge
_ALIGNING_PX = 512  # longer side of the pictures in which a movement of the camera is looked for
_MOVED_PX = 1.0  # least movement, in pixels of the photograph, that makes a trial unusable
_GAIN = 0.4  # share of the difference that a shift must explain to be taken for a movement of the camera
_LEAST_ALIGNING_PX, _AROUND_PX = 200, 5  # pixels of older strokes that are needed for it, and margin around them
_LEAST_INK_PX = 4.0  # pixels of full change that make a mark
_LEAST_LIT_PX, _ENOUGH_LIT_PX = 50, 10_000  # pixels of bare paper: fewest and most that the light is fitted to
_CLIPPED = 0.99  # a photograph with no darker pixel is overexposed
_DARK = 0.1  # lit paper is brighter
_CROSSED, _OLD_INK = 0.02, 0.15  # share of covered pixels on older ink, and how much such ink differs from the paper

_SHAPE_POINTS = 64  # points of a path that is compared with its mark as a shape
_CLEARLY = 1.25  # how much farther marks lie from their paths than from the turned ones; S-shapes and lines: 1


@dataclass(frozen=True)
class Window:
    """Part of a trial's photographs around its stroke.

    name: of its trial.  path: (n, 3) as in `Trial`.  corner: (x, y) of the upper left pixel, metres.
    before, after: (h, w, C) in [0, 1], `after` corrected to the light of `before`.
    weights: (h, w), 0 where something else than the stroke changed.  covered: (h, w), where the stroke is seen.
    """

    name: str
    path: Floats
    corner: tuple[float, float]
    before: Pixels
    after: Pixels
    weights: Pixels
    covered: Bools


def look(trial: Trial, pixels_per_metre: float, reach: float, reduced: int = 1) -> Window:
    """Return the window of a trial, `reach` metres larger than its path on every side, scaled down by `reduced`.

    Specks apart from the stroke get no weight. Differences of light between the photographs are corrected, also where
    they change linearly across the window. Raises InputError, naming the trial, for a stroke that cannot be seen or
    measured: no mark, a black or overexposed photograph, a path outside the photographs, a camera that moved.
    """
    top, left, bottom, right = _box(trial, pixels_per_metre, reach, reduced)
    before, after = (_reduced(image[top:bottom, left:right], reduced) for image in (trial.before, trial.after))
    scale = pixels_per_metre / reduced
    corner = (left / pixels_per_metre, top / pixels_per_metre)
    apart = _distances(trial.path, corner, before.shape[:2], scale)
    if trial.after.shape[2] > 1:
        _check_light(trial.name, before, after)
        _check_camera(trial, pixels_per_metre, reach)
        after = _relit(before, after, apart > reach / 2)
    change = np.abs(after - before).mean(axis=2)
    noise = float(np.quantile(change[apart > STRAY], 0.25)) if (apart > STRAY).any() else 0.0  # a broad mark is there
    covered = change > max(SEEN, _NOISES * noise)
    stray = _stray(covered, apart)
    covered &= ~stray
    if change[covered].sum() < _LEAST_INK_PX:
        raise InputError(
            f"{trial.name} left no mark that can be seen near its path; was the tip on the paper, and the lens open?"
        )
    return Window(trial.name, trial.path, corner, before, after, (~stray).astype(np.float32), covered)


def extent(window: Window, pixels_per_metre: float) -> float:
    """Distance from the commanded path up to which the stroke is seen, metres."""
    apart = _distances(window.path, window.corner, window.covered.shape, pixels_per_metre)
    return float(np.quantile(apart[window.covered], 0.99))


def crosses(windows: Sequence[Window]) -> bool:
    """Return whether enough of the strokes lies on older ink to tell how opaque they are."""
    covered = crossed = 0
    for window in windows:
        paper = np.median(window.before, axis=(0, 1))
        old = np.abs(window.before - paper).mean(axis=2) > _OLD_INK
        covered += int(window.covered.sum())
        crossed += int((window.covered & old).sum())
    return crossed > _CROSSED * covered


def turned(windows: Sequence[Window], pixels_per_metre: float) -> bool:
    """Return whether the marks are seen as their paths turned by 180 degrees rather than as the paths themselves.

    Only shapes are compared, about their middles, since a turned window of one stroke still shows it near its path.
    """
    straight = upside_down = 0.0
    for window in windows:
        path = resample(window.path, _SHAPE_POINTS)[:, :2]
        seen = np.argwhere(window.covered)[:, ::-1] + 0.5
        middle = seen.mean(axis=0) / pixels_per_metre + window.corner
        of_shape = path - path.mean(axis=0)
        as_is, over = (
            _distances(middle + shape, window.corner, window.covered.shape, pixels_per_metre)[window.covered].mean()
            for shape in (of_shape, -of_shape)
        )
        straight, upside_down = straight + float(as_is), upside_down + float(over)
    return straight > _CLEARLY * upside_down


def _box(trial: Trial, pixels_per_metre: float, reach: float, reduced: int) -> tuple[int, int, int, int]:
    height, width = trial.after.shape[:2]
    low = np.floor((trial.path[:, :2].min(axis=0) - reach) * pixels_per_metre).astype(int)
    high = np.ceil((trial.path[:, :2].max(axis=0) + reach) * pixels_per_metre).astype(int)
    left, top = np.clip(low, 0, (width, height))
    right, bottom = np.clip(high, 0, (width, height))
    bottom, right = bottom - (bottom - top) % reduced, right - (right - left) % reduced
    outside = np.maximum(0 - trial.path[:, :2], trial.path[:, :2] - np.array([width, height]) / pixels_per_metre)
    if outside.max() > reach or min(bottom - top, right - left) < 2 * reduced:
        raise InputError(f"{trial.name} lies beside its photographs; check the pixels per metre and the paths")
    return int(top), int(left), int(bottom), int(right)


def _reduced(image: Pixels, by: int) -> Pixels:
    """Return means over squares of `by` pixels; never a view, which would keep the whole photograph in memory."""
    height, width = image.shape[0] // by, image.shape[1] // by
    rows = image[: height * by, : width * by].reshape(height, by, width * by, -1).mean(axis=1)
    return np.asarray(rows.reshape(height, width, by, -1).mean(axis=2))


def _distances(path: Floats, corner: tuple[float, float], shape: tuple[int, ...], pixels_per_metre: float) -> Floats:
    """Distance of each pixel's centre to the path, metres, to about a pixel."""
    length = np.hypot(*np.diff(path[:, :2], axis=0).T).sum()
    fine = resample(path, 2 + int(2 * length * pixels_per_metre))[:, :2]
    places = np.floor((fine - corner) * pixels_per_metre).astype(int)
    inside = ((places >= 0) & (places < (shape[1], shape[0]))).all(axis=1)
    places = np.clip(places, 0, (shape[1] - 1, shape[0] - 1)) if not inside.any() else places[inside]
    free = np.ones(shape[:2], dtype=bool)
    free[places[:, 1], places[:, 0]] = False
    distances: Floats = ndimage.distance_transform_edt(free) / pixels_per_metre
    return distances


def _stray(covered: Bools, apart: Floats) -> Bools:
    """Return a mask of changed pixels that are not connected to the surroundings of the path."""
    parts = label(covered, connectivity=2)
    nearest = np.asarray(ndimage.minimum(apart, parts, np.arange(parts.max() + 1)))
    of_others = nearest > STRAY
    of_others[0] = False
    strays = of_others[parts]
    grown: Bools = ndimage.binary_dilation(strays, iterations=_LOOSE_PX) & ~(covered & ~strays)
    return grown


def _relit(before: Pixels, after: Pixels, paper: Bools) -> Pixels:
    """Return `after` in the light of `before`: per channel, the log ratio on bare paper is fitted by a plane."""
    height, width = paper.shape
    y, x = np.mgrid[-1 : 1 : height * 1j, -1 : 1 : width * 1j]
    relit = after.copy()
    for channel in range(after.shape[2]):
        old, new = before[..., channel], after[..., channel]
        lit = np.flatnonzero(paper & (old > _DARK) & (new > _DARK))
        if len(lit) < _LEAST_LIT_PX:
            continue
        lit = lit[:: 1 + len(lit) // _ENOUGH_LIT_PX]
        ratio = np.log(old.flat[lit] / new.flat[lit])
        plane = np.stack([np.ones(len(lit)), x.flat[lit], y.flat[lit]], axis=1)
        kept = np.abs(ratio - np.median(ratio)) < 0.3
        for _ in range(3):  # leaves out the edges of older strokes, and specks
            light = np.linalg.lstsq(plane[kept], ratio[kept], rcond=None)[0]
            rest = np.abs(ratio - plane @ light)
            kept = rest <= 3 * np.median(rest) + 1e-6
        relit[..., channel] = new * np.exp(light[0] + light[1] * x + light[2] * y)
    return relit


def _check_light(name: str, before: Pixels, after: Pixels) -> None:
    """Raise InputError where the photograph after the stroke is all white, or one of the two all black."""
    if after.min() > _CLIPPED:
        raise InputError(f"{name} cannot be seen: its photograph after it is all white; was it overexposed?")
    for which, image in (("before", before), ("after", after)):
        if image.max() < _DARK:
            raise InputError(f"{name} cannot be seen: its photograph {which} it is all black; light the paper")


def _check_camera(trial: Trial, pixels_per_metre: float, reach: float) -> None:
    """Raise InputError where older strokes, away from the new one, have moved between the photographs."""
    factor = -(-max(trial.after.shape[:2]) // _ALIGNING_PX)
    before, after = (_reduced(image, factor).mean(axis=2, keepdims=True) for image in (trial.before, trial.after))
    away = _distances(trial.path, (0.0, 0.0), before.shape, pixels_per_metre / factor) > reach
    even = np.full_like(before, np.median(before))
    old, new = ((even - _relit(even, image, away))[..., 0] for image in (before, after))
    ink = away & (np.maximum(old, new) > _DARK)
    if ink.sum() < _LEAST_ALIGNING_PX:
        return  # an empty sheet looks the same wherever the camera is
    away &= ndimage.binary_dilation(ink, iterations=_AROUND_PX)
    moved, gain = _shift(old, new, away)
    if moved * factor >= _MOVED_PX and gain > _GAIN:
        raise InputError(
            f"{trial.name}: the camera or the paper moved by {moved * factor:.1f} pixels between its photographs; "
            "fix both and draw it again"
        )


def _shift(old: Floats, new: Floats, where: Bools) -> tuple[float, float]:
    """Return the shift of `old`, pixels, that makes it most like `new`, and the share of squares that it explains."""
    counted = where * new
    squares = (counted * new).sum() - 2 * correlate(old, counted, "same") + correlate(old**2, where * 1.0, "same")
    middle = np.array(old.shape) // 2
    most = int(min(middle)) // 2
    near = squares[middle[0] - most : middle[0] + most + 1, middle[1] - most : middle[1] + most + 1]
    best = np.clip(np.unravel_index(near.argmin(), near.shape), 1, 2 * most - 1)
    finer = []
    for axis in (0, 1):
        less, here, more = near.take(best[axis] + np.arange(-1, 2), axis).take(best[1 - axis], 1 - axis)
        finer.append((less - more) / 2 / max(less - 2 * here + more, 1e-9))
    moved = float(np.hypot(*(best - most + np.clip(finer, -1, 1))))
    return moved, 1 - float(near.min() / max(min(near[most, most], (counted * new).sum()), 1e-9))
