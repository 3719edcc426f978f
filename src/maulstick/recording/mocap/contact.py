"""Detection of when the tip of the pen touches the paper."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from maulstick.errors import InputError
from maulstick.storage.arrays import Bools, Floats, Ints

RELEASE = 2.0
"""Height, in multiples of the threshold, above which a stroke ends."""

_LEAST, _MOST = 5e-5, 0.02  # metres: range of a threshold; anything else is a mistake in the units
_FEWEST = 3  # samples of a touch, so that it has a direction
_TICK = 1e-6  # seconds: tolerance for rounded times
_NEAR = 3e-3  # metres from the paper: greater heights do not help to find the threshold
_BIN, _BLUR = 2e-5, 1e-4  # metres: bins of the histogram of heights, and its smoothing
_SIGMAS, _LEAST_PROPOSED = 4.0, 2.5e-4  # least threshold that is proposed: standard deviations of noise, and metres
_RARE = 0.1  # density, relative to the paper's, below which heights count as lifts
_FOOT = 0.04  # seconds: longest time from where the tip leaves the paper to the threshold
_SHARE = 0.25  # of a touch: longest part that is cut off at either end
_POWER = 1.5  # a lift begins like a parabola, flattened by smoothing; with 1.5 simulated ends are unbiased

Frames = Ints
"""Parts of a take, (k, 2): the first frame of each and the one after its last."""


@dataclass(frozen=True)
class ContactOptions:
    """Options of the detection of touches.

    threshold: height over the paper, metres, below which the tip touches; None to find it from the data.
    merge: longest lift, seconds, that is ignored.
    shortest: shortest touch, seconds, that counts; it also needs three samples.
    Raises InputError for numbers out of range.
    """

    threshold: float | None = None
    merge: float = 0.02
    shortest: float = 0.03

    def __post_init__(self) -> None:
        if self.threshold is not None and not _LEAST <= self.threshold <= _MOST:
            raise InputError.of_range("the threshold", f"{self.threshold * 1e3:g} mm", "between 0.05 and 20 mm")
        for name, seconds in (("the longest lift to merge", self.merge), ("the shortest touch", self.shortest)):
            if not 0 <= seconds <= 10:
                raise InputError.of_range(name, f"{seconds:g} s", "between 0 and 10 s")


@dataclass(frozen=True)
class Contact:
    """Touches that were found.

    touches: strokes.  merged: lifts that were too short.  dropped: touches that were too short.
    threshold, release: metres over the paper.
    """

    touches: Frames
    merged: Frames
    dropped: Frames
    threshold: float
    release: float


def find_contact(times: Floats, heights: Floats, options: ContactOptions) -> Contact:
    """Find touches from times (F,), seconds, and heights (F,) of the tip over the paper, metres, NaN where unknown.

    A stretch below the release height in which the tip comes below the threshold is a touch, from the first to the last
    time that it is below; so a tremble does not end a stroke. Then short lifts are merged, and then short touches
    dropped. Last, both ends of each touch move inwards to where the tip met or left the paper, since it moves on while
    it comes down and rises. Where the height is unknown, there is no touch.
    """
    threshold = propose_threshold(heights) if options.threshold is None else options.threshold
    release = RELEASE * threshold
    low = np.nan_to_num(heights, nan=np.inf) < threshold
    touches = []
    for start, stop in _runs(np.nan_to_num(heights, nan=np.inf) < release):
        touching = np.flatnonzero(low[start:stop])
        if len(touching):
            touches.append((start + int(touching[0]), start + int(touching[-1]) + 1))
    merged = []
    whole: list[tuple[int, int]] = []
    for start, stop in touches:
        lift = slice(whole[-1][1], start) if whole else slice(0)
        if whole and times[start] - times[lift.start - 1] <= options.merge + _TICK and np.isfinite(heights[lift]).all():
            merged.append((lift.start, lift.stop))
            whole[-1] = (whole[-1][0], stop)
        else:
            whole.append((start, stop))
    long = [
        stop - start >= _FEWEST and times[stop - 1] - times[start] >= options.shortest - _TICK for start, stop in whole
    ]
    kept = [_to_feet(times, heights, *touch) for touch, enough in zip(whole, long, strict=True) if enough]
    dropped = [touch for touch, enough in zip(whole, long, strict=True) if not enough]
    return Contact(_frames(kept), _frames(merged), _frames(dropped), threshold, release)


def propose_threshold(heights: Floats) -> float:
    """Return a threshold for heights (F,) over the paper, metres.

    The histogram of heights peaks at the paper; below it falls off by noise alone, above also by lifts, which are rare.
    The threshold is the first height, four to six standard deviations of the noise above the peak, whose density is at
    most a tenth of the peak's.
    """
    near = heights[np.abs(heights) < _NEAR]
    if not len(near):
        return _LEAST_PROPOSED
    edges = np.arange(-_NEAR, _NEAR + _BIN, _BIN)
    counts = np.histogram(near, edges)[0].astype(np.float64)
    middles = (edges[:-1] + edges[1:]) / 2
    mode = middles[np.argmax(gaussian_filter1d(counts, _BLUR / _BIN))]
    below = mode - near[near < mode]
    noise = float(1.4826 * np.median(below)) if len(below) else 0.0
    least, most = (mode + factor * max(_SIGMAS * noise, _LEAST_PROPOSED) for factor in (1, 1.5))
    density = gaussian_filter1d(counts, max(_BLUR, noise) / _BIN)
    rare = middles[(middles >= least) & (density <= _RARE * density.max())]
    return float(min(rare[0], most) if len(rare) else least)


def _to_feet(times: Floats, heights: Floats, start: int, stop: int) -> tuple[int, int]:
    """Return a touch without the parts that belong to the lifts around it; an end where the pen was lost stays."""
    rates = np.gradient(heights[start:stop], times[start:stop])
    most = min(_FOOT, _SHARE * (times[stop - 1] - times[start]))

    def ago(frame: int, beyond: int, rate: float) -> float:  # seconds since height = k (time - foot) ** _POWER was 0
        lifted = 0 <= beyond < len(heights) and np.isfinite(heights[beyond]) and rate > 0 and heights[frame] > 0
        return min(most, _POWER * float(heights[frame]) / rate) if lifted else 0.0

    first = times[start] + ago(start, start - 1, -rates[0])
    last = times[stop - 1] - ago(stop - 1, stop, rates[-1])
    return int(np.searchsorted(times, first)), int(np.searchsorted(times, last, side="right"))


def _runs(mask: Bools) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return [(int(start), int(stop)) for start, stop in edges.reshape(-1, 2)]


def _frames(parts: list[tuple[int, int]]) -> Frames:
    return np.array(parts, dtype=np.int64).reshape(-1, 2)
