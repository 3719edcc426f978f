"""Sheets that a kind of machine reaches, as far as that is known before one is connected."""

from functools import cache, lru_cache
from typing import Final

import numpy as np

from maulstick.robot.adapters.axidraw import V3
from maulstick.robot.adapters.franka import FRANKA_LIMITS
from maulstick.robot.adapters.reaches import FRANKA_REACH, UFACTORY_REACHES, UR_REACHES
from maulstick.robot.adapters.ur import UR_LIMITS
from maulstick.robot.adapters.xarm import LITE6, XARM
from maulstick.robot.limits import Limits
from maulstick.robot.machines import kind_of
from maulstick.robot.reach import Reach

_STEP: Final = 0.01  # metres between two places of a sheet before an arm that are tried
_PEN: Final = np.array([0.0, 0.0, 0.12])  # metres from the flange to the tip, as in the table of docs/machines.md
_DOWNWARDS: Final = np.diag([1.0, -1.0, -1.0])  # orientation of a flange that points down
_HALVINGS: Final = 20  # of the size of a sheet, to a thousandth of a millimetre


def sheet_fault(spec: str, width: float, height: float) -> str:
    """Return, as part of a sentence, why a machine cannot reach all of a sheet; "" where it can, or nobody knows.

    spec: of the machine, or only the kind that it begins with.  width, height: of the sheet, metres.
    """
    kind = kind_of(spec)
    if _is_reached(kind, width, height):
        return ""
    sheet = f"this sheet, {_millimetres(width, height)},"
    if _is_reached(kind, height, width):
        return f"{sheet} is reached by the machine only if it {'lies' if height > width else 'stands'}"
    largest = max((_shrunk(kind, width, height), _shrunk(kind, height, width)), key=max)
    return f"{sheet} is larger than the machine reaches; the largest of its shape is {_millimetres(*largest)}"


def is_beyond(spec: str, width: float, height: float) -> bool:
    """Return whether a machine is known not to reach all of a sheet, whether it lies or stands."""
    kind = kind_of(spec)
    return not (_is_reached(kind, width, height) or _is_reached(kind, height, width))


def _shrunk(kind: str, width: float, height: float) -> tuple[float, float]:
    """Return the largest size of this shape that a machine reaches, metres."""
    least, most = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = (least + most) / 2
        least, most = (middle, most) if _is_reached(kind, middle * width, middle * height) else (least, middle)
    return least * width, least * height


@lru_cache(maxsize=1024)
def _is_reached(kind: str, width: float, height: float) -> bool:
    """Return whether a machine of the kind reaches a sheet somewhere; True where nobody knows."""
    if kind == "axidraw":  # its sheet begins at the home corner, and is not turned
        return V3.holds(np.array([(0, 0, 0), (width, -height, 0)]))
    if (arms := _arms_of(kind)) is None:
        return True
    limits, reaches = arms
    return any(_fits_before(limits, reach, *sides) for reach in reaches for sides in ((width, height), (height, width)))


def _fits_before(limits: Limits, reach: Reach, deep: float, wide: float) -> bool:
    """Return whether a sheet fits before an arm, straight and in its middle, at the height of its base."""
    starts = np.arange(limits.lower[0], limits.upper[0] - deep + 1e-9, _STEP)
    if not len(starts) or wide > limits.upper[1] - limits.lower[1]:
        return False
    nearest = np.clip(0.0, starts, starts + deep)  # to the base
    corners = [(x, y) for x in (starts, starts + deep) for y in (-wide / 2, wide / 2)]
    rows = [np.stack([x, np.full_like(x, y), np.zeros_like(x)], axis=1) for x, y in (*corners, (nearest, 0.0))]
    beyond = np.array([reach.beyond(places) for places in rows])
    return bool((beyond == 0).all(axis=0).any())


@cache
def _arms_of(kind: str) -> tuple[Limits, list[Reach]] | None:
    """Return the limits of a kind of arm, and its models' reaches with a pen that points down; None for other kinds."""
    match kind:
        case "lite6":
            limits, models = LITE6, [UFACTORY_REACHES[6, 9]]
        case "xarm":
            limits, models = XARM, [reach for axes, reach in UFACTORY_REACHES.items() if axes != (6, 9)]
        case "franka":
            limits, models = FRANKA_LIMITS, [FRANKA_REACH]
        case "ur":
            limits, models = UR_LIMITS, [*UR_REACHES.values()]
        case _:
            return None
    return limits, [reach.holding(_DOWNWARDS, _PEN) for reach in models]


def _millimetres(width: float, height: float) -> str:
    return f"{1e3 * width:.0f} by {1e3 * height:.0f} mm"
