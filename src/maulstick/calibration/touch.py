"""Where the paper lies before an arm: a plane through points that its tip has touched.

The tip is taken to each point by hand, with `Jog`, or goes down by itself until it feels the paper, with
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

MOST_ERROR: Final = 1e-3
"""Metres, root mean square, that touched points may lie beside their places on a plane."""

_LEAST_SPREAD = 0.01  # metres, root mean square, on both sides of a line
_DEEPEST = 0.02  # metres: a deeper pressure is a slip of the hand
_PROBE = 2e-4  # metres a step
_READINGS, _PERIOD = 10, 2e-3  # of a force, whose median it is, and seconds from one to the next


def easel_from_touches(touched: Floats, places: Floats, deepest: float = 0.0, travel: float = 5e-3) -> Easel:
    """The easel on which the sheet's places (k, 2) lie nearest to the machine's places (k, 3) that touched them.

    All in metres, k at least 3; deepest and travel as of `Easel`. The rigid fit is the least-squares one (Schönemann
    1966, for two of the three axes); its root mean square error is the easel's `error`.
    Raises InputError for fewer points, points near a line, ones that do not fit by more than MOST_ERROR, and a paper
    that faces away from the machine.
    """
    touched, places = np.asarray(touched, dtype=np.float64), np.asarray(places, dtype=np.float64)
    if touched.shape != (len(touched), 3) or places.shape != (len(touched), 2):
        raise InputError(
            f"touched places have shape {touched.shape} and {places.shape}; they must be (k, 3) and (k, 2)"
        )
    if len(touched) < 3:
        raise InputError(f"{len(touched)} points are touched; a plane needs at least 3, best the corners of the sheet")
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
            f"{1e3 * MOST_ERROR:g} mm: touch point {misses.argmax() + 1} again, and see that the paper is flat"
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
    """The easel, pressed at most as deep as the tip now is, at a place (3,) of the machine, metres.

    Raises InputError where that is not below the paper, or deeper than 20 mm.
    """
    depth = -float(easel.machine_to_canvas(place)[2])
    if not 0 < depth <= _DEEPEST:
        allowed = f"above 0 and at most {1e3 * _DEEPEST:g} mm"
        raise InputError.of_range("the deepest pressure", f"{1e3 * depth:.3g} mm", allowed)
    return easel.model_copy(update={"deepest": depth})


def probe_by_force(robot: FeelsForce, above: Floats, lowest: float, threshold: float = 1.0) -> Floats:
    """Where (3,) straight below a place `above` (3,) the tip touches something; metres. It ends `above` again.

    lowest: height below which it does not go.  threshold: newtons more or less than in the air.
    Raises InputError where `lowest` is outside the machine's limits, and MachineError where nothing is there.
    """
    above = np.asarray(above, dtype=np.float64)
    robot.limits.check_path(np.array([above, [*above[:2], lowest]]))
    robot.move(above)
    in_the_air = _force(robot)
    for height in np.arange(above[2] - _PROBE, lowest, -_PROBE):
        place = robot.move(np.array([*above[:2], height]))
        if abs(_force(robot) - in_the_air) > threshold:
            robot.move(above)
            return place
    robot.move(above)
    raise MachineError(
        f"nothing was felt down to {1e3 * lowest:g} mm; is the sheet there, and is the pen stiff enough for "
        f"{threshold:g} N? Jog by hand otherwise"
    )


def _force(robot: FeelsForce) -> float:
    readings = []
    for _ in range(_READINGS):
        readings.append(robot.force())
        time.sleep(_PERIOD)
    return float(np.median(readings))


@dataclass(frozen=True)
class Jog:
    """A tip that is moved by keys: where it should be, (x, y, z) metres, and how far the next key takes it.

    taken: whether the operator has taken this place.
    """

    place: Point
    limits: Limits
    step: float = 1e-3
    taken: bool = False

    def pressed(self, key: str) -> "Jog":
        """After a key of KEYS, never outside the limits; any other changes nothing."""
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
"""What each key does, in words and in deed, by the names that prompt_toolkit's bindings take."""
