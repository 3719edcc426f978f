"""How sure the numbers of a fitted brush are."""

from collections.abc import Callable

import torch
from torch import Tensor

from maulstick.brush.descent import Unknowns, descend
from maulstick.brush.mosaic import Mosaic

GROUPS, STEPS = 8, 30


def standard_errors(mosaic: Mosaic, found: Unknowns, progress: Callable[[], None]) -> dict[str, Tensor]:
    """Standard errors (k,) of the numbers that were sought, in their own units (metres or shares).

    A jackknife over groups of strokes, which are the independent observations: what the numbers become without each
    group in turn. `progress` is called `GROUPS` * `STEPS` times.
    """
    groups = torch.arange(len(mosaic)) % min(GROUPS, len(mosaic))
    without = [descend(mosaic, found, groups != group, STEPS, progress).numbers() for group in groups.unique()]
    errors = {}
    for name in found.brush:
        each = torch.stack([numbers[name] for numbers in without])
        errors[name] = ((len(each) - 1) * each.var(dim=0, correction=0)).sqrt()
    return errors
