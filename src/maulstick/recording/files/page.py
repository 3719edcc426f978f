"""Pages of ink as files have them, in a unit that may be unknown, and their placement on a sheet."""

from dataclasses import dataclass

import numpy as np

from maulstick.errors import InputError, option
from maulstick.painting.raster import parse_length
from maulstick.storage.arrays import Floats
from maulstick.strokes.ink import Ink

LONGEST = 0.15
"""Longer side, metres, that a drawing of unknown scale gets."""

_LEAST_LONGEST, _MOST_LONGEST = 1e-3, 50.0  # metres: longer sides of drawings; others are slips of the unit
_MARGIN = 0.05  # around a drawing without a page, relative to its longer side
_LEAST_SHEET = 10e-3  # metres: least side of a sheet, also around a straight line
_COARSE = 0.25  # share of steps from sample to sample that take no time, from which on a clock is too coarse
MOST_SAMPLES = 5_000_000
"""Most samples of a drawing: bounds memory and time."""


@dataclass(frozen=True)
class Page:
    """Page of ink that a reader found in a file.

    strokes: each (m, 4) of (t, x, y, pressure): seconds from any moment; x right, y down, in units; pressure in [0, 1].
    unit: metres, or None where it is unknown.  size: (width, height) of the sheet from (0, 0), in units, or None.
    kind: the name of the format.  faulty: number of strokes that end early, at faulty data.
    """

    strokes: list[Floats]
    unit: float | None
    size: tuple[float, float] | None
    kind: str
    faulty: int = 0


def parse_longest(text: str) -> float:
    """Return metres of the longer side of a drawing, as in ``150mm``. Raises InputError, also for 0 and over 50 m."""
    longest = parse_length(text)
    if not _LEAST_LONGEST <= longest <= _MOST_LONGEST:
        raise InputError.of_range(option("longest"), text, "between 1 mm and 50 m")
    return longest


def on_sheet(page: Page, size: tuple[float, float] | None, longest: float | None, source: str) -> Ink:
    """Place a page on a sheet, and return it as ink in seconds and metres.

    With `size`, (width, height) in metres, the page fills a sheet of that size as far as it can without distortion.
    With `longest` the longer side of the drawing is that many metres. With neither it keeps its size, and where that is
    unknown its longer side is `LONGEST`. Where the file has no page size, the page is the drawing with a margin of a
    twentieth of its longer side. Times count as not recorded where none passes within any stroke, and those of a coarse
    clock are spread over the samples that share them.

    Raises InputError where there are no samples, too many, or one without a finite place.
    """
    samples = np.concatenate([np.zeros((0, 4)), *page.strokes])
    if not len(samples):
        raise InputError("there are no strokes in it")
    if len(samples) > MOST_SAMPLES:
        raise InputError(f"it has {len(samples)} samples; {MOST_SAMPLES} are the most that a drawing may have")
    places = samples[:, 1:3]
    # Far from zero a float loses its last digits; a number larger than this is a damaged one.
    if not (np.abs(places) < 1e12).all():
        raise InputError("a sample has no place: its x or y is no number, or too large")
    origin, extent = places.min(axis=0), np.ptp(places, axis=0)
    longer = float(extent.max())
    if page.size is not None:
        box, origin = np.array(page.size), np.zeros(2)
    else:
        box, origin = extent + 2 * _MARGIN * longer, origin - _MARGIN * longer
    wanted = longest if longest is not None or page.unit is not None else LONGEST
    if size is not None:
        scale = min((side / length for side, length in zip(size, box.tolist(), strict=True) if length > 0), default=1.0)
    elif wanted is not None:
        scale = wanted / longer if longer > 0 else page.unit or 1.0
    else:
        scale = page.unit or 1.0
    width, height = size or np.maximum(np.round(scale * box, 6), _LEAST_SHEET).tolist()
    samples[:, 1:3] = scale * (places - origin) + (np.array([width, height]) - scale * box) / 2
    strokes = [stroke for stroke in page.strokes if len(stroke)]
    times = [stroke[:, 0] for stroke in strokes]
    if all(np.isnan(each).all() or each.min() == each.max() for each in times):
        samples[:, 0] = np.nan
    else:
        samples[:, 0] = _spread_times(times)
        samples[:, 0] -= np.nanmin(samples[:, 0])
    lengths = np.array([len(stroke) for stroke in strokes], dtype=np.int64)
    return Ink(samples, lengths, (width, height), source)


def _spread_times(strokes: list[Floats]) -> Floats:
    """Return the times of all strokes, (P,): those of a coarse clock are spread over the samples that share them.

    Browsers that hide who somebody is tell the time to a tenth of a second; strokes would stand still and then jump.
    Samples of a stroke's first and last time are as far apart as samples are in the mean, as they may be few.
    """
    steps = np.concatenate([np.diff(times) for times in strokes])
    steps = steps[np.isfinite(steps)]
    if (steps == 0).sum() < _COARSE * len(steps) or (steps < 0).any():  # times that fall are refused as they are
        return np.concatenate(strokes)
    spread = []
    for times in strokes:
        ticks = np.flatnonzero(np.append(True, np.diff(times) > 0))
        if len(ticks) < len(times) and np.isfinite(times).all():
            ends = np.append(ticks, len(times))
            at = np.append(times[ticks], times[-1] + steps.mean() * (len(times) - ticks[-1]))
            at[0] = max(at[0], at[1] - steps.mean() * ends[1])
            times = np.interp(np.arange(len(times)), ends, at)
        spread.append(times)
    return np.concatenate(spread)
