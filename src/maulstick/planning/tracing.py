"""Lines of a picture as polylines, and strokes of a hand laid along them, one after another."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import repeat
from typing import Final

import numpy as np
from scipy.ndimage import binary_dilation, gaussian_filter1d
from skimage.filters import apply_hysteresis_threshold
from skimage.morphology import skeletonize

from maulstick.planning.placement import at_pixels
from maulstick.storage.arrays import Bools, Complexes, Floats, Ints
from maulstick.strokes.strokes import path_lengths, resample

_FAINT, _SURE = 0.15, 0.35  # darkness of a line, and of a part that tells it from noise
_WANTED = 0.02  # of the most that is wanted anywhere: what is less is none
_SHORTEST = 4  # pixels of a line: fewer have no direction
_STAIRS = 1.5  # pixels along a line: standard deviation that smooths its steps
_WAY = 4  # pixels that say which way a line goes on where it branches
_ASTRAY = 25.0  # pixels that a stroke must be longer for each that it lies off the line on average
_LEAST_GAIN = 0.2  # of a stroke's length: what fits worse is left to others
_BEYOND = 0.3  # of its length on a line, that a stroke may go on beyond the end, which costs twice that length
_END = 8  # pixels that say which way a line would go on beyond its end
_SKIPPED = 3  # pixels of a line that are passed over where no stroke fits


def traced(dark: Floats, weights: Floats) -> list[Floats]:
    """Return lines that are so dark (H, W), in [0, 1], as points (n, 2) a pixel apart, pixels, the weightiest first.

    weights: (H, W), how much each place matters.
    """
    height, width = dark.shape
    found = []
    for path in _paths(skeletonize(binary_dilation(apply_hysteresis_threshold(dark, _FAINT, _SURE)))):
        pixels = np.stack([path.real, path.imag], axis=1)
        weight = float((dark * weights)[at_pixels(pixels, width, height)].sum())
        points = gaussian_filter1d(pixels, _STAIRS, axis=0, mode="nearest") + 0.5
        found.append((weight, resample(points, max(2, int(path_lengths(points)) + 1))))
    return [points for _, points in sorted(found, key=lambda line: -line[0])]


def drawn(lines: Sequence[Floats], density: Floats) -> list[Floats]:
    """Return the parts of lines where any strokes are wanted, by their density (H, W)."""
    return within(lines, density > _WANTED * density.max())


def within(lines: Sequence[Floats], where: Bools) -> list[Floats]:
    """Return the parts of lines that are in some places (H, W)."""
    return [part for line in lines for part in parts(line, where[at_pixels(line, *where.shape[::-1])])]


def parts(line: Floats, kept: Bools) -> list[Floats]:
    """Return the parts of a line (n, 2) whose points are kept, (n,)."""
    cuts = np.flatnonzero(np.diff(kept)) + 1
    runs = zip(np.split(line, cuts), np.split(kept, cuts), strict=True)
    return [run for run, keeps in runs if keeps[0] and len(run) >= _SHORTEST]


@dataclass(frozen=True)
class Along:
    """Strokes along lines: rows (k,) of a hand's, their paths (k, n, 2), pixels, and the turns (k,) that laid them."""

    rows: Ints
    paths: Floats
    turns: Floats


NOTHING_ALONG: Final = Along(np.zeros(0, dtype=np.int64), np.zeros((0, 1, 2)), np.zeros(0))
"""No strokes along lines."""

END_TO_END: Final = repeat(0.0)
"""Laps of strokes that neither lie over each other nor leave gaps."""


def lay_along(lines: Sequence[Floats], paths: Floats, counts: Ints, laps: Iterator[float] = END_TO_END) -> Along:
    """Lay strokes of a hand (M, n, 2) along lines, and each stroke at most `counts` (M,) times.

    laps: how far each goes on beside the next, as `laps_of` returns them. By default they lie end to end. A line whose
    end is reached is done. paths are in pixels, as the lines are. Of the strokes that fit about the longest is taken,
    turned by a quarter at most, so that it is drawn the hand's way.
    """
    hand, left = _Hand(paths), counts.copy()
    rows, laid, turns = [], [], []
    for line in lines:
        begin = 0
        while len(line) - begin >= _SHORTEST:
            fit = hand.fit(line[begin:], left)
            if fit is None:
                begin += _SKIPPED
                continue
            row, path, turn, length = fit
            left[row] -= 1
            rows.append(row)
            laid.append(path)
            turns.append(turn)
            if begin + length >= len(line) - 1:
                break
            lap = next(laps)
            begin += max(1, round(length - lap * (length if lap > 0 else hand.median)))
    return Along(np.array(rows), np.array(laid), np.array(turns)) if rows else NOTHING_ALONG


class _Hand:
    """Strokes (M, n, 2) of a hand, pixels, to be fitted to lines.  median: of their lengths."""

    def __init__(self, paths: Floats) -> None:
        self._lengths = path_lengths(paths)
        self.median = float(np.median(self._lengths))
        self._paths = _as_complex(paths)
        self._chords = self._paths[:, -1] - self._paths[:, 0]

    def fit(self, line: Floats, left: Ints) -> tuple[int, Floats, float, int] | None:
        """Return row, path (n, 2) and turn of the stroke that fits the beginning of a line best, and its points there.

        left: (M,), how often each may be used. None where none fits.
        """
        chords = np.abs(self._chords)
        points = _as_complex(line)
        end = points[-1] - points[-_END:][0]
        further = np.arange(1, 1 + int(_BEYOND * len(points)))
        points = np.concatenate([points, points[-1] + further * end / max(abs(end), 1e-9)])
        away = np.maximum.accumulate(np.abs(points - points[0]))
        rows = np.flatnonzero((left > 0) & (chords > 0) & (chords <= away[-1]))
        if not len(rows):
            return None
        ends = np.searchsorted(away, chords[rows]).clip(min=1)
        covered = ends.clip(max=len(line) - 1)
        hopeful = covered - 2 * (ends - covered) >= _LEAST_GAIN * self._lengths[rows]  # however little they go astray
        if not hopeful.any():
            return None
        rows, ends, covered = rows[hopeful], ends[hopeful], covered[hopeful]
        turns = np.angle((points[ends] - points[0]) / self._chords[rows])
        back = np.abs(turns) > np.pi / 2
        turns = np.where(back, turns - np.copysign(np.pi, turns), turns)
        turned = np.exp(1j * turns)[:, None] * self._paths[rows]
        shares = np.linspace(0, 1, turned.shape[1])
        at = ends[:, None] * np.where(back[:, None], shares[::-1], shares)
        wanted = np.interp(at, np.arange(len(points)), points)
        moved = turned + (wanted - turned).mean(axis=1, keepdims=True)
        astray = np.sqrt(np.square(np.abs(moved - wanted)).mean(axis=1))
        gains = covered - _ASTRAY * astray - 2 * (ends - covered)
        gains[gains < _LEAST_GAIN * self._lengths[rows]] = -np.inf
        best = int(np.argmax(gains))
        if gains[best] == -np.inf:
            return None
        path = np.stack([moved[best].real, moved[best].imag], axis=1)
        return int(rows[best]), path, float(turns[best]), int(covered[best])


def _as_complex(points: Floats) -> Complexes:
    found: Complexes = points[..., 0] + 1j * points[..., 1]
    return found


_AROUND: Final = [complex(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1) if x or y]


def _paths(thin: Bools) -> list[Complexes]:
    """Return the paths (n,) of lines one pixel wide (H, W), x + iy; where lines meet, one goes straight on."""
    left = {complex(x, y) for y, x in np.argwhere(thin).tolist()}
    beside = {pixel: [pixel + step for step in _AROUND if pixel + step in left] for pixel in left}
    paths = []
    for start in sorted(left, key=lambda pixel: (len(beside[pixel]), pixel.real, pixel.imag)):  # from ends, then rings
        if start in left:
            path = _walk(start, beside, left)
            if len(path) >= _SHORTEST:
                paths.append(np.array(path))
    return paths


def _walk(start: complex, beside: dict[complex, list[complex]], left: set[complex]) -> list[complex]:
    """Return the pixels from `start` on, as straight as they go, and take them away from those that are left."""
    path = [start]
    left.remove(start)
    while ahead := [pixel - path[-1] for pixel in beside[path[-1]] if pixel in left]:
        back = (path[-1] - path[-_WAY:][0]).conjugate()
        step = max(ahead, key=lambda each: ((each * back).real / abs(each), -abs(each)))
        if (step * back).real < 0:
            break
        path.append(path[-1] + step)
        left.remove(path[-1])
    return path
