"""Pressing: how deep a machine presses each brush, and whether it can."""

from collections.abc import Sequence

import numpy as np

from maulstick.errors import InputError, Remedy
from maulstick.painting.brush import Brush
from maulstick.painting.painting import Painting, Stroke
from maulstick.robot.easel import Easel
from maulstick.robot.limits import SLACK, Limits
from maulstick.storage.arrays import Floats

_LIGHT = 5e-4  # metres below first touch: enough for an uneven sheet, and little enough for any pen
_STEADY = 0.02  # range of pressure of a brush that a machine that only lifts its pen may ignore


def depth_at(pressure: Floats, brush: Brush, easel: Easel) -> Floats:
    """Return metres below first touch (n,) for pressures (n,), by the depths of the brush, else by the easel's.

    A pen of unknown depth is pressed lightly, since the easel may be one for broad brushes.
    """
    if not brush.pressure_matters:
        return np.full(pressure.shape, brush.depth[1] if any(brush.depth) else min(easel.deepest / 2, _LIGHT))
    touch, deepest = brush.depth if any(brush.depth) else (0.0, easel.deepest)
    return np.asarray(touch + pressure * (deepest - touch))


def check_depth(brush: Brush, easel: Easel, limits: Limits) -> None:
    """Raise InputError where the depth of a brush is not known, or more than the easel allows."""
    if limits.varies_pressure and brush.pressure_matters and not any(brush.depth) and not easel.deepest:
        raise InputError(
            f"neither the brush {brush.name} nor the easel says how deep it may be pressed; calibrate the touch again"
        )
    if limits.varies_pressure and max(brush.depth) > easel.deepest + SLACK:
        if not easel.deepest:
            raise InputError(
                f"the brush {brush.name} is pressed {1e3 * max(brush.depth):g} mm deep, and no easel says how deep it "
                "may be",
                Remedy.FIND_DEPTH,
            )
        raise InputError(
            f"the brush {brush.name} is pressed {1e3 * max(brush.depth):g} mm deep, and the easel allows "
            f"{1e3 * easel.deepest:g} mm: {1e3 * (max(brush.depth) - easel.deepest):.3g} mm less; calibrate the touch "
            "again, or the brush for this easel"
        )


def check_pressure(strokes: Sequence[Stroke], painting: Painting) -> None:
    """Raise InputError where a brush needs more than one pressure, and the machine only lifts its pen."""
    extremes: dict[str, Floats] = {}
    for stroke in strokes:
        brush = painting.brushes[painting.paints[stroke.paint].brush]
        own = np.array(stroke.trajectory)[:, 2]
        every = np.concatenate([own, extremes.get(brush.name, own)])
        extremes[brush.name] = np.array([every.min(), every.max()])
        if brush.pressure_matters and np.ptp(every) > _STEADY:
            varies = f"varies its pressure by {np.ptp(own):.2f}"
            does = varies if np.ptp(own) > _STEADY else "has another pressure than those before"
            raise InputError(f"stroke {stroke.id} {does}, and this machine only lifts its pen", Remedy.HOLD_PRESSURE)
