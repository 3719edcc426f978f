"""Warnings about what a fit's trials cannot determine."""

from collections.abc import Mapping

import numpy as np
from torch import Tensor

from maulstick.brush_fit.descent import Unknowns
from maulstick.brush_fit.evidence import ENOUGH, Evidence
from maulstick.brush_fit.initialise import has_pressures
from maulstick.brush_fit.window import turned

_WIDTH = 0.1  # share of the widest half-width: a larger standard error of alpha gets a warning
_FINEST_PX = 2.5  # width of a mark that tells its falloff: of 2 it is found as 1.6 where it was 0.9, of 3 as it was
_SCALE = 0.03  # a larger standard error of m_x or m_y gets a warning


def doubts(evidence: Evidence, found: Unknowns, errors: Mapping[str, Tensor], opaque: bool) -> tuple[str, ...]:
    """Return a sentence for each number that this evidence leaves open.

    errors: standard errors by name, in metres or shares; 0 where nothing moved a number.
    opaque: whether the ink was assumed to be opaque.
    """
    said, paths = [], evidence.paths
    widest = float(sum(found.numbers()[name] for name in ("alpha", "beta")))  # half-width, metres
    pressure = np.array([path[:, 2] for path in paths])
    if turned(evidence.windows, evidence.pixels_per_metre):
        said.append(
            "the marks look as their paths do when these are turned by 180 degrees, so the brush fits neither; turn "
            "the photographs, and fit again"
        )
    if len(paths) < ENOUGH:
        said.append(
            f"only {len(paths)} strokes could be used: nothing was held out and nothing tried beyond the paper's "
            f"numbers; draw {ENOUGH} or more"
        )
    if not has_pressures(paths):
        said.append(
            f"all strokes were drawn at pressure {pressure.mean():.2f}: how width depends on pressure is not known, "
            "alpha is 0 "
            "and every pressure draws alike; draw some strokes lighter and some deeper"
        )
    elif float(errors["alpha"]) > _WIDTH * widest:
        said.append(
            f"alpha is known to ± {1e3 * float(errors['alpha']):.2g} mm only, "
            f"since pressures go from {pressure.min():.2f} "
            f"to {pressure.max():.2f}; draw strokes over more pressures"
        )
    if (px := 2 * widest * evidence.pixels_per_metre) < _FINEST_PX:
        said.append(
            f"the mark is {px:.2g} pixels wide in the photographs as they were fitted: its width, falloff and opacity "
            f"cannot be told apart; {_wider(px, evidence.reduced)}"
        )
    for axis, error in zip("xy", errors["scale"].tolist(), strict=True):
        if error == 0:
            said.append(f"no stroke goes along {axis}: m_{axis} is not known and stays 1; draw some that do")
        elif error > _SCALE:
            said.append(f"m_{axis} is known to ± {error:.2g} only: draw longer strokes along {axis}")
    if opaque:
        said.append(
            "no stroke crosses an older one, so a translucent ink cannot be told from a paler one: opacity is 1 and "
            "the ink as it was seen; let some strokes cross"
        )
    return tuple(said)


def _wider(px: float, reduced: int) -> str:
    """Return what gives marks of so many pixels more of them, once their photographs were reduced."""
    if reduced == 1:
        return "photograph the strokes from nearer"
    shorter = f"draw shorter strokes, whose photographs need not be reduced as these were, to 1/{reduced} of their size"
    return shorter if reduced * px >= _FINEST_PX else f"{shorter}, and photograph them from nearer"
