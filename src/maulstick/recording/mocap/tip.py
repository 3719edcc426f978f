"""The tip of the pen over time: out of poses that jump, are missing and tremble."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.spatial.transform import Rotation

from maulstick.errors import InputError
from maulstick.recording.mocap.frames import CanvasPath
from maulstick.recording.mocap.smoothing import smooth
from maulstick.recording.mocap.take import Take
from maulstick.storage.arrays import Bools, Floats

GAP = 0.15
"""Seconds without the pen that are bridged."""

_JUMP = 3e-3  # metres that leaning may move the tip from one frame to the next, at least
_OVER_USUAL = 6.0  # ... or so many times what it usually does
_LEANING = 0.5  # metres a second that leaning may move the tip over a gap
_GLIMPSE = 0.05  # seconds: what is seen for less between two jumps is not to be trusted
_SUSPECT = 3  # frames beside a jump are not to be trusted either


@dataclass(frozen=True)
class TipPath:
    """The tip in the frame of the canvas, in each of F frames.

    places: (F, 2), metres on the canvas; NaN where they are not known, as are the heights.
    heights: (F,), metres over the plane of the canvas's markers.
    noise: how it trembled before it was smoothed, metres RMS: along each axis of the plane, and in height.
    hertz: from where on movement was taken for trembling: in the plane, and in height.
    rejected, bridged, lost: how many frames were outliers, were filled from their neighbours (outliers among them),
    and remain unknown.
    """

    places: Floats
    heights: Floats
    noise: tuple[float, float]
    hertz: tuple[float, float]
    rejected: int
    bridged: int
    lost: int


def tip_path(take: Take, tip: Floats, canvas: CanvasPath) -> TipPath:
    """The path of the tip at `tip` (3,), metres in the frame of the pen's rigid body.

    Frames in which the pen leans otherwise than just before and after are left out: a marker was taken for another.
    Stretches of up to `GAP` without a sighting are bridged by the smoothest way: of a lift that is seen to begin and to
    end it makes a lift. The rest is smoothed, the height apart from the place.

    Raises InputError where the pen and the canvas are never seen together.
    """
    seen = np.isfinite(take.pen_positions[:, 0]) & np.isfinite(take.pen_rotations).all(axis=1)
    offsets = np.full_like(take.pen_positions, np.nan)
    offsets[seen] = Rotation.from_quat(take.pen_rotations[seen]).apply(tip)
    local = canvas.capture_to_canvas(take.pen_positions + offsets)
    seen &= np.isfinite(local[:, 0])
    local[seen] = np.where(steady(take.times[seen], offsets[seen])[:, None], local[seen], np.nan)
    places, heights = smooth(take.times, local[:, :2], GAP), smooth(take.times, -local[:, 2:], GAP)
    known = np.isfinite(places.values[:, 0]) & np.isfinite(heights.values[:, 0])
    if not known.any():
        raise InputError("the pen and the canvas are never seen together for long; let the cameras see both")
    used = places.used & heights.used
    return TipPath(
        np.where(known[:, None], places.values, np.nan),
        np.where(known, heights.values[:, 0], np.nan),
        (places.noise, heights.noise),
        (places.hertz, heights.hertz),
        int((seen & ~used).sum()),
        int((known & ~used).sum()),
        int((~known).sum()),
    )


def steady(times: Floats, offsets: Floats) -> Bools:
    """(F,) where the way (F, k), metres, from the pen's body to its tip goes on from where it did longest."""
    kept = np.zeros(len(times), dtype=bool)
    if len(times) < 2:
        return kept
    steps = np.linalg.norm(np.diff(offsets, axis=0), axis=1)
    jump = max(_JUMP, _OVER_USUAL * float(np.median(steps)))
    edges = [0, *(np.flatnonzero(steps > jump + _LEANING * np.diff(times)) + 1).tolist(), len(times)]
    inner = [(start + _SUSPECT * (start > 0), stop - _SUSPECT * (stop < len(times))) for start, stop in pairwise(edges)]
    stretches = [(start, stop) for start, stop in inner if stop > start and times[stop - 1] - times[start] >= _GLIMPSE]
    if not stretches:
        return kept
    longest = max(range(len(stretches)), key=lambda i: stretches[i][1] - stretches[i][0])
    kept[slice(*stretches[longest])] = True
    onwards = [(start, stop - 1) for start, stop in stretches[longest:]]
    backwards = [(stop - 1, start) for start, stop in stretches[longest::-1]]
    for way in (onwards, backwards):
        last = way[0][1]
        for near, far in way[1:]:
            reach = jump + _LEANING * abs(times[near] - times[last])
            if np.linalg.norm(offsets[near] - offsets[last]) <= reach:
                kept[min(near, far) : max(near, far) + 1] = True
                last = far
    return kept
