"""Header of a Motive export: units, rotations, and the meaning of each column."""

import codecs
import csv
from dataclasses import dataclass
from itertools import pairwise
from typing import BinaryIO, NamedTuple

from maulstick.errors import InputError
from maulstick.recording.mocap.bodies import check_names

MOST_FRAMES = 10_000_000
"""Most frames that are read: over 11 hours at 240 Hz."""

SHORTER = "export a shorter range of frames"
"""Remedy for a file that is too long."""

_LINES = 20  # of a header; Motive writes fewer
_LONGEST = 2**24  # bytes of a line
_UNITS = {  # metres
    **dict.fromkeys(("meters", "metres", "m"), 1.0),
    **dict.fromkeys(("centimeters", "centimetres", "cm"), 1e-2),
    **dict.fromkeys(("millimeters", "millimetres", "mm"), 1e-3),
}
_BODY, _SOLVED, _MARKER = "Rigid Body", "Rigid Body Marker", "Marker"  # Motive's kinds of columns

Axes = dict[tuple[str, str], int]
"""Indices of the columns of one thing by quantity and axis, such as ("Position", "X")."""


@dataclass(frozen=True)
class Header:
    """Header of an export.

    lines: number of its lines.  delimiter: between cells.  scale: metres per unit.
    rotation: QUATERNION, or the order of Euler angles.  cells: number of cells of its last line.
    filled: the same without empty cells at the end.  time: column of times.
    poses, markers, loose: columns of each rigid body, of its markers, and of each marker without a rigid body.
    """

    lines: int
    delimiter: str
    scale: float
    rotation: str
    cells: int
    filled: int
    time: int
    poses: dict[str, Axes]
    markers: dict[str, list[Axes]]
    loose: list[Axes]


class _Thing(NamedTuple):
    """Thing that a column belongs to. parent: a marker's rigid body, where stated.  others: Motive's numbers of it."""

    kind: str
    name: str
    parent: str
    others: tuple[str, ...]


def read_header(file: BinaryIO) -> Header:
    """Read the header of a file. Raises InputError where it is not one of Motive's."""
    first = file.readline(_LONGEST)
    if first.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        raise InputError("it is in UTF-16; save it as CSV in UTF-8")
    first = first.removeprefix(codecs.BOM_UTF8)
    delimiter = ";" if first.count(b";") > first.count(b",") else ","
    facts = _cells(first, delimiter, 1)
    if facts[:1] != ["Format Version"]:
        raise InputError("it does not begin with 'Format Version'; export it from Motive as CSV, header included")
    rows: list[list[str]] = []
    while len(rows) < _LINES:
        line = file.readline(_LONGEST)
        if not line.endswith(b"\n"):
            raise InputError(f"it ends or has too long a line in line {len(rows) + 2}, in its header; export it again")
        cells = _cells(line, delimiter, len(rows) + 2)
        if cells[:1] == ["Frame"]:
            return _header_of(facts, delimiter, rows, cells)
        rows.append(cells)
    raise InputError("its header has no line that begins with 'Frame'; export it again, header included")


def _cells(line: bytes, delimiter: str, number: int) -> list[str]:
    try:
        text = line.decode()
    except UnicodeDecodeError:
        text = line.decode("latin-1")
    try:
        return [cell.strip() for cells in csv.reader([text], delimiter=delimiter) for cell in cells]
    except csv.Error as error:
        raise InputError(f"line {number}, in its header, is not CSV ({error}); export it again") from error


def _header_of(facts: list[str], delimiter: str, rows: list[list[str]], axes: list[str]) -> Header:
    scale, rotation = _conventions(dict(pairwise(facts)))
    known = {_BODY, _SOLVED, _MARKER}
    top = next((place for place, row in enumerate(rows) if known & set(row)), len(rows))
    if len(rows) - top < 3:
        raise InputError("its header names no rigid bodies and markers; export it with both, header included")
    times = [place for place, axis in enumerate(axes) if axis.casefold() in ("time", "time (seconds)")]
    if not times:
        raise InputError("it has no column 'Time (Seconds)'; export it again, header included")
    kinds, names, *others, quantities = (row + [""] * (len(axes) - len(row)) for row in rows[top:])
    parents = next((row for row in others if "Parent" in row[:2]), [""] * len(axes))
    things: dict[_Thing, Axes] = {}
    for place, (axis, quantity, kind, name, parent, *rest) in enumerate(
        zip(axes, quantities, kinds, names, parents, *others, strict=False)
    ):
        if kind not in known or quantity not in ("Position", "Rotation"):
            continue
        thing = _Thing(kind, name, parent, tuple(rest))
        if things.setdefault(thing, {}).setdefault((quantity, axis), place) != place:
            raise InputError(f"two columns are {quantity} {axis!r} of {name[:40]!r}; export it again")
    check_names([thing.name for thing in things if thing.kind == _BODY])
    poses = {thing.name: columns for thing, columns in things.items() if thing.kind == _BODY}
    seen: dict[str, dict[str | None, list[Axes]]] = {_MARKER: {}, _SOLVED: {}}
    for thing, columns in things.items():
        if thing.kind != _BODY:
            seen[thing.kind].setdefault(_body_of(thing, poses), []).append(columns)
    return Header(
        lines=len(rows) + 2,
        delimiter=delimiter,
        scale=scale,
        rotation=rotation,
        cells=len(axes),
        filled=max(place + 1 for place, axis in enumerate(axes) if axis),
        time=times[0],
        poses=poses,
        markers={body: seen[_MARKER].get(body) or seen[_SOLVED].get(body, []) for body in poses},
        loose=seen[_MARKER].get(None, []),
    )


def _conventions(facts: dict[str, str]) -> tuple[float, str]:
    """Return metres per unit, and QUATERNION or the order of Euler angles."""
    unit = facts.get("Length Units", "")
    if unit.casefold() not in _UNITS:
        raise InputError(f"its Length Units are {unit[:40]!r}; they must be Meters, Centimeters or Millimeters")
    rotation = facts.get("Rotation Type", "").upper()
    if rotation != "QUATERNION" and sorted(rotation) != ["X", "Y", "Z"]:
        raise InputError(f"its Rotation Type is {rotation[:40]!r}; it must be Quaternion, or an order of axes, as XYZ")
    space = facts.get("Coordinate Space", "Global")
    if space.casefold() != "global":
        raise InputError(f"its Coordinate Space is {space[:40]!r}; export it in Global coordinates")
    frames = facts.get("Total Exported Frames", "")
    if frames.isdecimal() and float(frames) > MOST_FRAMES:
        raise InputError(f"it has {float(frames):.0f} frames, and at most {MOST_FRAMES} can be read; {SHORTER}")
    return _UNITS[unit.casefold()], rotation


def _body_of(marker: _Thing, bodies: dict[str, Axes]) -> str | None:
    if marker.parent in bodies:
        return marker.parent
    owners = [body for body in bodies if marker.name.startswith((f"{body}:", f"{body}_"))]
    return max(owners, key=len, default=None)
