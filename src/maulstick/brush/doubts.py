"""What a fit's trials cannot tell, in words."""

from collections.abc import Sequence

import numpy as np
from torch import Tensor

from maulstick.arrays import Floats
from maulstick.brush.descent import Unknowns
from maulstick.brush.start import has_presses
from maulstick.brush.window import Window

_FEW = 20
_WIDTH = 0.1  # of the widest mark
_SCALE = 0.03
_CROSSED = 0.02  # of all covered pixels
_OLD_INK = 0.15


def doubts(
    windows: Sequence[Window], paths: Sequence[Floats], found: Unknowns, errors: dict[str, Tensor]
) -> tuple[str, ...]:
    """A sentence for each number that these strokes leave open."""
    said = []
    press = np.array([path[:, 2] for path in paths])
    if len(windows) < _FEW:
        said.append(
            f"only {len(windows)} strokes could be used: nothing was held out and nothing tried beyond the paper's "
            f"numbers; draw {_FEW} or more"
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
    if windows[0].after.shape[2] > 1 and not crosses(windows):
        said.append(
            "no stroke crosses an older one, so a translucent ink cannot be told from a paler one: opacity is 1 and "
            "the ink as it was seen; let some strokes cross"
        )
    return tuple(said)


def crosses(windows: Sequence[Window]) -> bool:
    """Whether enough of the strokes lies on older ink to see what shows through."""
    covered = crossed = 0
    for window in windows:
        paper = np.median(window.before, axis=(0, 1))
        old = np.abs(window.before - paper).mean(axis=2) > _OLD_INK
        covered += int(window.covered.sum())
        crossed += int((window.covered & old).sum())
    return crossed > _CROSSED * covered
