"""Path of the pen's tip, from poses with jumps, gaps and noise."""

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
"""Longest gap without a sighting of the pen that is bridged, seconds."""

_JUMP = 3e-3  # metres between frames that the pen's leaning may always move the tip by ...
_OVER_USUAL = 6.0  # ... or so many times the median movement
_LEANING = 0.5  # metres per second that leaning may move the tip by in a gap
_GLIMPSE = 0.05  # seconds: a shorter stretch between two jumps is left out
_SUSPECT = 3  # frames beside a jump that are left out too


@dataclass(frozen=True)
class TipPath:
    """Path of the tip in the frame of the canvas, F frames.

    places: (F, 2), metres on the canvas; NaN where unknown, as are the heights.
    heights: (F,), metres over the plane of the canvas's markers.
    noise: metres RMS before smoothing, along each axis of the plane, and in height.
    hertz: cutoff of the smoothing, in the plane, and in height.
    rejected, bridged, lost: numbers of frames that were outliers, were filled from their neighbours (outliers
    included), and remain unknown.
    """

    places: Floats
    heights: Floats
    noise: tuple[float, float]
    hertz: tuple[float, float]
    rejected: int
    bridged: int
    lost: int


def tip_path(take: Take, tip: Floats, canvas: CanvasPath) -> TipPath:
    """Return the path of the tip at `tip` (3,), metres in the frame of the pen's rigid body.

    Frames in which the pen's leaning jumps are left out, since markers were confused. Gaps of up to `GAP` are bridged
    by the smoothest path, so that a lift that is seen to begin and to end stays a lift. The rest is smoothed, the
    height apart from the place.

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
    """Mask (F,) of frames whose offsets (F, k), metres, from body to tip, continue the longest steady stretch."""
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
