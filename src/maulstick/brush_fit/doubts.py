"""What a fit's trials cannot tell, in words."""

from collections.abc import Mapping, Sequence

import numpy as np
from torch import Tensor

from maulstick.brush_fit.descent import Unknowns
from maulstick.brush_fit.evidence import ENOUGH
from maulstick.brush_fit.initialise import has_presses
from maulstick.storage.arrays import Floats

_WIDTH = 0.1  # of the widest mark
_SCALE = 0.03


def doubts(paths: Sequence[Floats], found: Unknowns, errors: Mapping[str, Tensor], opaque: bool) -> tuple[str, ...]:
    """A sentence for each number that these strokes leave open; `opaque`: the ink was taken to be so."""
    said = []
    press = np.array([path[:, 2] for path in paths])
    if len(paths) < ENOUGH:
        said.append(
            f"only {len(paths)} strokes could be used: nothing was held out and nothing tried beyond the paper's "
            f"numbers; draw {ENOUGH} or more"
        )
    if not has_presses(paths):
        said.append(
            f"all strokes were drawn at press {press.mean():.2f}: how width depends on press is not known, alpha is 0 "
            "and every press draws alike; draw some strokes lighter and some deeper"
        )
    elif float(errors["alpha"]) > _WIDTH * float(sum(found.numbers()[name] for name in ("alpha", "beta"))):
        said.append(
            f"alpha is known to ± {1e3 * float(errors['alpha']):.2g} mm only, since presses go from {press.min():.2f} "
            f"to {press.max():.2f}; draw strokes over more presses"
        )
    for axis, error in zip("xy", errors["scale"].tolist(), strict=True):
        if error > _SCALE:
            said.append(f"m_{axis} is known to ± {error:.2g} only: draw longer strokes along {axis}")
    if opaque:
        said.append(
            "no stroke crosses an older one, so a translucent ink cannot be told from a paler one: opacity is 1 and "
            "the ink as it was seen; let some strokes cross"
        )
    return tuple(said)
