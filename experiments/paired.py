"""How the errors of two models compare that were tested with the same strokes."""

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

RESAMPLED = 10_000


@dataclass(frozen=True)
class Ratio:
    """Mean error of one model over that of another. interval: 95 %.  splits: least and largest of a single split."""

    ratio: float
    interval: tuple[float, float]
    splits: tuple[float, float]


def paired_ratio(errors: list[Tensor], others: list[Tensor], *, again: bool) -> Ratio:
    """Compare the errors (n,) of each split with another model's errors of the same strokes.

    again: whether each split tests the same strokes again, so that a stroke's errors are averaged over the splits
    before strokes are drawn for the interval, with replacement and in pairs; else each stroke was tested once.
    """
    joined = [torch.stack(each).mean(0) if again else torch.cat(each) for each in (errors, others)]
    one, other = (each.double().numpy() for each in joined)
    drawn = np.random.default_rng(0).integers(0, len(one), (RESAMPLED, len(one)))
    low, high = np.quantile(one[drawn].mean(axis=1) / other[drawn].mean(axis=1), (0.025, 0.975))
    each = [float(a.mean() / b.mean()) for a, b in zip(errors, others, strict=True)]
    return Ratio(float(one.mean() / other.mean()), (float(low), float(high)), (min(each), max(each)))
