"""Comparison of two sets of strokes: a description of each stroke, and distances between their distributions."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.spatial.distance import cdist

from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import path_lengths, standardise

CURVINESS = (2, 12, 13)
"""Columns of a description for how much a stroke is bent, how rough and how wavy it is."""

_BINS, _POINTS = 6, 5  # parts of a stroke whose turning is described, and points between its ends
_LEAST = 1e-9  # keeps 0 out of logarithms and denominators
_SMOOTHEST = 1e-7  # roughness of a straight stroke: less of it is the rounding of a style's file
_ROUNDING = 1e-6  # spread of a number that never varies but for that rounding
_STRAIGHT = 1e-2  # radians per point: less turning than that has no sign
_HALVINGS = 20  # random halvings that are averaged, so that the result hardly depends on the seed
_MOST = 2000  # strokes of a hand that are compared: distances between them take time and memory by the square
_LEAST_APART = 0.4  # standard deviations: smaller differences are not mentioned
_MOST_SAID = 3  # differences in a sentence
_LENGTH = 0  # column of a description
_MORE_AND_LESS = {  # column of a description: the phrases for a larger and a smaller value
    1: ("end farther from where they begin", "end nearer to where they begin"),
    2: ("bend more", "bend less"),
    3: ("turn more to the right", "turn more to the left"),
    12: ("are rougher", "are smoother"),
    13: ("change the side that they bend to more often", "change the side that they bend to less often"),
}


@dataclass(frozen=True)
class Comparison:
    """Comparison of the strokes of two hands.

    shared: share of all strokes that both hands have, in [0, 1].  distance: energy distance, 0 for equal distributions.
    of_halves: energy distance between two halves of the first hand's strokes.  accuracy: of a nearest-neighbour
    classifier, 0.5 for equal distributions.  told: how the second's strokes differ from the first's, in words.
    """

    shared: float
    distance: float
    of_halves: float
    accuracy: float
    told: str

    @classmethod
    def of(cls, first: Floats, second: Floats, rng: np.random.Generator) -> Self:
        """Compare paths (N, n, 2) and (M, n, 2), metres; descriptions are standardised over both.

        Of more than 2,000 strokes so many are drawn, but for `shared`, which is of all.
        """
        of_first, of_second = ({path.tobytes() for path in paths} for paths in (first, second))
        described = [describe(_some(paths, rng)) for paths in (first, second)]
        together = np.concatenate(described)
        spread = together.std(axis=0)
        a, b = ((each - together.mean(axis=0)) / np.where(spread > _ROUNDING, spread, 1) for each in described)
        accuracy = nearest_neighbour_accuracy(a, b, rng)
        ratio = float(np.exp(described[1][:, _LENGTH].mean() - described[0][:, _LENGTH].mean()))
        return cls(
            len(of_first & of_second) / len(of_first | of_second),
            energy_distance(a, b),
            _of_halves(a, rng),
            accuracy,
            _in_words(a, b, ratio),
        )


def describe(paths: Floats) -> Floats:
    """Return a description (N, 24) of each path (N, n, 2), metres, which does not depend on its place or direction.

    The columns are: log length; chord over length; absolute turning and turning; width and height over length; turning
    in each of six parts of the stroke; log roughness, which is the RMS second difference over length; changes of the
    turning's sign per point; and five points between the ends, over length.
    """
    paths, _ = standardise(paths)
    lengths = path_lengths(paths).clip(min=_LEAST)[:, None]
    shapes = paths / lengths[..., None]
    steps = np.diff(shapes, axis=1)
    heading = np.unwrap(np.arctan2(steps[..., 1], steps[..., 0]), axis=1)
    turns = np.diff(heading, axis=1)
    parts = np.stack([part.sum(axis=1) for part in np.array_split(turns, _BINS, axis=1)], axis=1)
    bends = np.diff(shapes, n=2, axis=1)
    roughness = np.sqrt(np.square(bends).sum(axis=-1).mean(axis=1, keepdims=True))
    inflections = _inflections(turns)[:, None]
    at = np.linspace(0, paths.shape[1] - 1, _POINTS + 2).round().astype(int)[1:-1]
    return np.concatenate(
        [
            np.log(lengths),
            np.linalg.norm(shapes[:, -1] - shapes[:, 0], axis=1, keepdims=True),
            np.abs(turns).sum(axis=1, keepdims=True),
            turns.sum(axis=1, keepdims=True),
            np.ptp(shapes, axis=1),
            parts,
            np.log(roughness.clip(min=_SMOOTHEST)),
            inflections,
            shapes[:, at].reshape(len(paths), 2 * _POINTS),
        ],
        axis=1,
    )


def _some(paths: Floats, rng: np.random.Generator) -> Floats:
    return paths if len(paths) <= _MOST else paths[np.sort(rng.choice(len(paths), _MOST, replace=False))]


def _inflections(turns: Floats) -> Floats:
    """Changes of the turning's sign per point, (N,); nearly straight parts keep the sign before them."""
    bent = np.abs(turns) > _STRAIGHT
    last = np.maximum.accumulate(np.where(bent, np.arange(turns.shape[1]), 0), axis=1)
    signs = np.take_along_axis(np.where(bent, np.sign(turns), 0), last, axis=1)
    changes: Floats = (signs[:, 1:] * signs[:, :-1] < 0).mean(axis=1)
    return changes


def energy_distance(a: Floats, b: Floats) -> float:
    """Unbiased energy distance between the distributions that descriptions (N, k) and (M, k) were drawn from.

    For equal distributions it is near 0, and as often below as above.
    """
    return float(2 * cdist(a, b).mean() - _mean_of_pairs(a) - _mean_of_pairs(b))


def _mean_of_pairs(a: Floats) -> float:
    return float(cdist(a, a).sum() / (len(a) * (len(a) - 1)))


def nearest_neighbour_accuracy(a: Floats, b: Floats, rng: np.random.Generator, rounds: int = 20) -> float:
    """Share of descriptions (N, k) and (M, k) whose nearest neighbour is of their own set; 0.5 where they look alike.

    Each of the `rounds` draws equally many of each set.
    """
    size = min(len(a), len(b))
    hits = []
    for _ in range(rounds):
        rows = [rng.choice(len(x), size, replace=False) for x in (a, b)]
        mixed = np.concatenate([a[rows[0]], b[rows[1]]])
        apart = cdist(mixed, mixed)
        np.fill_diagonal(apart, np.inf)
        hits.append(((apart.argmin(axis=1) < size) == (np.arange(2 * size) < size)).mean())
    return float(np.mean(hits))


def kolmogorov_smirnov(a: Floats, b: Floats) -> float:
    """Largest difference between the shares of numbers (N,) and (M,) up to any value: 0 for equal distributions.

    `scipy.stats.ks_2samp` finds the same, but takes a second to load.
    """
    both = np.concatenate([a, b])
    up_to = [np.searchsorted(np.sort(each), both, side="right") / len(each) for each in (a, b)]
    return float(np.abs(up_to[0] - up_to[1]).max())


def distance_to_nearest(a: Floats, b: Floats) -> float:
    """Mean distance from a description of `a` (N, k) to the nearest of `b` (M, k)."""
    return float(cdist(a, b).min(axis=1).mean())


def _of_halves(described: Floats, rng: np.random.Generator) -> float:
    """Energy distance of one half of the strokes to the other, averaged over several random halvings."""
    halves = [np.array_split(described[rng.permutation(len(described))], 2) for _ in range(_HALVINGS)]
    return float(np.mean([energy_distance(*pair) for pair in halves]))


def _in_words(first: Floats, second: Floats, ratio: float) -> str:
    """Return the largest differences between standardised descriptions in words; `ratio` is the one of lengths."""
    apart = second.mean(axis=0) - first.mean(axis=0)
    times = f"{float(f'{ratio:.2g}'):g}"  # with .2g alone 123 would be told as 1.2e+02
    told = _MORE_AND_LESS if times == "1" else (_LENGTH, *_MORE_AND_LESS)
    columns = sorted(told, key=lambda column: -abs(apart[column]))
    said = [
        f"are {times} times as long" if column == _LENGTH else _MORE_AND_LESS[column][int(apart[column] < 0)]
        for column in columns[:_MOST_SAID]
        if abs(apart[column]) >= _LEAST_APART
    ]
    if not said:
        return "are as long, as bent and as rough"
    return " and ".join([", ".join(said[:-1]), said[-1]] if len(said) > 1 else said)
