"""The order of a hand: which of the strokes that are left it draws next."""

import numpy as np
from scipy.optimize import minimize
from scipy.special import log_softmax

from maulstick.ordering.succession import Outlines
from maulstick.painting.succession import Succession
from maulstick.storage.arrays import Floats, Ints

_CHOICES = 50  # the stroke that came next, and those left that begin nearest to where the last one ended
_RIDGE = 1e-2  # of the weights of numbers over their spread: keeps them finite where few strokes tell everything
_LEAST_SPREAD = 0.01  # of any number: where all strokes follow alike


def succession_of(paths: Floats) -> Succession:
    """Return the succession under which the order of paths (M, n, 2), metres, as drawn, is likeliest."""
    outlines = Outlines.of(paths)
    choices = [_offered(outlines, last) for last in range(len(paths) - 2)]
    found = np.full((len(choices), _CHOICES, len(Succession.model_fields)), np.nan)
    for last, offered in enumerate(choices):
        found[last, : len(offered)] = outlines.numbers(np.full(len(offered), 2 * last), 2 * offered)
    spread = np.nanstd(found, axis=(0, 1)).clip(min=_LEAST_SPREAD)
    numbers, there = np.nan_to_num(found / spread), np.isfinite(found[..., 0])

    def loss(weights: Floats) -> tuple[float, Floats]:
        chances = log_softmax(np.where(there, numbers @ weights, -np.inf), axis=1)
        surplus = numbers[:, 0] - (np.exp(chances)[..., None] * numbers).sum(axis=1)
        return -chances[:, 0].mean() + _RIDGE * weights @ weights, -surplus.mean(axis=0) + 2 * _RIDGE * weights

    weights = minimize(loss, np.zeros(numbers.shape[-1]), jac=True, method="L-BFGS-B").x / spread
    return Succession(**dict(zip(Succession.model_fields, weights.tolist(), strict=True)))


def _offered(outlines: Outlines, last: int) -> Ints:
    """Return the strokes to choose from after `last`, the one that came next first."""
    later = np.arange(last + 2, len(outlines.lengths))
    jumps = outlines.jumps(np.array(2 * last), 2 * later)
    return np.concatenate([[last + 1], later[np.argsort(jumps, kind="stable")[: _CHOICES - 1]]])
