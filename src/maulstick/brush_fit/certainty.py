"""Standard errors of the numbers of a fitted brush."""

from collections.abc import Callable

import torch
from torch import Tensor

from maulstick.brush_fit.descent import Unknowns, descend
from maulstick.brush_fit.mosaic import Mosaic

GROUPS, STEPS = 8, 30
"""Groups of the jackknife, and steps of descent without each."""


def standard_errors(mosaic: Mosaic, found: Unknowns, progress: Callable[[], None]) -> dict[str, Tensor]:
    """Standard errors (k,) of the fitted numbers, and of opacity, in metres or shares.

    They come from a jackknife: the numbers are fitted again without each group of strokes in turn, since strokes are
    the independent observations. `progress` is called at most `GROUPS` * `STEPS` times.
    """
    groups = torch.arange(len(mosaic)) % min(GROUPS, len(mosaic))
    kept = [groups != group for group in groups.unique()]
    without = [descend(mosaic, found, taught, STEPS, progress) for taught in kept]
    each = {name: torch.stack([left.numbers()[name] for left in without]) for name in found.brush}
    opacities = [left.ink[taught].exp().median() for left, taught in zip(without, kept, strict=True)]
    each["opacity"] = torch.stack(opacities)[:, None]
    return {name: ((len(without) - 1) * values.var(dim=0, correction=0)).sqrt() for name, values in each.items()}
