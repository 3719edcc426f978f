"""Hands that nobody has: sets of strokes that differ as plainly as circles and zigzags do."""

from collections.abc import Callable

import numpy as np

from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import POINTS, Strokes, resample, standardise
from maulstick.style.exemplar import Exemplar
from maulstick.style.hand import Hand
from maulstick.style.pooled import PooledHands, pool

Drawing = Callable[[np.random.Generator, Floats], Floats]

_RAW = 400


def strokes_of(paths: Floats, pressure: Floats | float = np.nan, seconds: float = np.nan) -> Strokes:
    """Paths (N, n, 2) as strokes, drawn at one speed each."""
    count, n = paths.shape[:2]
    standard, poses = standardise(paths)
    pressures = np.broadcast_to(pressure, (count, n))[..., None]
    times = np.broadcast_to(np.linspace(0, seconds, n), (count, n))
    return Strokes(np.concatenate([standard, pressures], axis=-1), times, poses)


def drawn(one: Drawing, count: int, seed: int = 0, tremor: float = 0.003) -> Floats:
    """Standardised strokes (count, 32, 2) of some 30 mm; the tremor is a share of a stroke's length."""
    rng = np.random.default_rng(seed)
    paths = []
    for _ in range(count):
        path = resample(one(rng, np.linspace(0, 1, _RAW)) * rng.lognormal(np.log(0.03), 0.2))
        paths.append(path + tremor * np.linalg.norm(np.diff(path, axis=0), axis=1).sum() * _tremor(rng))
    return standardise(np.array(paths))[0]


def _tremor(rng: np.random.Generator) -> Floats:
    white = rng.normal(size=(POINTS + 2, 2))
    smooth: Floats = (white[:-2] + white[1:-1] + white[2:]) / 3
    return smooth


def circle(rng: np.random.Generator, t: Floats) -> Floats:
    """Most of a circle, of length 1."""
    angle = t * rng.uniform(1.5, 1.9) * np.pi
    return np.stack([np.cos(angle), rng.uniform(0.8, 1.2) * np.sin(angle)], axis=1) / angle[-1]


def zigzag(rng: np.random.Generator, t: Floats) -> Floats:
    """To and fro two or three times, of length 1 or so."""
    folds, tall = rng.uniform(2.0, 2.6), rng.uniform(0.2, 0.3)
    return np.stack([0.5 * t, tall * np.abs((t * folds * 2 + 1) % 2 - 1) / 2], axis=1)


def line(rng: np.random.Generator, t: Floats) -> Floats:
    """All but straight, of length 1."""
    return np.stack([t, rng.normal(0, 0.005) * t * (1 - t)], axis=1)


def arc(rng: np.random.Generator, t: Floats) -> Floats:
    """A fifth to a third of a circle, of length 1."""
    angle = t * rng.uniform(0.4, 0.65) * np.pi
    return np.stack([np.sin(angle), np.cos(angle) - 1], axis=1) / angle[-1]


def line_or_arc(rng: np.random.Generator, t: Floats) -> Floats:
    """One or the other: a hand that a density may not blend."""
    return (line if rng.random() < 0.5 else arc)(rng, t)


def hand_of(paths: Floats) -> Hand:
    """A hand without pressure or times."""
    return Hand.of(strokes_of(paths))


def all_hands() -> PooledHands:
    """What the hands above have in common."""
    return pool([hand_of(drawn(one, 40, seed)) for seed, one in enumerate((circle, zigzag, line, arc))])


def exemplar_of(one: Drawing, count: int = 20, seed: int = 10) -> Exemplar:
    """The style of a synthetic hand."""
    return Exemplar.fit(one.__name__, hand_of(drawn(one, count, seed)), all_hands())
