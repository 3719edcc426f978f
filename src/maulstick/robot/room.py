"""Room for a routine: whether the machine gets everywhere that it is sent, and if not, where the sheet should lie."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from maulstick.errors import InputError, option
from maulstick.robot.easel import Easel
from maulstick.robot.limits import Limits
from maulstick.robot.reach import Reach
from maulstick.robot.robot import Robot
from maulstick.storage.arrays import Floats, Ints

_SAME: Final = 1e-3  # metres: in so small a cube, the machine is asked for one place
_CELL: Final = (
    0.02  # metres: of so large a cube, it is asked for the nearest and the farthest place of a sheet elsewhere
)
_LEAST: Final = 1e-3  # metres from the axis, nearer to which there is no direction away from it
_SHIFTS: Final = tuple(sorted(np.arange(-100, 101) / 100, key=abs))[1:]  # metres by which the sheet is tried elsewhere
_ASKED_SHIFTS: Final = tuple(sorted(np.arange(-10, 11) / 50, key=abs))[1:]  # the same, of which a machine is asked
_ELSEWHERE: Final = (
    "lay the sheet elsewhere, plan for a smaller one, or turn or scale an SVG with "
    f"{option('rotate')} or {option('size')}"
)

_TRAY_ELSEWHERE: Final = (
    "give the tray's file another place for that well, or a lower clearance, or lay sheet and tray elsewhere"
)


@dataclass(frozen=True)
class Way:
    """Way of the tip.

    name: what it is for, as in ``stroke 12``.  path: (n, 3) places in the machine's frame, metres.
    speed: (k,) metres per second at most where the tip is lowered; None where it only goes over to the next place.
    in_tray: whether it is in a well of the tray.
    """

    name: str
    path: Floats
    speed: Floats | None
    in_tray: bool = False


def check_room(ways: Sequence[Way], easel: Easel, limits: Limits) -> None:
    """Raise InputError where a way leaves the workspace or the reach, or is too fast, counting the others that do."""
    faults: list[tuple[Way, str]] = []
    for way in ways:
        if way.speed is None:
            continue  # the workspace is a box: a straight way between two places of it lies in it
        try:
            limits.check_path(way.path)
            limits.check_speed(way.speed)
        except InputError as error:
            faults.append((way, f"{way.name}: {error}"))
    if faults:
        way, fault = faults[0]
        raise InputError(f"{fault}{_more(len(faults))}; {_advice(way)}")
    if limits.reach is not None and ways:
        _check_reach(ways, easel, limits, limits.reach)


def _check_reach(ways: Sequence[Way], easel: Easel, limits: Limits, reach: Reach) -> None:
    missed: list[tuple[Way, Floats]] = []
    for way in ways:
        beyond = np.abs(reach.beyond(way.path))
        if beyond.any():
            missed.append((way, way.path[beyond.argmax()]))
    missed = [(way, place) for way, place in missed if way.speed is not None] or missed
    if missed:
        way, place = missed[0]
        where = _elsewhere(ways, way, _places(ways), limits.holds, _SHIFTS)
        raise InputError(f"{_named(way, place, easel)} {reach.fault(place)}{_more(len(missed))}; {where}")


def check_accepted(ways: Sequence[Way], easel: Easel, robot: Robot) -> None:
    """Raise InputError where the machine, which is asked for every place, says that it does not get to one.

    Of places in one cubic millimetre it is asked for the first. The ways have passed `check_room`. The machine must be
    connected; nothing moves. Raises StoppedError where it is stopped meanwhile.
    """
    if not robot.knows_its_reach or not ways:
        return
    places = _places(ways)
    asked = _distinct(places)
    refused = next((index for index in asked if not robot.accepts(places[index])), None)
    if refused is None:
        return
    owner = np.repeat(np.arange(len(ways)), [len(way.path) for way in ways])[refused]

    def accepts(moved: Floats) -> bool:
        return robot.limits.holds(moved) and all(robot.accepts(place) for place in moved)

    first = np.concatenate([[refused], _spread(places)])
    where = _elsewhere(ways, ways[owner], places[first], accepts, _ASKED_SHIFTS)
    raise InputError(
        f"{_named(ways[owner], places[refused], easel)} is refused by the machine itself: by the range of a joint, a "
        f"singular pose, itself in its way, or a boundary that is set there; {where}"
    )


def _more(count: int) -> str:
    return f" (and {count - 1} more like it)" if count > 1 else ""


def _named(way: Way, place: Floats, easel: Easel) -> str:
    x, y, _ = 1e3 * easel.machine_to_canvas(place)
    there = ", ".join(f"{value:.0f}" for value in 1e3 * place)
    return f"{way.name}, at x {x:.0f} and y {y:.0f} mm of the sheet, which is ({there}) mm of the machine,"


def _places(ways: Sequence[Way]) -> Floats:
    return np.concatenate([way.path for way in ways])


def _distinct(places: Floats) -> Ints:
    """Return the indices (k,) of the first of the places (n, 3) in each cubic millimetre, in their order."""
    return np.sort(np.unique(np.floor(places / _SAME), axis=0, return_index=True)[1])


def _spread(places: Floats) -> Ints:
    """Return the indices (k,) of the places (n, 3) that are nearest to and farthest from the base in each cell."""
    radius = np.hypot(places[:, 0], places[:, 1])
    order = np.argsort(radius, kind="stable")
    cells = np.floor(places / _CELL)
    nearest = order[np.unique(cells[order], axis=0, return_index=True)[1]]
    farthest = order[::-1][np.unique(cells[order[::-1]], axis=0, return_index=True)[1]]
    return np.unique(np.concatenate([nearest, farthest]))


def _advice(way: Way) -> str:
    return _TRAY_ELSEWHERE if way.in_tray else _ELSEWHERE


def _elsewhere(
    ways: Sequence[Way], missed: Way, places: Floats, holds: Callable[[Floats], bool], shifts: Sequence[float]
) -> str:
    """Return what to do about a way that is missed: how far to move the sheet, and with it the tray where there is one.

    It is moved along the line from the base to the middle of the places (n, 3) of all ways.
    """
    what = "the sheet and the tray" if any(way.in_tray for way in ways) else "the sheet"
    middle = (places.min(axis=0) + places.max(axis=0))[:2] / 2
    distance = float(np.linalg.norm(middle))
    away = np.array([*middle, 0.0]) / distance if distance > _LEAST else np.array([1.0, 0.0, 0.0])
    for shift in shifts:
        if holds(places + shift * away):
            return f"move {what} {1e3 * abs(shift):.0f} mm {'farther from' if shift > 0 else 'nearer to'} the base"
    return f"nowhere on its line from the base is there room: {_advice(missed)}"
