"""Drawings whose arrangement is known: patches of hatching, and strokes anywhere."""

import numpy as np
from numpy.typing import NDArray

from maulstick.strokes.strokes import Strokes, standardise

Floats = NDArray[np.float64]


def line(start: tuple[float, float], end: tuple[float, float]) -> Floats:
    return np.linspace(start, end, 32)


def hatching(patches: int, seed: int, spacing: float = 0.15, each: int = 8) -> Floats:
    """Patches of parallel strokes of any direction, side by side in rows of four, drawn one after another."""
    rng = np.random.default_rng(seed)
    found = []
    for patch in range(patches):
        lengths = rng.normal(1, 0.1, each)
        strokes = np.array([line((0, spacing * i), (length, spacing * i)) for i, length in enumerate(lengths)])
        strokes += rng.normal(0, 0.02, (each, 1, 2)) - strokes.mean(axis=(0, 1))
        angle, at = rng.uniform(0, 2 * np.pi), 4.5 * np.array(divmod(patch, 4))
        found.append(strokes @ rotation(angle) + at)
    return 0.02 * np.concatenate(found)


def rotation(angle: float) -> Floats:
    return np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


def scattered(count: int, seed: int) -> Floats:
    """Strokes of any direction anywhere."""
    rng = np.random.default_rng(seed)
    angles, lengths = rng.uniform(0, 2 * np.pi, count), rng.normal(1, 0.3, count).clip(0.2)
    ends = lengths[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    starts = rng.uniform(0, 8, (count, 2))
    return 0.02 * np.linspace(starts, starts + ends, 32, axis=1)


def as_strokes(paths: Floats) -> Strokes:
    standard, poses = standardise(paths)
    unknown = np.full((*paths.shape[:2], 1), np.nan)
    return Strokes(np.concatenate([standard, unknown], axis=2), unknown[..., 0], poses)
