"""Strokes as HPGL, for pen plotters: 40 units per millimetre from the lower left corner, y up, one pen per paint."""

from collections.abc import Iterable

import numpy as np

from maulstick.robot.limits import Limits
from maulstick.storage.arrays import Floats

_UNITS_PER_METRE = 40_000  # HPGL's plotter unit is 1/40 mm
_NEAR = 1e-6  # units: a limit so near to a whole number counts as that number


def hpgl(strokes: Iterable[tuple[int, Floats]], limits: Limits) -> str:
    """Return HPGL of strokes in order: each a paint's index and a path (n, 3) in the machine's frame, metres.

    The first paint is pen 1, and heights are left out. Raises InputError where a path leaves the limits.
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
    """Return whole plotter units (n, 2) of a path (n, 3), metres, rounded towards the inside at the limits."""
    lower = np.ceil(np.array(limits.lower[:2]) * _UNITS_PER_METRE - _NEAR)
    upper = np.floor(np.array(limits.upper[:2]) * _UNITS_PER_METRE + _NEAR)
    return np.asarray(np.clip(np.rint(path[:, :2] * _UNITS_PER_METRE), lower, upper) + 0.0)
