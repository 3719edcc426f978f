"""Strokes as HPGL, for pen plotters: 40 units a millimetre from the lower left corner, y up, a pen a paint."""

from collections.abc import Iterable

import numpy as np

from maulstick.robot.limits import Limits
from maulstick.storage.arrays import Floats

_UNITS_A_METRE = 40_000
_NEAR = 1e-6  # units: what a limit may miss a whole number by and still mean it


def hpgl(strokes: Iterable[tuple[int, Floats]], limits: Limits) -> str:
    """Strokes in order, each its paint's index and its path (n, 3) in the machine's frame, metres; height is left out.

    The first paint is pen 1. Raises InputError where a path leaves the limits.
    """
    lines, held = ["IN;"], None
    for paint, path in strokes:
        limits.check_path(path)
        if paint != held:
            lines.append(f"PU;SP{paint + 1};")
            held = paint
        first, *rest = (f"{x:.0f},{y:.0f}" for x, y in _units(path, limits))
        lines.append(f"PU{first};PD{','.join(rest or [first])};")
    return "\n".join([*lines, "PU;SP0;\n"])


def _units(path: Floats, limits: Limits) -> Floats:
    """(n, 2) whole plotter units of a path (n, 3), rounded towards the inside at the limits."""
    lower = np.ceil(np.array(limits.lower[:2]) * _UNITS_A_METRE - _NEAR)
    upper = np.floor(np.array(limits.upper[:2]) * _UNITS_A_METRE + _NEAR)
    return np.asarray(np.clip(np.rint(path[:, :2] * _UNITS_A_METRE), lower, upper) + 0.0)
