"""``maulstick edit``: changes strokes of a painting by hand, before the rest is planned again."""

from collections.abc import Callable
from functools import partial
from itertools import islice
from math import isfinite, radians
from pathlib import Path
from typing import Annotated, TypeVar

import numpy as np
import typer
from rich.console import Console

from maulstick.cli.folder import check_place
from maulstick.errors import InputError
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import read_painting, write_painting
from maulstick.painting.stroke_edits import (
    AddStroke,
    LockStrokes,
    MoveStrokes,
    RemoveStrokes,
    RepaintStrokes,
    StrokeEdit,
    UnlockStrokes,
    edited,
)
from maulstick.storage.text import counted
from maulstick.strokes.ink import read_ink

_HELD = 0.5  # pressure of drawn strokes without any: half as deep as a brush goes
_DIGITS = 18  # of a number; Python reads none of thousands

_SAY_SIZE = "; say it with maulstick record ink --size, and add that ink"

_edits = partial(typer.Option, rich_help_panel="Edits, made in this order")
_writing = partial(typer.Option, rich_help_panel="What is written")
Value = TypeVar("Value")


def edit(
    painting: Annotated[Path, typer.Argument(help="The painting.json of a plan.")],
    repaint: Annotated[
        list[str] | None, _edits(metavar="IDS:N", help="Give strokes the N-th paint: 12,15-20:3. It locks them.")
    ] = None,
    move: Annotated[
        list[str] | None,
        _edits(metavar="IDS:X,Y", help="Move strokes by millimetres, to the right and down: 12:2.5,-1. It locks them."),
    ] = None,
    turn: Annotated[
        list[str] | None,
        _edits(metavar="IDS:DEGREES", help="Turn strokes clockwise, about their middle: 12-14:30. It locks them."),
    ] = None,
    add: Annotated[
        list[str] | None,
        _edits(
            metavar="N:FILE",
            help="Add drawn strokes, ink or any file that `record ink` reads, in the N-th paint; locked.",
        ),
    ] = None,
    unlock: Annotated[list[str] | None, _edits(metavar="IDS", help="Let planning change these strokes again.")] = None,
    lock: Annotated[
        list[str] | None, _edits(metavar="IDS", help="Lock strokes, so that planning again leaves them as they are.")
    ] = None,
    remove: Annotated[list[str] | None, _edits(metavar="IDS", help="Take strokes out.")] = None,
    out: Annotated[Path | None, _writing(metavar="FILE", help="The painting.json to write.")] = None,
    overwrite: Annotated[bool, _writing("--overwrite", metavar="", help="Replace what is there.")] = False,
) -> None:
    """Change strokes of a painting by hand; `maulstick plan --again` then plans the rest around the locked ones.

    Strokes are named by their ids, as 3,7-12: painting.svg has them as stroke-3, and painting.json as "id". A region's
    name stands for all of its strokes, and all for all. Paints count from 1, as in "paints" of painting.json: brush by
    brush, the broadest first, and of each from light to dark.

    Example: maulstick edit cat/painting.json --lock 3,7-12 --remove 40 --out cat/mine.json
    """
    if out is None:
        raise InputError("name the file to write, with --out cat/mine.json")
    if out.suffix.lower() != ".json":
        raise InputError(f"--out is {out}; a painting is written as JSON, so let its name end in .json")
    check_place(out, "--out", overwrite)
    if out.resolve() in {Path(text.partition(":")[2]).resolve() for text in add or []}:
        raise InputError(f"--out is {out}, a drawing that --add names; choose another --out")
    before = read_painting(painting)
    edits: list[StrokeEdit] = []
    for text in repaint or []:
        ids, paint = _parts(text, "--repaint", "12,15-20:3", int, before)
        edits.append(RepaintStrokes(strokes=ids, paint=_index(paint, before)))
    for text in move or []:
        ids, by = _parts(text, "--move", "12:2.5,-1", _millimetres, before)
        edits.append(MoveStrokes(strokes=ids, by=by))
    for text in turn or []:
        ids, degrees = _parts(text, "--turn", "12-14:30", _finite, before)
        edits.append(MoveStrokes(strokes=ids, turn=radians(degrees)))
    for text in add or []:
        edits.extend(_drawn(text, before))
    if unlock:
        edits.append(UnlockStrokes(strokes=_ids(",".join(unlock), "--unlock", before)))
    if lock:
        edits.append(LockStrokes(strokes=_ids(",".join(lock), "--lock", before)))
    if remove:
        edits.append(RemoveStrokes(strokes=_ids(",".join(remove), "--remove", before)))
    if not edits:
        raise InputError("there is nothing to change; give --lock, --remove or another edit")
    after = edited(before, edits)
    write_painting(after, out)
    locked = sum(stroke.locked for stroke in after.strokes)
    print(f"{out}: {counted(len(after.strokes), 'stroke')}, {locked} of them locked")


def _index(number: int, painting: Painting) -> int:
    if not 1 <= number <= len(painting.paints):
        raise InputError.of_range("the paint", number, f"from 1 to {len(painting.paints)}")
    return number - 1


def _drawn(text: str, painting: Painting) -> list[AddStroke]:
    number, colon, file = text.partition(":")
    if not (colon and _is_number(number)):
        raise InputError(f"--add is {text!r}; it must be a paint's number and a file, as in 2:signature.json")
    from maulstick.recording.files.ink_files import read_ink_file  # loads parsers

    path, paint = Path(file), _index(int(number), painting)
    ink = (
        read_ink(path) if path.suffix.lower() == ".npz" else read_ink_file(path, note=_print_note, remedy=_SAY_SIZE)[0]
    )
    strokes = []
    for samples in ink.strokes():
        points = samples[:, 1:4]
        points[:, 2] = np.where(np.isnan(points[:, 2]), _HELD, points[:, 2])
        strokes.append(AddStroke(paint=paint, trajectory=tuple(map(tuple, points.tolist()))))
    return strokes


def _print_note(note: str) -> None:
    console = Console(stderr=True, markup=False, highlight=False)
    console.print(f"note: {note}", soft_wrap=True)


def _parts(
    text: str, name: str, example: str, value_of: Callable[[str], Value], painting: Painting
) -> tuple[tuple[int, ...], Value]:
    """Return the ids before the colon, and the value after it."""
    named, colon, value = text.partition(":")
    fault = f"{name} is {text!r}; it must be like {example}"
    if not colon:
        raise InputError(fault)
    ids = _ids(named, name, painting)
    try:
        return ids, value_of(value)
    except ValueError:
        raise InputError(fault) from None


def _ids(text: str, name: str, painting: Painting) -> tuple[int, ...]:
    if not painting.strokes:
        raise InputError(f"{name} names strokes, and there are none in this painting; draw some with --add")
    ids: list[int] = []
    for part in map(str.strip, text.split(",")):
        if of_region := [stroke.id for stroke in painting.strokes if part in ("all", stroke.region)]:
            ids.extend(of_region)
            continue
        first, dash, last = part.partition("-")
        if not (_is_number(first) and (_is_number(last) or not dash)):
            raise InputError(f"{name} names {part!r}; strokes are named by their ids, as in 3,7-12, or a region's name")
        begin, end = int(first), int(last or first)
        if begin > end:
            raise InputError(f"{name} names {part!r}; a range goes from a smaller id to a larger one, as in 7-12")
        ids.extend(islice(range(begin, end + 1), len(painting.strokes) + 1))  # of more, one of these is not there
    return tuple(ids)


def _is_number(text: str) -> bool:
    return text.isdecimal() and len(text) <= _DIGITS


def _finite(text: str) -> float:
    number = float(text)
    if not isfinite(number):
        raise ValueError(text)
    return number


def _millimetres(text: str) -> tuple[float, float]:
    x, y = (_finite(number) / 1e3 for number in text.split(","))
    return x, y
