"""Reader of the CSV files that OptiTrack's Motive 2 and 3 export (format versions 1.2x and 1.3x)."""

import csv
import io
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation

from maulstick.errors import InputError
from maulstick.recording.mocap.bodies import CANVAS_MARKERS, pen_and_canvas
from maulstick.recording.mocap.motive_header import MOST_FRAMES, SHORTER, Axes, Header, read_header
from maulstick.recording.mocap.take import KIND, Take, is_unit, read_take
from maulstick.storage.arrays import Floats, kind_of
from maulstick.storage.files import file_to_read
from maulstick.storage.text import counted

_LARGEST = 2**33  # bytes: bounds time and memory
_BLOCK = 2**24  # bytes that are read at a time, and most of a line
_REACH = 100.0  # metres: no capture volume is larger, so a larger place is a mistake in the units


def read_motive(path: str | Path, pen: str | None = None, canvas: str | None = None) -> Take:
    """Read a take that Motive exported as CSV, with header, rigid bodies and markers, in global coordinates.

    A file of `write_take` is read too; its pen and canvas are already chosen.

    pen, canvas: names of rigid bodies; by default they are found by words in their names and by their markers (see
    `pen_and_canvas`).

    Columns are found by the header.  Cells are separated by commas or, then mostly with the decimal comma, by
    semicolons; an empty cell was not seen.  Measured markers ("Marker") are used where they were exported, else those
    computed from the rigid body's pose ("Rigid Body Marker").  Euler angles are as Motive documents them: degrees,
    about axes that turn with the body (intrinsic), in the order that the file states.  A last line without an end is
    left out: it was cut off, as by a full disk.

    Raises InputError where the file is too large (10 million frames, 8 GiB) or not such an export, and where the pen or
    the canvas cannot be found.
    """
    path = file_to_read(path, "Motive export")
    if (kind := kind_of(path)) == KIND:
        return read_take(path)
    if kind is not None:
        raise InputError(f"{path} holds {kind} already; there is nothing to record; look at it with maulstick show")
    try:
        if (size := path.stat().st_size) > _LARGEST:
            raise InputError(f"it has {size / 2**30:.1f} GiB, and at most 8 GiB can be read; {SHORTER}")
        with path.open("rb") as file:
            header = read_header(file)
            names = pen_and_canvas(
                {body: len(header.markers[body]) for body in header.poses}, len(header.loose), pen, canvas
            )
            return _read_take(file, header, *names)
    except InputError as error:
        raise InputError(f"cannot read the Motive export {path}: {error}") from error
    except OSError as error:
        raise InputError(f"cannot read the Motive export {path}: {error.strerror}") from error


def _read_take(file: BinaryIO, header: Header, pen: str, canvas: str | None) -> Take:
    order = "XYZW" if header.rotation == "QUATERNION" else header.rotation
    markers = header.markers[pen] + (header.loose if canvas is None else header.markers[canvas])
    columns = [
        header.time,
        *_places(f"the pen {pen!r}", header.poses[pen], "Rotation", order),
        *_places(f"the pen {pen!r}", header.poses[pen], "Position", "XYZ"),
        *(place for axes in markers for place in _places("a marker", axes, "Position", "XYZ")),
    ]
    parts: list[tuple[Floats, ...]] = []
    line = header.lines
    for block in _blocks(file):
        values = _numbers(block, header, columns, line)
        parts.append(_frames_of(values, header, len(order), line))
        line += len(values)
        if line - header.lines > MOST_FRAMES:
            raise InputError(f"it has over {MOST_FRAMES} frames, and no more can be read; {SHORTER}")
    if not parts:
        raise InputError("it has no frames; export it again")
    times, *seen = (np.concatenate(blocks) for blocks in zip(*parts, strict=True))
    rising = np.append(np.isfinite(times[:1]), times[1:] > times[:-1])
    if not rising.all():
        raise InputError(f"the time in line {header.lines + rising.argmin() + 1} does not rise; export it again")
    return Take(times, *seen)


def _places(thing: str, axes: Axes, quantity: str, order: str) -> list[int]:
    try:
        return [axes[quantity, axis] for axis in order]
    except KeyError as error:
        raise InputError(f"{thing} has no column {quantity} {error.args[0][1]}; export it again") from error


def _blocks(file: BinaryIO) -> Iterator[bytes]:
    """Yield the remaining lines of the file, about 16 MiB at a time."""
    rest = b""
    while read := file.read(_BLOCK):
        if len(rest) > _BLOCK:
            raise InputError("one of its lines is longer than 16 MiB; export it again")
        lines, _, rest = (rest + read).rpartition(b"\n")
        if lines := lines.strip(b"\r\n"):
            yield lines


def _numbers(block: bytes, header: Header, columns: list[int], line: int) -> Floats:
    """Parse these columns of the lines in a block, which begins after `line`; NaN where a cell is empty."""
    characters = np.frombuffer(block, np.uint8)
    if (characters == 0).any():
        raise InputError("there are zero bytes among its numbers; it is damaged, export it again")
    ends = np.append(np.flatnonzero(characters == ord("\n")), len(block))
    delimiters = np.flatnonzero(characters == ord(header.delimiter))
    cells = np.diff(np.searchsorted(delimiters, ends), prepend=0) + 1
    wrong = (cells != cells[0]) | (cells < header.filled) | (cells > header.cells + 1)
    if wrong.any():
        row = wrong.argmax()
        raise InputError(
            f"line {line + row + 1} has {counted(int(cells[row]), 'cell')}, and its header {header.cells}; "
            "export it again"
        )
    try:
        frame = pd.read_csv(
            io.BytesIO(block),
            sep=header.delimiter,
            decimal="," if header.delimiter == ";" and b"," in block else ".",
            header=None,
            usecols=columns,
            dtype=np.float64,
            keep_default_na=False,
            na_values=[""],
            quoting=csv.QUOTE_NONE,
            encoding="latin-1",
            skip_blank_lines=False,
        )
        values = frame[columns].to_numpy()
    except (ValueError, OverflowError) as error:
        raise _not_a_number(block, header, columns, line) from error
    if values.shape != (len(ends), len(columns)) or np.isinf(values).any():
        raise _not_a_number(block, header, columns, line)
    return values


def _not_a_number(block: bytes, header: Header, columns: list[int], line: int) -> InputError:
    for row, text in enumerate(block.decode("latin-1").split("\n")):
        cells = text.rstrip("\r").split(header.delimiter)
        for place in columns:
            cell = cells[place].replace(",", ".").strip()
            try:
                good = cell == "" or np.isfinite(float(cell))
            except ValueError:
                good = False
            if not good:
                return InputError(
                    f"cell {place + 1} of line {line + row + 1} is {cell[:40]!r}; it must be a number or empty"
                )
    return InputError(f"its numbers after line {line} cannot be read; export it again")


def _frames_of(values: Floats, header: Header, rotation: int, line: int) -> tuple[Floats, ...]:
    """Split values into the arrays of a `Take`; `rotation`: columns of the pen's rotation, after the times."""
    places = values[:, 1 + rotation :].reshape(len(values), -1, 3) * header.scale
    places[np.isnan(places).any(axis=2)] = np.nan
    far = (np.abs(places) > _REACH).any(axis=(1, 2))
    if far.any():
        raise InputError(
            f"line {line + far.argmax() + 1} has a place over 100 m away; check its Length Units and export it again"
        )
    rotations = values[:, 1 : 1 + rotation]
    seen = ~np.isnan(rotations).any(axis=1)
    quaternions = np.full((len(values), 4), np.nan)
    if header.rotation == "QUATERNION":
        quaternions[seen] = rotations[seen]
        wrong = seen & ~is_unit(quaternions)
        if wrong.any():
            raise InputError(
                f"line {line + wrong.argmax() + 1} has a quaternion that is not of length 1; export it again"
            )
    elif seen.any():
        quaternions[seen] = Rotation.from_euler(header.rotation, rotations[seen], degrees=True).as_quat()
    corners = places.shape[1] - CANVAS_MARKERS
    return (
        values[:, 0].copy(),
        places[:, 0].copy(),
        quaternions,
        places[:, 1:corners].copy(),
        places[:, corners:].copy(),
    )
