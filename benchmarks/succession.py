"""Which stroke comes next: a conditional logit of seven numbers of two strokes, fitted on an order that was drawn.

The choice is among the stroke that came next and those left to draw that begin nearest to where the last one ended.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from descriptors import end_to_end, principal
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import log_softmax

from maulstick.strokes.strokes import path_lengths

Floats = NDArray[np.float64]

CHOICES = 50
"""Strokes to choose among, so that a drawing of many strokes is not harder to foretell than one of few."""
_RIDGE = 1e-2  # of the weights of standardised numbers: keeps them finite where few strokes tell everything
_LEAST = 0.01  # median lengths: shorter jumps and distances are one


@dataclass(frozen=True)
class Succession:
    """Weights (7,) of the numbers of `_numbers`, in units (7,)."""

    weights: Floats
    units: Floats

    @classmethod
    def of(cls, paths: Floats) -> "Succession":
        """The one most likely for strokes (N, n, 2) in the order drawn."""
        numbers = _choices(paths)
        units = np.nanstd(numbers, axis=(0, 1)).clip(min=_LEAST)
        scaled = numbers / units

        def loss(weights: Floats) -> tuple[float, Floats]:
            chances = _log_chances(scaled, weights)
            surplus = scaled[:, 0] - np.nansum(np.exp(chances)[..., None] * scaled, axis=1)
            return -chances[:, 0].mean() + _RIDGE * weights @ weights, -surplus.mean(axis=0) + 2 * _RIDGE * weights

        return cls(minimize(loss, np.zeros(numbers.shape[-1]), jac=True, method="L-BFGS-B").x, units)

    def nats(self, paths: Floats) -> float:
        """Mean surprise at each next stroke of strokes (N, n, 2) in the order drawn; log 50 for one who cannot tell."""
        return float(-self._chances(paths)[:, 0].mean())

    def foretold(self, paths: Floats) -> float:
        """Share of the next strokes that are its first choice."""
        return float((self._chances(paths).argmax(axis=1) == 0).mean())

    def _chances(self, paths: Floats) -> Floats:
        return _log_chances(_choices(paths) / self.units, self.weights)


def travel(paths: Floats) -> float:
    """Mean way of the lifted pen to the next of strokes (N, n, 2), median lengths."""
    jumps = np.linalg.norm(paths[1:, 0] - paths[:-1, -1], axis=1)
    return float(jumps.mean() / np.median(path_lengths(paths)))


def steps(paths: Floats) -> Floats:
    """Numbers (N - 1, 7) of each of strokes (N, n, 2) and the next."""
    paths = paths / np.median(path_lengths(paths))
    return np.concatenate([_numbers(one, other[None]) for one, other in pairwise(paths)])


def _log_chances(numbers: Floats, weights: Floats) -> Floats:
    values = numbers @ weights
    return log_softmax(np.where(np.isnan(values), -np.inf, values), axis=1)


def _choices(paths: Floats) -> Floats:
    """Numbers (N - 2, 50, 7) of the strokes to choose from, the one that came next first; NaN where fewer are left."""
    paths = paths / np.median(path_lengths(paths))
    found = np.full((len(paths) - 2, CHOICES, 7), np.nan)
    for last in range(len(paths) - 2):
        left = np.arange(last + 2, len(paths))
        jumps = np.linalg.norm(paths[left, 0] - paths[last, -1], axis=1)
        offered = np.concatenate([[last + 1], left[np.argsort(jumps, kind="stable")[: CHOICES - 1]]])
        found[last, : len(offered)] = _numbers(paths[last], paths[offered])
    return found


def _numbers(last: Floats, offered: Floats) -> Floats:
    """Seven numbers (k, 7) of a stroke (n, 2) and strokes (k, n, 2) that could come after it, in median lengths.

    Log jump, log distance of the centres, end to end or side by side, parallel or across, the same direction or the
    opposite one, |log ratio of the lengths|, log length.
    """
    both = np.concatenate([last[None], offered])
    centres, axes, _ = principal(both)
    chords = both[:, -1] - both[:, 0]
    chords = chords / np.linalg.norm(chords, axis=1, keepdims=True).clip(min=_LEAST)
    lengths = np.log(path_lengths(both))
    away = centres[1:] - centres[0]
    return np.column_stack(
        [
            np.log(np.linalg.norm(offered[:, 0] - last[-1], axis=1).clip(min=_LEAST)),
            np.log(np.linalg.norm(away, axis=1).clip(min=_LEAST)),
            end_to_end(away, axes[0]),
            2 * (axes[1:] @ axes[0]) ** 2 - 1,
            chords[1:] @ chords[0],
            np.abs(lengths[1:] - lengths[0]),
            lengths[1:],
        ]
    )
