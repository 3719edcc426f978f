"""How alike two sets of strokes are: a description of each stroke, and distances between their distributions."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.spatial.distance import cdist

from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import path_lengths, standardise

CURVINESS = (2, 12, 13)
"""Which numbers of a description say how much a stroke is bent, how rough it is, and how wavy."""
_BINS, _POINTS = 6, 5
_LEAST = 1e-9
_STRAIGHT = 1e-2  # radians
_HALVINGS = 20
_LEAST_APART = 0.4  # of a standard deviation: what is less is not worth saying
_MOST_SAID = 3
_LENGTH = 0
_MORE_AND_LESS = {  # of a description that is larger, and smaller
    1: ("end farther from where they begin", "end nearer to where they begin"),
    2: ("bend more", "bend less"),
    3: ("turn more to the right", "turn more to the left"),
    12: ("are rougher", "are smoother"),
    13: ("change the side that they bend to more often", "change the side that they bend to less often"),
}


@dataclass(frozen=True)
class Comparison:
    """Of the strokes of two hands.

    shared: how many of all their strokes are both hands', in [0, 1].  distance: of energy, 0 where they are the same.
    of_halves: that of one half of the first to the other.  accuracy: of 1-NN, 0.5 where they are the same.
    told: what the strokes of the second do, compared with those of the first.
    """

    shared: float
    distance: float
    of_halves: float
    accuracy: float
    told: str

    @classmethod
    def of(cls, first: Floats, second: Floats, rng: np.random.Generator) -> Self:
        """Of the paths (N, n, 2) and (M, n, 2), metres; distances are between descriptions standardised over both."""
        of_first, of_second = ({path.tobytes() for path in paths} for paths in (first, second))
        described = [describe(paths) for paths in (first, second)]
        together = np.concatenate(described)
        spread = together.std(axis=0)
        a, b = ((each - together.mean(axis=0)) / np.where(spread > 0, spread, 1) for each in described)
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
    """Each path (N, n, 2), metres, wherever it lies, as 24 numbers, (N, 24).

    Log length; chord over length; turning, as much of it as there is and its sum; width and height over length; turning
    in six parts of the stroke; log roughness, which is the RMS second difference over length; changes of the turning's
    sign a point; and five points between the ends, over length.
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
            np.log(roughness.clip(min=_LEAST)),
            inflections,
            shapes[:, at].reshape(len(paths), 2 * _POINTS),
        ],
        axis=1,
    )


def _inflections(turns: Floats) -> Floats:
    """How often turning changes its sign, (N,), a point; what is nearly straight goes on as before."""
    bent = np.abs(turns) > _STRAIGHT
    last = np.maximum.accumulate(np.where(bent, np.arange(turns.shape[1]), 0), axis=1)
    signs = np.take_along_axis(np.where(bent, np.sign(turns), 0), last, axis=1)
    changes: Floats = (signs[:, 1:] * signs[:, :-1] < 0).mean(axis=1)
    return changes


def energy_distance(a: Floats, b: Floats) -> float:
    """Between the distributions that descriptions (N, k) and (M, k) were drawn from, without bias.

    Near 0, and as often below as above, where they are the same.
    """
    return float(2 * cdist(a, b).mean() - _mean_of_pairs(a) - _mean_of_pairs(b))


def _mean_of_pairs(a: Floats) -> float:
    return float(cdist(a, a).sum() / (len(a) * (len(a) - 1)))


def nearest_neighbour_accuracy(a: Floats, b: Floats, rng: np.random.Generator, rounds: int = 20) -> float:
    """How often a description's nearest neighbour is of its own set, among as many of each: 0.5 cannot tell them."""
    size = min(len(a), len(b))
    hits = []
    for _ in range(rounds):
        rows = [rng.choice(len(x), size, replace=False) for x in (a, b)]
        mixed = np.concatenate([a[rows[0]], b[rows[1]]])
        apart = cdist(mixed, mixed)
        np.fill_diagonal(apart, np.inf)
        hits.append(((apart.argmin(axis=1) < size) == (np.arange(2 * size) < size)).mean())
    return float(np.mean(hits))


def distance_to_nearest(a: Floats, b: Floats) -> float:
    """Mean distance from a description of `a` to the nearest of `b`."""
    return float(cdist(a, b).min(axis=1).mean())


def _of_halves(described: Floats, rng: np.random.Generator) -> float:
    """Energy distance of one half of the strokes to the other, on average over several ways to halve them."""
    halves = [np.array_split(described[rng.permutation(len(described))], 2) for _ in range(_HALVINGS)]
    return float(np.mean([energy_distance(*pair) for pair in halves]))


def _in_words(first: Floats, second: Floats, ratio: float) -> str:
    """What differs most from the first standardised descriptions to the second, whose strokes are `ratio` as long."""
    apart = second.mean(axis=0) - first.mean(axis=0)
    columns = sorted((_LENGTH, *_MORE_AND_LESS), key=lambda column: -abs(apart[column]))
    said = [
        f"are {ratio:.2g} times as long" if column == _LENGTH else _MORE_AND_LESS[column][int(apart[column] < 0)]
        for column in columns[:_MOST_SAID]
        if abs(apart[column]) >= _LEAST_APART
    ]
    if not said:
        return "are as long, as bent and as rough"
    return " and ".join([", ".join(said[:-1]), said[-1]] if len(said) > 1 else said)
