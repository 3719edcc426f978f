"""Paints in tubes: a usual set, and sets in files."""

import csv
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError

from maulstick.colour.palette import parse_colour
from maulstick.errors import InputError, validation_fault
from maulstick.storage.files import read_whole

_LARGEST_FILE = 2**20  # bytes: far more than 256 paints take; a larger file is something else
_MOST = 256  # paints in a set; more would make mixing slow
_LONGEST_NAME = 80  # characters, which fit into a line of output


@dataclass(frozen=True)
class NamedPaint:
    """A paint in its tube: the name on the tube and the colour, sRGB in [0, 1]."""

    name: str
    colour: tuple[float, float, float]


USUAL_PAINTS: Final = tuple(
    NamedPaint(name, parse_colour(colour))
    for name, colour in {
        "titanium white": "#f7f7f2",
        "ivory black": "#1b1a1c",
        "hansa yellow": "#f4dd1c",
        "cadmium yellow": "#f8b80f",
        "yellow ochre": "#c08a35",
        "cadmium red": "#c9281e",
        "quinacridone magenta": "#a51f57",
        "burnt sienna": "#8a4524",
        "burnt umber": "#422d22",
        "ultramarine": "#2a2f8f",
        "phthalo blue": "#123a82",
        "phthalo green": "#0f5a4e",
    }.items()
)
"""Twelve artists' acrylics. Their colours are nominal, about what makers' charts show; none was measured."""


class _Entry(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)

    name: str
    colour: str


def read_paints(path: str | Path) -> tuple[NamedPaint, ...]:
    """Return the set of paints in a file: lines ``name,colour`` (CSV), or a JSON list of ``{"name": …, "colour": …}``.

    A colour is ``#rrggbb`` or its name; a first line ``name,colour`` is a heading.
    Raises InputError, naming the line or the entry, where the file cannot be read, or has no paints, more than 256 or
    the same name twice.
    """
    content = read_whole(path, "file of paints", _LARGEST_FILE)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = "\0"
    if "\0" in text:
        raise InputError(f"{path} is not text; write one paint per line, as in: ultramarine,#2a2f8f")
    paints: dict[str, NamedPaint] = {}
    entries = _of_json(path, text) if text.lstrip().startswith(("[", "{")) else _of_csv(path, text)
    for where, name, colour in entries:
        paint = _paint(f"{path}, {where}", name, colour)
        if paint.name.casefold() in paints:
            raise InputError(f"{path}, {where}: there is already a paint {paint.name!r}; give every paint its own name")
        if len(paints) == _MOST:
            raise InputError(f"{path} has more than {_MOST} paints; leave out those that are not at hand")
        paints[paint.name.casefold()] = paint
    if not paints:
        raise InputError(f"{path} has no paints; write one per line, as in: ultramarine,#2a2f8f")
    return tuple(paints.values())


def _of_csv(path: str | Path, text: str) -> Iterator[tuple[str, str, str]]:
    """Yield (where, name, colour) of each line that is not empty."""
    rows = csv.reader(text.splitlines(keepends=True), skipinitialspace=True)
    try:
        for row in rows:
            where = f"line {rows.line_num}"
            cells = [cell.strip() for cell in row]
            if not any(cells) or (rows.line_num == 1 and [cell.lower() for cell in cells] == ["name", "colour"]):
                continue
            if len(cells) != 2:
                shape = f"it has {len(cells)} column{'s' if len(cells) > 1 else ''} and must have 2"
                raise InputError(f"{path}, {where}: {shape}; write name,colour, as in: ultramarine,#2a2f8f")
            yield where, cells[0], cells[1]
    except csv.Error as error:
        raise InputError(f"{path}, line {rows.line_num}: {error}; write name,colour") from error


def _of_json(path: str | Path, text: str) -> Iterator[tuple[str, str, str]]:
    try:
        entries = TypeAdapter(list[_Entry]).validate_json(text)
    except ValidationError as error:
        form = '[{"name": "ultramarine", "colour": "#2a2f8f"}, …]'
        raise InputError(f"{path} is not a list of paints: {validation_fault(error)}; write {form}") from error
    for number, entry in enumerate(entries, start=1):
        yield f"entry {number}", entry.name.strip(), entry.colour.strip()


def _paint(where: str, name: str, colour: str) -> NamedPaint:
    if not 1 <= len(name) <= _LONGEST_NAME or not name.isprintable():
        raise InputError(f"{where}: the name must have 1 to {_LONGEST_NAME} printable characters")
    try:
        return NamedPaint(name, parse_colour(colour))
    except InputError as error:
        raise InputError(f"{where}: {error}") from error
