"""Standard errors of the numbers of a fitted brush."""

from collections.abc import Callable

import torch
from torch import Tensor

from maulstick.brush_fit.descent import Unknowns, descend
from maulstick.brush_fit.evidence import Evidence

GROUPS, STEPS = 8, 30
"""Groups of the jackknife, and steps of descent without each."""


def standard_errors(evidence: Evidence, found: Unknowns, progress: Callable[[], None]) -> dict[str, Tensor]:
    """Standard errors (k,) of the fitted numbers, and of opacity, in metres or shares.

    They come from a jackknife: the numbers are fitted again without each group of strokes in turn, since strokes are
    the independent observations. `progress` is called at most `GROUPS` * `STEPS` times.
    """
    groups = torch.arange(len(evidence)) % min(GROUPS, len(evidence))
    rest = [(groups != group).nonzero()[:, 0] for group in groups.unique()]
    without = [descend(evidence.pick(some).mosaic(), found.pick(some), STEPS, progress) for some in rest]
    each = {name: torch.stack([left.numbers()[name] for left in without]) for name in found.brush}
    each["opacity"] = torch.stack([left.ink.exp().median() for left in without])[:, None]
    return {name: ((len(without) - 1) * values.var(dim=0, correction=0)).sqrt() for name, values in each.items()}
