"""From trials to windows: how far around the paths to look, how finely, and which trials cannot be used."""

from collections.abc import Callable, Sequence

import numpy as np

from maulstick.brush_fit.trials import Trial, Trials
from maulstick.brush_fit.window import Window, extent, look
from maulstick.errors import InputError

FEWEST = 5
"""Strokes, below which nothing can be fitted."""

ENOUGH = 20
"""Strokes, from which some can be held out, or halves compared."""

_SAMPLE = 12  # trials that are looked at first
_FAR = 15e-3  # metres around these
_LARGER, _MORE = 1.25, 1.5e-3  # metres; windows than the marks in them
_MOST, _MOST_A_STROKE = 9e6, 1e4  # values of pixels in all windows together, and in one; finer photographs are reduced


def read_windows(
    trials: Sequence[Trial] | Trials, pixels_per_metre: float, progress: Callable[[str, int, int], None]
) -> tuple[list[Window], list[str], float]:
    """Windows just large enough for their strokes, a sentence for each trial that has none, and pixels per metre.

    Raises InputError where fewer than five trials can be used.
    """
    sample = np.unique(np.linspace(0, len(trials) - 1, _SAMPLE).astype(int)).tolist() if len(trials) else []
    seen, left_out = _look_at(trials, sample, pixels_per_metre, _FAR, 1, lambda done: None)
    if seen:
        reach = _LARGER * float(np.quantile([extent(window, pixels_per_metre) for window in seen], 0.9)) + _MORE
        sides = np.array([np.ptp(w.path[:, :2], axis=0) + 2 * reach for w in seen]) * pixels_per_metre
        values = sides.prod(axis=1).mean() * seen[0].after.shape[2]
        reduced = max(1, round(float(np.sqrt(values / min(_MOST_A_STROKE, _MOST / len(trials))))))
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
        raise InputError(f"{len(seen)} of {len(trials)} trials can be used, and {FEWEST} are needed: {reasons}")
    return seen, left_out, pixels_per_metre / reduced


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
