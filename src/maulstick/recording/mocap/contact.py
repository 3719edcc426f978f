"""When the tip of the pen touches the paper."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from maulstick.errors import InputError
from maulstick.storage.arrays import Bools, Floats, Ints

RELEASE = 2.0
"""How many times the threshold the tip must rise for one stroke to end and another to begin."""

_LEAST, _MOST = 5e-5, 0.02  # metres
_FEWEST = 3  # samples
_TICK = 1e-6  # seconds: times are rounded
_NEAR = 3e-3  # metres from the paper: what is higher says nothing of contact
_BIN, _BLUR = 2e-5, 1e-4  # metres
_SIGMAS, _LEAST_PROPOSED = 4.0, 2.5e-4  # metres
_RARE = 0.1
_FOOT = 0.04  # seconds from where the tip leaves the paper to the threshold, at most
_SHARE = 0.25  # of the touch, at most
_POWER = 1.5  # a tip leaves as on a parabola, which smoothing has bent: with 1.5 simulated ends come out unbiased

Frames = Ints


@dataclass(frozen=True)
class ContactOptions:
    """When the tip touches.

    threshold: metres over the paper under which the tip touches; None where it is to be proposed from the data.
    merge: seconds; a lift that is no longer is none.
    shortest: seconds; a touch that is shorter, or has fewer than three samples, is none.
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
    """What was decided. Each (k, 2) holds the first frame of a part and the one after its last.

    touches: strokes.  merged: lifts that were too short.  dropped: touches that were too short.
    threshold, release: metres over the paper.
    """

    touches: Frames
    merged: Frames
    dropped: Frames
    threshold: float
    release: float


def find_contact(times: Floats, heights: Floats, options: ContactOptions) -> Contact:
    """When the tip touches, from its heights (F,) over the paper, NaN where they are not known.

    A touch is a stretch under the release in which the tip comes under the threshold, from where it first does to where
    it last does, so that a tremble does not end a stroke. Then short lifts are merged, and then short touches
    dropped. At last both ends of each touch go inwards to the foot of the curve on which the tip comes down and
    rises, as it moves on while it does. Where the height is not known, nothing touches.
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
    """A threshold for heights (F,) over the paper, metres.

    The heights crowd about the paper, and fall off on both sides: below by noise alone, above into the few that the
    tip has on its way up and down. The threshold is where the crowd ends: the first height, four to six times the
    noise over the commonest one, that is had at most a tenth as often.
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
    """The touch without what belongs to the lifts before and after it; an end where the pen was lost stays."""
    rates = np.gradient(heights[start:stop], times[start:stop])
    most = min(_FOOT, _SHARE * (times[stop - 1] - times[start]))

    def ago(frame: int, beyond: int, rate: float) -> float:  # since height = k (time - foot) ** _POWER began to rise
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
