"""Strokes as HPGL, for pen plotters: 40 units per millimetre from the lower left corner, y up, one pen per paint."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from maulstick.errors import InputError, option
from maulstick.robot.limits import Limits
from maulstick.storage.arrays import Floats

CAROUSEL: Final = 8
"""Pens that a plotter holds, unless another number is named: as HP's desk plotters of that time."""

_UNITS_PER_METRE = 40_000  # HPGL's plotter unit is 1/40 mm
_MOST_UNITS = 32_767  # HPGL's coordinates have 16 bits: 819 mm from the origin
_NEAR = 1e-6  # units: a limit so near to a whole number counts as that number
_SLOWEST, _FASTEST = 1, 127  # centimetres per second that VS takes


@dataclass(frozen=True)
class CarouselLoad:
    """Strokes that one filling of a plotter's pens draws: HPGL, and the paints in the pens, from pen 1."""

    text: str
    paints: tuple[int, ...]


def hpgl(
    strokes: Iterable[tuple[int, Floats]],
    limits: Limits,
    carousel: int = CAROUSEL,
    speed: float | None = None,
    shrink: bool = False,
) -> list[CarouselLoad]:
    """Return HPGL of strokes in order: each a paint's index and a path (n, 3) in the machine's frame, metres.

    The first paint is pen 1. With more paints than the `carousel` has pens, they are numbered as they are first used,
    and where a paint finds no free one, another load begins. Heights are left out.
    speed: of drawing, metres per second, None for the plotter's own.
    shrink: draw all smaller where HPGL's coordinates do not reach so far.
    Raises InputError where a path leaves the limits, or HPGL's coordinates, and for a speed slower than VS says.
    """
    wanted = list(strokes)
    for _, path in wanted:
        limits.check_path(path)
    units = _within_reach([_units(path, limits) for _, path in wanted], shrink)
    begin = "IN;" if speed is None else f"IN;VS{_centimetres(speed)};"
    loads: list[CarouselLoad] = []
    paints = max((paint for paint, _ in wanted), default=-1) + 1
    lines, pens, held = [begin], list(range(paints)) if paints <= carousel else [], None
    for (paint, _), places in zip(wanted, units, strict=True):
        if paint not in pens and len(pens) == carousel:
            loads.append(_load(lines, pens))
            lines, pens, held = [begin], [], None
        if paint not in pens:
            pens.append(paint)
        if paint != held:
            lines.append(f"PU;SP{pens.index(paint) + 1};")
            held = paint
        first, *rest = (f"{x:.0f},{y:.0f}" for x, y in places)
        lines.append(f"PU{first};PD{','.join(rest or [first])};")
    return [*loads, _load(lines, pens)]


def _load(lines: Sequence[str], pens: Sequence[int]) -> CarouselLoad:
    return CarouselLoad("\n".join([*lines, "PU;SP0;\n"]), tuple(pens))


def _centimetres(speed: float) -> int:
    """Return a speed in metres per second as the whole centimetres per second of VS, rounded down."""
    whole = int(np.floor(100 * speed + _NEAR))
    if whole < _SLOWEST:
        raise InputError.of_range(option("speed"), f"{1e3 * speed:g} mm/s", "at least 10 mm/s for HPGL")
    return min(whole, _FASTEST)


def _within_reach(units: list[Floats], shrink: bool) -> list[Floats]:
    """Return places (n, 2) each, whole units within HPGL's coordinates. Raises InputError as `hpgl`."""
    farthest = max((float(np.abs(places).max()) for places in units), default=0.0)
    if farthest <= _MOST_UNITS:
        return units
    if not shrink:
        came, most = (f"{1e3 * reach / _UNITS_PER_METRE:.0f} mm" for reach in (farthest, _MOST_UNITS))
        raise InputError(
            f"the drawing reaches {came} from the plotter's origin, and HPGL counts up to {most}; draw it smaller with "
            f"{option('shrink')}, plan for a smaller sheet, or scale an SVG with {option('size')}"
        )
    return [np.rint(places * (_MOST_UNITS / farthest)) + 0.0 for places in units]


def _units(path: Floats, limits: Limits) -> Floats:
    """Return whole plotter units (n, 2) of a path (n, 3), metres, rounded towards the inside at the limits."""
    lower = np.ceil(np.array(limits.lower[:2]) * _UNITS_PER_METRE - _NEAR)
    upper = np.floor(np.array(limits.upper[:2]) * _UNITS_PER_METRE + _NEAR)
    return np.asarray(np.clip(np.rint(path[:, :2] * _UNITS_PER_METRE), lower, upper) + 0.0)
