"""How sure the numbers of a fitted brush are."""

from collections.abc import Callable

import torch
from torch import Tensor

from maulstick.brush_fit.descent import Unknowns, descend
from maulstick.brush_fit.mosaic import Mosaic

GROUPS, STEPS = 8, 30


def standard_errors(mosaic: Mosaic, found: Unknowns, progress: Callable[[], None]) -> dict[str, Tensor]:
    """Standard errors (k,) of the numbers that were sought, and of opacity, in metres or shares.

    A jackknife over groups of strokes, which are the independent observations: what the numbers become without each
    group in turn. `progress` is called `GROUPS` * `STEPS` times.
    """
    groups = torch.arange(len(mosaic)) % min(GROUPS, len(mosaic))
    kept = [groups != group for group in groups.unique()]
    without = [descend(mosaic, found, taught, STEPS, progress) for taught in kept]
    each = {name: torch.stack([left.numbers()[name] for left in without]) for name in found.brush}
    opacities = [left.ink[taught].exp().median() for left, taught in zip(without, kept, strict=True)]
    each["opacity"] = torch.stack(opacities)[:, None]
    return {name: ((len(without) - 1) * values.var(dim=0, correction=0)).sqrt() for name, values in each.items()}
