"""Sheet of a drawn hand, in the format of docs/pointer-events.md, and checks of the strokes on it."""

import json
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Self, final

import numpy as np

from maulstick.errors import InputError
from maulstick.storage.arrays import Floats
from maulstick.storage.files import read_whole

MOST_STROKES = 2_000
MOST_OF_A_STROKE = 10_000
MOST_POINTS = 500_000
"""Limits of a sheet, so that its file stays below what ``maulstick record ink`` reads."""

_MEMBERS = ("timeStamp", "x", "y", "pressure", "tiltX", "tiltY")  # of a point, as in a PointerEvent
_UPRIGHT = {"tiltX": 0, "tiltY": 0}  # of a pen whose tilt was not recorded
_ROUNDED = np.array([10.0, 1e3, 1e3, 1e3, 1.0, 1.0])  # steps per unit that are kept of each member
_LATEST = 1e13  # milliseconds; a browser counts them from 1970
_SLACK = 1e-3  # millimetres beyond the sheet, which rounding may add
_LARGEST = 64 * 2**20  # bytes of a drawing's file


@final
@dataclass(frozen=True, eq=False)
class DrawnStroke:
    """Stroke, from when the pen touches until it lifts.

    points: (m, 6) of a browser's timeStamp (ms), x, y (mm), pressure in [0, 1], tiltX and tiltY (degrees).
    text: the same as JSON.
    """

    points: Floats
    text: bytes

    @classmethod
    def of(cls, numbers: object, size: tuple[float, float]) -> Self:
        """Make a stroke from the numbers of its points in one list. size: of the sheet, metres.

        Raises InputError where it is no such list, is too long, or has an invalid point.
        """
        members = len(_MEMBERS)
        if not isinstance(numbers, list) or not numbers or len(numbers) % members:
            raise InputError(f"that is no stroke; it must be a list of {', '.join(_MEMBERS)} of each point")
        if len(numbers) > members * MOST_OF_A_STROKE:
            raise InputError.of_range("the points of a stroke", len(numbers) // members, f"at most {MOST_OF_A_STROKE}")
        if not all(type(number) in (int, float) for number in numbers):
            raise InputError("a stroke holds something that is no number; draw it again")
        try:
            points = np.array(numbers, dtype=np.float64).reshape(-1, members)
        except OverflowError:
            raise InputError("a stroke holds a number beyond all measure; draw it again") from None
        _check(points, size)
        points = np.round(points * _ROUNDED) / _ROUNDED
        named = [dict(zip(_MEMBERS, point, strict=True)) for point in points.tolist()]
        return cls(points, json.dumps(named, separators=(",", ":")).encode())


@dataclass(frozen=True)
class DrawnSheet:
    """Strokes drawn on a sheet. size: (width, height), metres."""

    size: tuple[float, float]
    strokes: tuple[DrawnStroke, ...]


def sheet_json(size: tuple[float, float], strokes: Iterable[DrawnStroke]) -> bytes:
    """Encode a sheet as a file for `read_sheet` and ``maulstick record ink``."""
    head = f'{{"schema_version":1,"size_mm":[{in_mm(size[0])},{in_mm(size[1])}],"strokes":[\n'
    return head.encode() + b",\n".join(stroke.text for stroke in strokes) + b"\n]}\n"


def read_sheet(path: Path) -> DrawnSheet:
    """Read the sheet in the file at `path`; a pen whose tilt was not recorded is upright.

    Raises InputError where it is none on which drawing can go on.
    """
    content = read_whole(path, "drawing", _LARGEST)
    try:
        record = json.loads(content)
        width, height = (float(side) * 1e-3 for side in record["size_mm"])
        shown = [[{**_UPRIGHT, **point} for point in points] for points in record["strokes"]]
        listed = [[point[member] for point in points for member in _MEMBERS] for points in shown]
        strokes = tuple(DrawnStroke.of(numbers, (width, height)) for numbers in listed)
        points = sum(len(stroke.points) for stroke in strokes)
        if len(strokes) > MOST_STROKES or points >= MOST_POINTS + MOST_OF_A_STROKE:  # the last one may go beyond
            raise ValueError("it has more strokes than a sheet holds")
    except (InputError, ValueError, TypeError, KeyError, RecursionError) as error:
        raise InputError(f"{path} is not a drawing of the studio: {error!s:.200}; move it elsewhere") from error
    return DrawnSheet((width, height), strokes)


def in_mm(metres: float) -> float:
    """Convert a side of a sheet to millimetres, rounded to a thousandth."""
    return round(1e3 * metres, 3)


def _check(points: Floats, size: tuple[float, float]) -> None:
    low = np.array([0, -_SLACK, -_SLACK, 0, -90, -90])
    high = np.array([_LATEST, in_mm(size[0]) + _SLACK, in_mm(size[1]) + _SLACK, 1, 90, 90])
    for member, values, least, most in zip(_MEMBERS, points.T, low, high, strict=True):
        out = values[~((values >= least) & (values <= most))]
        if len(out):
            raise InputError.of_range(f"{member} of a point of a stroke", f"{out[0]:g}", f"from {least:g} to {most:g}")
    if (np.diff(points[:, 0]) < 0).any():
        raise InputError("the times of a stroke run backwards; they must never fall from point to point")
