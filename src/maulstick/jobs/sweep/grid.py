"""Grid of a sweep: a TOML file of options with several values, whose combinations are its cells."""

import hashlib
import re
import tomllib
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from itertools import product
from pathlib import Path
from typing import Any, Final

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, JsonValue, TypeAdapter, ValidationError, field_validator

from maulstick.errors import InputError, validation_fault
from maulstick.jobs.plan.before import kept_options, picture_near
from maulstick.jobs.plan.options import FILES, PlanOptions
from maulstick.jobs.plan.request import PlanRequest
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import read_painting
from maulstick.storage.files import read_whole
from maulstick.storage.library import all_placed

MOST_CELLS: Final = 10_000
"""Cells of one sweep; more are most likely a mistake."""

TABLE: Final = "sweep.csv"
"""Name of the table, beside the cells."""

SHEET: Final = "sweep.png"
"""Name of the contact sheet, beside the cells."""

LIBRARIES: Final = ("style", "brush")
"""Options that are names from a library, or files."""

_PICTURE = "picture"
_KNOWN = {_PICTURE, *(each.name for each in fields(PlanOptions))}
_LARGEST = 2**20  # bytes: far more than any grid takes
_LONG_VALUE, _LONG_NAME = 40, 160  # letters: longer ones are cut, and end in a sum of the whole


@dataclass(frozen=True)
class Cell:
    """One combination. name: of its folder.  values: those of its axes, as the grid writes them."""

    name: str
    values: Mapping[str, JsonValue]
    request: PlanRequest


class Grid(BaseModel):
    """A sweep as it is asked for.

    axes: lists of values by option; `picture` is one of them.  options: values that all cells have.
    slurm: parameters of submitit for Slurm, as timeout_min and slurm_partition.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    axes: dict[str, list[JsonValue]]
    options: dict[str, JsonValue] = Field(default_factory=dict)
    slurm: dict[str, JsonValue] = Field(default_factory=dict)

    @field_validator("axes", "options", mode="before")
    @classmethod
    def _as_in_a_file(cls, value: Any) -> Any:
        return _written(value)

    def cells(self, folder: Path, read: Callable[[Path], Painting] = read_painting) -> list[Cell]:
        """Return all combinations, the last axis fastest; paths of files are relative to `folder`.

        A painting that is planned again is so with its options and, where none is named, its picture. read: reads it.
        Raises InputError for an unknown option, an axis without values, a combination that contradicts itself, and a
        painting that cannot be planned again.
        """
        self._check()
        cells = [self._cell(dict(zip(self.axes, each, strict=True)), folder, read) for each in product(*self._lists())]
        names = Counter(cell.name.casefold() for cell in cells)
        name, times = names.most_common(1)[0]
        if times > 1:
            raise InputError(
                f"{times} cells would share the folder {name}; name each value of an axis once, and files so that "
                "their names differ"
            )
        for name in {*names} & {TABLE, SHEET}:
            raise InputError(f"the folder of a cell would be {name}, as a result is called; rename that file")
        return cells

    def columns(self) -> int:
        """Return how many cells stand beside each other: those of the last axis that has several values."""
        return next((len(values) for values in reversed(self._lists()) if len(values) > 1), 1)

    def _lists(self) -> list[list[JsonValue]]:
        return list(self.axes.values())

    def _check(self) -> None:
        if not self.axes:
            raise InputError("axes names no option; give at least one, as in seed = [0, 1, 2]")
        for name in (*self.axes, *self.options):
            if name not in _KNOWN:
                raise InputError.of_choice("option", name, _KNOWN)
        cells = 1
        for name, values in self.axes.items():
            if not values:
                raise InputError(f"the axis {name} has no value; give it some, or leave it out")
            if name in self.options:
                raise InputError(f"{name} is an axis and an option of all cells; leave one of them out")
            cells *= len(values)
        if cells > MOST_CELLS:
            raise InputError.of_range("the number of cells", cells, f"at most {MOST_CELLS}; shorten an axis")

    def _cell(self, values: dict[str, JsonValue], folder: Path, read: Callable[[Path], Painting]) -> Cell:
        name = _cut("_".join(_label(*each) for each in values.items()), _LONG_NAME)
        given: dict[str, Any] = {
            each: _placed(each, value, folder) for each, value in {**self.options, **values}.items()
        }
        picture = given.pop(_PICTURE, None)
        if isinstance(file := given.get("again"), Path):
            painting = read(file)
            picture, given = picture or picture_near(painting, file), {**kept_options(painting, given), **given}
        if picture is None and given.get("text") is None:
            raise InputError("there is nothing to paint; give the axes or the options a picture, or a text")
        for each, value in given.items():
            if each != "exact" and _has_truth(value):  # which would be read as 0 or 1
                raise InputError(f"the cell {name}: {each} has true or false, as only exact can")
        try:
            request = _REQUEST.validate_python({"picture": picture, "options": given})
            request.options.check_counted()
        except ValidationError as error:
            ours = error.errors()[0].get("ctx", {}).get("error")
            raise InputError(f"the cell {name}: {ours or validation_fault(error)}") from error
        except InputError as error:
            raise InputError(f"the cell {name}: {error}") from error
        return Cell(name, values, request)


_REQUEST = TypeAdapter(PlanRequest)


def _has_truth(value: object) -> bool:
    """Return whether true or false is a value, or among its parts."""
    parts = value.values() if isinstance(value, Mapping) else value if isinstance(value, list | tuple) else ()
    return isinstance(value, bool) or any(map(_has_truth, parts))


def read_grid(path: str | Path) -> Grid:
    """Return the grid in a TOML file. Raises InputError, naming it, where there is none."""
    try:
        plain = tomllib.loads(read_whole(path, "grid", _LARGEST).decode())
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path} is not TOML: {error}; see maulstick sweep --help for a grid") from error
    return grid_of(plain, str(path))


def grid_of(plain: Mapping[str, object], source: str) -> Grid:
    """Return the grid of a mapping, which errors call `source`. Raises InputError where it is none."""
    try:
        return Grid.model_validate(plain)
    except ValidationError as error:
        if "axes" not in plain:
            raise InputError(f"{source} is not a grid; add a table [axes], as in seed = [0, 1]") from error
        raise InputError(f"{source} is not a grid: {validation_fault(error)}") from error


def _written(value: Any) -> Any:
    """Return a value that Python's options take as a file has it: a path as text, a tuple as a list, plain numbers."""
    if isinstance(value, Mapping):
        return {name: _written(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [_written(each) for each in value]
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    return str(value) if isinstance(value, Path) else value


def _placed(name: str, value: JsonValue, folder: Path) -> Any:
    """Return the path of a file that is named relative to a folder, and any other value as it is."""
    if isinstance(value, str) and name in (_PICTURE, *FILES):
        return (folder / value).absolute()
    if isinstance(value, str) and name in LIBRARIES:
        return all_placed(value, folder)  # of several brushes, too
    return value


def _label(name: str, value: JsonValue) -> str:
    """Return a value for the name of a folder; those that say what they are of stand alone."""
    text = re.sub(r"[^\w.+-]+", "-", _plain(value)).strip("-.") or "none"
    return _cut(text if name in (_PICTURE, *LIBRARIES) else f"{name}-{text}", _LONG_VALUE)


def _plain(value: JsonValue) -> str:
    if isinstance(value, dict):
        return "-".join(f"{name}-{_plain(each)}" for name, each in value.items())
    return "-".join(map(_plain, value)) if isinstance(value, list) else str(value)


def _cut(text: str, most: int) -> str:
    return text if len(text) <= most else f"{text[: most - 9]}-{hashlib.sha256(text.encode()).hexdigest()[:8]}"
