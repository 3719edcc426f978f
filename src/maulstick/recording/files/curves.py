"""Curves as polylines."""

from collections.abc import Sequence

import numpy as np

from maulstick.errors import InputError
from maulstick.recording.files.page import MOST_SAMPLES
from maulstick.storage.arrays import Floats, Ints

_FINENESS = 1e-4
_MOST_PARTS = 1000


def polylines(chains: Sequence[Floats]) -> list[Floats]:
    """Chains of cubic Béziers (m, 4, 2), each starting where the last one ended, as polylines (k, 2).

    Their chords are within a ten thousandth of the longer side of all the curves together.
    Raises InputError where that takes more points than a drawing may have, or a curve is at no place.
    """
    points = np.concatenate([np.zeros((0, 2)), *(chain.reshape(-1, 2) for chain in chains)])
    if not (np.abs(points) < 1e12).all():
        raise InputError("a point of a curve has no place: it is no number, or too large")
    tolerance = _FINENESS * np.ptp(points, axis=0).max() if len(points) else 0.0
    counts = [_parts(chain, tolerance) for chain in chains]
    if sum(int(parts.sum()) for parts in counts) > MOST_SAMPLES:
        raise InputError(f"its curves come to over {MOST_SAMPLES} samples; that is more than a drawing may have")
    return [_sampled(chain, parts) for chain, parts in zip(chains, counts, strict=True)]


def _parts(cubics: Floats, tolerance: float) -> Ints:
    """Into how many equal parts of its parameter each curve is cut: Wang's bound, at most a thousand."""
    bend = np.abs(np.diff(cubics, n=2, axis=1)).max(axis=(1, 2), initial=0.0)
    parts = np.ceil(np.sqrt(0.75 * np.sqrt(2) * bend / max(tolerance, 1e-300)))
    counts: Ints = np.clip(np.nan_to_num(parts, posinf=_MOST_PARTS), 1, _MOST_PARTS).astype(np.int64)
    return counts


def _sampled(cubics: Floats, parts: Ints) -> Floats:
    which = np.repeat(np.arange(len(cubics)), parts)
    steps = np.arange(len(which)) - np.repeat(np.cumsum(parts) - parts, parts) + 1
    t = (steps / parts[which])[:, None]
    a, b, c, d = (cubics[which, i] for i in range(4))
    points = (1 - t) ** 3 * a + 3 * (1 - t) ** 2 * t * b + 3 * (1 - t) * t**2 * c + t**3 * d
    return np.concatenate([cubics[:1, 0], points])


def catmull_rom(points: Floats) -> Floats:
    """The cubic Béziers (m - 3, 4, 2) of a Catmull-Rom spline through all but the first and last of (m, 2) points."""
    before, start, end, after = points[:-3], points[1:-2], points[2:-1], points[3:]
    return np.stack([start, start + (end - before) / 6, end - (after - start) / 6, end], axis=1)
