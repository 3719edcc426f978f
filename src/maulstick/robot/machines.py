"""Machines by their specs, such as ``grbl:/dev/ttyUSB0``: a kind and where it is."""

from collections.abc import Callable
from typing import Final

from maulstick.errors import InputError
from maulstick.robot.easel import Easel
from maulstick.robot.limits import Limits
from maulstick.robot.robot import Robot

REAL_SPECS: Final = "grbl:/dev/ttyUSB0, axidraw, axidraw:/dev/ttyACM0, xarm:IP, lite6:IP, franka:IP, ur:IP"
"""Specs of the machines that `machine` makes, as examples for people."""

SIMULATED_SPECS: Final = ("sim", "sim:pens", "sim:real")
"""Specs of the simulated easel."""

SPECS: Final = f"{', '.join(SIMULATED_SPECS)}, {REAL_SPECS}"
"""The same, and those of the simulated easel."""

FILE: Final = "hpgl"
"""Kind of any pen plotter that is not driven, but draws a file: none that `machine` makes."""

_SIMULATED = "sim"
_LIFT_ONLY = ("grbl", "axidraw", FILE)  # a Grbl counts as one with a servo, since its easel is not known yet


def kind_of(spec: str) -> str:
    """Return the kind of machine that a spec names: ``grbl`` of ``grbl:/dev/ttyUSB0``."""
    return spec.partition(":")[0]


def is_simulated(spec: str) -> bool:
    """Return whether a spec names the simulated easel, at whatever pace: no machine that `machine` makes."""
    return kind_of(spec) == _SIMULATED


def only_lifts(spec: str) -> bool:
    """Return whether machines of a kind only lift their pen, as far as that is known before one is connected.

    spec: of a machine, or only the kind that it begins with. Raises InputError where there is no such kind.
    """
    kind = kind_of(spec)
    kinds = (_SIMULATED, *_MACHINES, FILE)
    if kind not in kinds:
        raise InputError.of_choice("machine", spec, kinds)
    return kind in _LIFT_ONLY


def check_spec(spec: str) -> None:
    """Raise InputError for a spec that names no machine that `machine` makes, or does not say where it is."""
    name, _, address = spec.partition(":")
    if name == FILE:
        raise InputError(f"a plotter of {FILE} is not driven, but draws a file; write that with maulstick export")
    if name not in _MACHINES:
        raise InputError(f"there is no machine {spec!r}; there are: {SPECS}")
    if not address and name != "axidraw":
        raise InputError(f"{spec!r} does not say where the machine is; there are: {SPECS}")


def machine(spec: str, easel: Easel | None) -> Robot:
    """Return the machine that the spec names, not yet connected; the easel may narrow its limits.

    Raises InputError as `check_spec`, and where what drives that machine is not installed.
    """
    check_spec(spec)
    name, _, address = spec.partition(":")
    limits = None if easel is None else easel.limits
    return _MACHINES[name](address, easel, limits)


def _grbl(address: str, easel: Easel | None, limits: Limits | None) -> Robot:
    from maulstick.robot.adapters.grbl import Grbl

    return Grbl(address, None if easel is None else easel.pen, limits)


def _axidraw(address: str, easel: Easel | None, limits: Limits | None) -> Robot:
    from maulstick.robot.adapters.axidraw import AxiDraw

    return AxiDraw(address or None, None if easel is None else easel.pen, limits)


def _xarm(address: str, easel: Easel | None, limits: Limits | None) -> Robot:
    from maulstick.robot.adapters.xarm import XArm

    return XArm(address, limits)


def _lite6(address: str, easel: Easel | None, limits: Limits | None) -> Robot:
    from maulstick.robot.adapters.xarm import LITE6, XArm

    return XArm(address, LITE6 if limits is None else LITE6.narrowed(limits))


def _franka(address: str, easel: Easel | None, limits: Limits | None) -> Robot:
    from maulstick.robot.adapters.franka import Franka

    return Franka(address, limits)


def _ur(address: str, easel: Easel | None, limits: Limits | None) -> Robot:
    from maulstick.robot.adapters.ur import UR

    return UR(address, limits)


_MACHINES: Final[dict[str, Callable[[str, Easel | None, Limits | None], Robot]]] = {
    "grbl": _grbl,
    "axidraw": _axidraw,
    "xarm": _xarm,
    "lite6": _lite6,
    "franka": _franka,
    "ur": _ur,
}
