"""Calibration of an arm's easel: a plane through points of the paper that its tip has touched.

The tip is moved to each point by hand, with `Jog`, or lowered by the machine until it feels the paper, with
`probe_by_force`.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from pydantic import ValidationError

from maulstick.errors import InputError, MachineError, validation_fault
from maulstick.robot.easel import Easel
from maulstick.robot.force import FeelsForce
from maulstick.robot.limits import Limits, Point
from maulstick.storage.arrays import Floats
from maulstick.storage.text import counted

MOST_ERROR: Final = 1e-3
"""Largest root mean square distance of touched points from their places on the plane, metres."""

_LEAST_SPREAD = 0.01  # metres, root mean square, that points must spread on both sides of a line, to define a plane
_DEEPEST = 0.02  # metres below the paper: more is taken for a slip of the hand
_PROBE = 2e-4  # metres per step of probing
_READINGS, _PERIOD = 10, 2e-3  # readings of which a force is the median, and seconds between two


class NothingFeltError(MachineError):
    """Error that says that a tip was lowered as far as it may, and felt nothing; it is lifted, and can be moved on."""


def easel_from_touches(touched: Floats, places: Floats, deepest: float = 0.0, travel: float = 5e-3) -> Easel:
    """Fit the easel on which places (k, 2) of the sheet lie nearest to the machine's places (k, 3) that touched them.

    All are in metres, k is at least 3; deepest and travel are as in `Easel`. The rigid fit is the least-squares one
    (Schönemann 1966, for two of the three axes); its root mean square error is the easel's `error`.
    Raises InputError for fewer points, points near a line, ones that do not fit by more than MOST_ERROR, and a paper
    that faces away from the machine.
    """
    touched, places = np.asarray(touched, dtype=np.float64), np.asarray(places, dtype=np.float64)
    if touched.shape != (len(touched), 3) or places.shape != (len(touched), 2):
        raise InputError(
            f"touched places have shape {touched.shape} and {places.shape}; they must be (k, 3) and (k, 2)"
        )
    if len(touched) < 3:
        raise InputError(
            f"{counted(len(touched), 'point is', 'points are')} touched; a plane needs at least 3, "
            "best the corners of the sheet"
        )
    from_places, from_touched = places - places.mean(axis=0), touched - touched.mean(axis=0)
    for name, centred in (("places on the sheet", from_places), ("touched points", from_touched)):
        spread = np.linalg.svd(centred, compute_uv=False)[1] / len(centred) ** 0.5
        if not spread >= _LEAST_SPREAD:
            raise InputError(
                f"the {name} lie within {1e3 * spread:.2g} mm of a line; touch corners that span the sheet"
            )
    left, _, right = np.linalg.svd(from_touched.T @ from_places, full_matrices=False)
    axes = left @ right  # (3, 2): right and down
    corner = touched.mean(axis=0) - axes @ places.mean(axis=0)
    misses = np.linalg.norm(from_touched - from_places @ axes.T, axis=1)
    error = float(np.sqrt((misses**2).mean()))
    if error > MOST_ERROR:
        raise InputError(
            f"the touched points lie {1e3 * error:.2g} mm beside their places; it must be at most "
            f"{1e3 * MOST_ERROR:g} mm, and point {misses.argmax() + 1} is farthest off; touch them again, and see that "
            "the paper is flat and the size that of the sheet"
        )
    try:
        return Easel(
            corner=corner.tolist(),
            right=axes[:, 0].tolist(),
            down=axes[:, 1].tolist(),
            deepest=deepest,
            travel=travel,
            error=error,
        )
    except ValidationError as fault:
        raise InputError(f"the touched points give no easel: {validation_fault(fault)}") from fault


def with_deepest(easel: Easel, place: Floats) -> Easel:
    """Return the easel whose greatest depth is that of the tip now, at a place (3,) of the machine, metres.

    Raises InputError where that is not below the paper, or deeper than 20 mm.
    """
    depth = -float(easel.machine_to_canvas(place)[2])
    if not 0 < depth <= _DEEPEST:
        allowed = f"above 0 and at most {1e3 * _DEEPEST:g} mm"
        raise InputError.of_range("the greatest depth", f"{1e3 * depth:.3g} mm", allowed)
    return easel.model_copy(update={"deepest": depth})


def probe_by_force(robot: FeelsForce, above: Floats, lowest: float, threshold: float = 1.0) -> Floats:
    """Lower the tip from `above` (3,) until it touches something; returns that place (3,), metres, with the tip lifted.

    lowest: z below which it does not go.  threshold: change of force, newtons, that counts as touch.
    Raises InputError where `lowest` is outside the machine's limits, and NothingFeltError where nothing is there.
    """
    above = np.asarray(above, dtype=np.float64)
    robot.limits.check_path(np.array([above, [*above[:2], lowest]]))
    robot.move(above)
    in_the_air = _force(robot)
    for height in np.arange(above[2] - _PROBE, lowest, -_PROBE):
        place = robot.jog(np.array([*above[:2], height]))
        if abs(_force(robot) - in_the_air) > threshold:
            robot.move(above)
            return place
    robot.move(above)
    raise NothingFeltError(
        f"nothing was felt down to {1e3 * lowest:g} mm; is the sheet there, and is the pen stiff enough for "
        f"{threshold:g} N? Jog by hand otherwise"
    )


def _force(robot: FeelsForce) -> float:
    """Return the median of several readings of the force, newtons."""
    readings = []
    for _ in range(_READINGS):
        readings.append(robot.force())
        time.sleep(_PERIOD)
    return float(np.median(readings))


@dataclass(frozen=True)
class Jog:
    """Tip that is moved by keys.

    place: where it should be, (x, y, z) metres.  step: metres per key.  taken: whether the operator takes this place.
    """

    place: Point
    limits: Limits
    step: float = 1e-3
    taken: bool = False

    def pressed(self, key: str) -> "Jog":
        """Return the jog after a key of KEYS, within the limits; other keys change nothing."""
        return KEYS[key][1](self) if key in KEYS else self

    def _moved(self, axis: int, sign: int) -> "Jog":
        place = np.array(self.place)
        place[axis] += sign * self.step
        x, y, z = place.clip(self.limits.lower, self.limits.upper).tolist()
        return replace(self, place=(x, y, z), taken=False)


def _moves(axis: int, sign: int) -> Callable[[Jog], Jog]:
    return lambda jog: jog._moved(axis, sign)


def _steps(step: float) -> Callable[[Jog], Jog]:
    return lambda jog: replace(jog, step=step)


KEYS: Final[dict[str, tuple[str, Callable[[Jog], Jog]]]] = {
    "left": ("x down", _moves(0, -1)),
    "right": ("x up", _moves(0, 1)),
    "down": ("y down", _moves(1, -1)),
    "up": ("y up", _moves(1, 1)),
    "pagedown": ("lower", _moves(2, -1)),
    "pageup": ("higher", _moves(2, 1)),
    "1": ("steps of 10 mm", _steps(1e-2)),
    "2": ("steps of 1 mm", _steps(1e-3)),
    "3": ("steps of 0.1 mm", _steps(1e-4)),
    "enter": ("take this place", lambda jog: replace(jog, taken=True)),
}
"""Keys by their names in prompt_toolkit: a label for people, and what the key does."""
