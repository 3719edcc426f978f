"""Evidence of a fit: the windows of its trials, their size and resolution, and the trials that cannot be used."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from maulstick.brush_fit.mosaic import Mosaic
from maulstick.brush_fit.trials import Trial, Trials
from maulstick.brush_fit.window import Window, extent, look
from maulstick.errors import InputError
from maulstick.storage.arrays import Floats
from maulstick.storage.text import counted
from maulstick.strokes.strokes import POINTS, resample

FEWEST = 5
"""Least number of strokes that a brush can be fitted to."""

ENOUGH = 20
"""Least number of strokes of which some can be held out, or halves compared."""

_SAMPLE = 12  # trials from which the size of all windows is found
_FAR = 15e-3  # metres around the paths of these
_LARGER, _MORE = 1.25, 1.5e-3  # factor and metres by which windows are larger than the marks in them
_ALL, _PER_STROKE = 9e6, 1e4  # pixel values in all windows, and in one, about: finer photographs are reduced to that


@dataclass(frozen=True)
class Evidence:
    """Windows of strokes and their pixels per metre.  paths: commanded, n points each, (n, 3).

    reduced: by how much their photographs were finer.
    """

    windows: tuple[Window, ...]
    paths: tuple[Floats, ...]
    pixels_per_metre: float
    reduced: int

    def __len__(self) -> int:
        return len(self.windows)

    def pick(self, which: Iterable[int]) -> Self:
        """Return the strokes of these indices."""
        rows = [int(i) for i in which]
        return replace(self, windows=tuple(self.windows[i] for i in rows), paths=tuple(self.paths[i] for i in rows))

    def mosaic(self) -> Mosaic:
        """Return all windows on one canvas."""
        return Mosaic.of_windows(self.windows, self.paths, self.pixels_per_metre)

    def pressures(self) -> Floats:
        """Return the mean pressure (N,) of each stroke."""
        return np.array([path[:, 2].mean() for path in self.paths])


def read_evidence(
    trials: Sequence[Trial] | Trials, pixels_per_metre: float, progress: Callable[[str, int, int], None]
) -> tuple[Evidence, list[str]]:
    """Return windows just large enough for their strokes, and a sentence per unusable trial.

    Raises InputError where fewer than five trials can be used, and for photographs beside darkness images.
    """
    sample = np.unique(np.linspace(0, len(trials) - 1, _SAMPLE).astype(int)).tolist() if len(trials) else []
    seen, left_out = _look_at(trials, sample, pixels_per_metre, _FAR, 1, lambda done: None)
    if not seen:  # others may be usable all the same
        seen, left_out = _look_at(trials, range(len(trials)), pixels_per_metre, _FAR, 1, lambda done: None)
    if seen:
        reach = _LARGER * float(np.quantile([extent(window, pixels_per_metre) for window in seen], 0.9)) + _MORE
        sides = np.array([np.ptp(w.path[:, :2], axis=0) + 2 * reach for w in seen]) * pixels_per_metre
        values = sides.prod(axis=1).mean() * seen[0].after.shape[2]
        reduced = max(1, round(float(np.sqrt(values / min(_PER_STROKE, _ALL / len(trials))))))
        seen, left_out = _look_at(
            trials,
            range(len(trials)),
            pixels_per_metre,
            reach,
            reduced,
            lambda done: progress("photographs", done, len(trials)),
        )
    if len(seen) < FEWEST:
        reasons = "; ".join(left_out[:3]) or "draw more"
        raise InputError(
            f"{len(seen)} of {counted(len(trials), 'trial')} can be used, and {FEWEST} are needed: {reasons}"
        )
    _check_alike(seen)
    paths = tuple(resample(window.path, POINTS) for window in seen)
    return Evidence(tuple(seen), paths, pixels_per_metre / reduced, reduced), left_out


def _check_alike(windows: Sequence[Window]) -> None:
    """Raise InputError for photographs beside darkness images: one ink is fitted, and the latter show no colour."""
    dark = [window.name for window in windows if window.after.shape[2] == 1]
    if 0 < len(dark) < len(windows):
        raise InputError(
            f"{counted(len(dark), 'trial is a darkness image', 'trials are darkness images')}, as {dark[0]} is, and "
            f"{counted(len(windows) - len(dark), 'is a photograph', 'are photographs')}; one fit takes one kind, "
            "so put them into two folders"
        )


def _look_at(
    trials: Sequence[Trial] | Trials,
    which: Sequence[int],
    pixels_per_metre: float,
    reach: float,
    reduced: int,
    tell: Callable[[int], None],
) -> tuple[list[Window], list[str]]:
    windows, left_out = [], []
    for done, i in enumerate(which, start=1):
        try:
            windows.append(look(trials[i], pixels_per_metre, reach, reduced))
        except InputError as error:
            left_out.append(str(error))
        tell(done)
    return windows, left_out
