"""The logbook of all machines: what each pen drew in each run, one JSON line per run.

It lies beside the machines' other files, in the user's data.
"""

import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Literal, final

from platformdirs import user_data_path
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from maulstick.errors import InputError, OutputError, validation_fault
from maulstick.painting.painting import Painting
from maulstick.robot.execute import PaintProgress
from maulstick.robot.routine import Draw
from maulstick.storage.files import read_whole

_LARGEST = 2**26  # bytes that are read at most: more than a hundred thousand runs
_BEGINNING = b"{"  # of each line, and of one that is incomplete
_SUMS = ("metres", "seconds", "strokes")
_Sum = Annotated[float, Field(ge=0, allow_inf_nan=False)]


class PenUse(BaseModel):
    """Use of a pen: metres drawn, seconds that the machine needed for its strokes and the way to them, and strokes."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    pen: str
    metres: _Sum = 0.0
    seconds: _Sum = 0.0
    strokes: Annotated[int, Field(ge=0)] = 0


class LoggedRun(BaseModel):
    """Line of the logbook. at: when the run ended.  machine: its spec.  painting: path of the file."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    schema_version: Literal[1] = 1
    at: datetime
    machine: str
    painting: str
    pens: tuple[PenUse, ...]


@dataclass(frozen=True)
class PenTotal:
    """Use of a pen in several runs; last: when the latest of them ended."""

    use: PenUse
    runs: int
    last: datetime


@final
class Tally:
    """Tally of what each pen of a painting draws in a run, from its progress."""

    def __init__(self, painting: Painting) -> None:
        self._names = [f"{paint.brush} {paint.label}" for paint in painting.paints]
        self._uses: dict[str, PenUse] = {}
        self._before: PaintProgress | None = None

    def note(self, progress: PaintProgress) -> None:
        """Count the stroke that was painted before this progress, where one was."""
        before = self._before
        if before is not None and isinstance(before.action, Draw):
            name = self._names[before.action.paint]
            use = self._uses.get(name, PenUse(pen=name))
            metres, seconds = progress.drawn - before.drawn, progress.took - before.took
            counted = {"metres": use.metres + metres, "seconds": use.seconds + seconds, "strokes": use.strokes + 1}
            self._uses[name] = use.model_copy(update=counted)
        self._before = None if progress.action is None else progress

    def write(self, machine: str, painting: Path) -> None:
        """Append a line to the logbook, unless no stroke was painted. Raises OutputError where that fails."""
        if not self._uses:
            return
        now = datetime.now(UTC).replace(microsecond=0)
        run = LoggedRun(at=now, machine=machine, painting=str(painting.absolute()), pens=tuple(self._uses.values()))
        path = logbook_path()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o644)
            try:
                line = f"{_line_end(file)}{run.model_dump_json()}\n"
                os.write(file, line.encode())  # one write: two machines may end at once
            finally:
                os.close(file)
        except OSError as error:
            raise OutputError(f"cannot write the logbook {path}: {error.strerror}") from error


def _line_end(file: int) -> str:
    """Return what ends the last line of a file: nothing, unless a power cut left it incomplete."""
    size = os.fstat(file).st_size
    return "" if size == 0 or os.pread(file, 1, size - 1) == b"\n" else "\n"


def logbook_path() -> Path:
    """Return the path of the logbook, whether or not it is there."""
    return user_data_path("maulstick", appauthor=False) / "machines" / "logbook.jsonl"


def read_logbook() -> list[LoggedRun]:
    """Return all runs of the logbook, oldest first, [] where there is none. Raises InputError where a line is not one.

    Lines that a power cut left incomplete are left out.
    """
    path = logbook_path()
    if not path.exists():
        return []
    lines = read_whole(path, "logbook", _LARGEST).split(b"\n")[:-1]
    runs = []
    for number, line in enumerate(lines, start=1):
        try:
            runs.append(LoggedRun.model_validate(json.loads(line)))
        except ValidationError as error:
            fault = validation_fault(error)
            raise InputError(f"line {number} of {path} is not one of a logbook: {fault}; remove it") from error
        except (ValueError, RecursionError) as error:
            if line.startswith(_BEGINNING):
                continue
            raise InputError(f"line {number} of {path} is not one of a logbook; remove it") from error
    return runs


def totals(runs: Iterable[LoggedRun]) -> Mapping[str, PenTotal]:
    """Return the use of each pen in all these runs, by its name, most metres first."""
    found: dict[str, PenTotal] = {}
    for run in runs:
        for use in run.pens:
            before = found.get(use.pen, PenTotal(PenUse(pen=use.pen), 0, run.at))
            counted = {name: getattr(before.use, name) + getattr(use, name) for name in _SUMS}
            use = before.use.model_copy(update=counted)
            found[use.pen] = replace(before, use=use, runs=before.runs + 1, last=max(before.last, run.at))
    return dict(sorted(found.items(), key=lambda item: -item[1].use.metres))
