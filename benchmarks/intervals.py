"""Intervals: by bootstrap of groups, and within them, as often as there are, with replacement; by t of a few runs."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import stats

Floats = NDArray[np.float64]

_DRAWS = 2000


def interval(groups: Sequence[Floats], statistic: Callable[[Floats], float]) -> list[float]:
    """95 % interval of a statistic of all rows of the groups, each (n, ...): what was measured of one session, say."""
    rng = np.random.default_rng(0)
    values = []
    for _ in range(_DRAWS):
        drawn = [groups[i] for i in rng.integers(len(groups), size=len(groups))]
        values.append(statistic(np.concatenate([group[rng.integers(len(group), size=len(group))] for group in drawn])))
    return [round(float(bound), 3) for bound in np.quantile(values, (0.025, 0.975))]


def of_few(values: Floats) -> list[float]:
    """95 % interval of the mean of two or more runs that differ by their seed alone (Student's t)."""
    half = stats.t.ppf(0.975, len(values) - 1) * stats.sem(values)
    return [round(float(bound), 3) for bound in (values.mean() - half, values.mean() + half)]


def mean(values: Floats) -> float:
    """Their mean, as the statistic of an interval."""
    return float(values.mean())
