"""The journal of a painting: the strokes that a machine began and finished, one JSON line each.

It lies beside its painting. Each line is on the disk before anything else happens. A last line that a power cut left
incomplete is dropped when the journal is opened again: its stroke had not been begun, or counts as unfinished.
"""

import hashlib
import json
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from typing import Annotated, Final, Literal, Self

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, FiniteFloat, JsonValue, TypeAdapter

from maulstick.errors import InputError, OutputError, Remedy
from maulstick.storage.arrays import Floats
from maulstick.storage.files import append_whole, file_sum, file_to_read, held, read_whole, sync_folder

SCHEMA_VERSION: Final = 1
"""Version of the journal's lines."""

_LARGEST = 2**28  # bytes that are read at most: more than millions of strokes need
_Sum = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
_Id = Annotated[int, Field(ge=0)]


def _lies_beside(file: str) -> str:
    if file in ("", ".", "..") or "/" in file:
        raise ValueError("it must be the name of a file beside the journal")
    return file


class _Line(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Revision(_Line):
    """Line that names the painting from here on, a file beside the journal; a journal begins with one.

    painted: ids of its strokes that count as painted already.
    """

    event: Literal["revision"] = "revision"
    schema_version: Literal[1] = SCHEMA_VERSION
    file: Annotated[str, AfterValidator(_lies_beside)]
    sha256: _Sum
    painted: tuple[_Id, ...] = ()


class Begin(_Line):
    """Line before a stroke: the machine is about to paint it."""

    event: Literal["begin"] = "begin"
    stroke: _Id


class End(_Line):
    """Line after a stroke: it is painted."""

    event: Literal["end"] = "end"
    stroke: _Id


class Again(_Line):
    """Line that says that a stroke was begun, and is to be painted again from its start."""

    event: Literal["again"] = "again"
    stroke: _Id


class OptionsLine(_Line):
    """Line with the options that the machine paints with from here on, so that they need not be given again."""

    event: Literal["options"] = "options"
    options: dict[str, JsonValue]


class HomeLine(_Line):
    """Line with the place of the tip, metres in the machine's frame, while the sheet is put in or photographed."""

    event: Literal["home"] = "home"
    place: tuple[FiniteFloat, FiniteFloat, FiniteFloat]


Line = Annotated[Revision | OptionsLine | HomeLine | Begin | End | Again, Field(discriminator="event")]
_LINE: TypeAdapter[Line] = TypeAdapter(Line)


def journal_of(painting: Path, copy: int = 1) -> Path:
    """Return the path of the journal of a painting, or of a further copy of it, counted from 1."""
    return painting.with_name(f"{painting.stem}.log.jsonl" if copy == 1 else f"{painting.stem}.copy{copy}.log.jsonl")


def was_begun(journal: Path) -> bool:
    """Return whether there is anything in the journal at this path. Raises InputError where there can be none."""
    try:
        return journal.exists() and journal.stat().st_size > 0
    except OSError as error:
        fault = f"there can be no journal {journal}: {error.strerror}"
        raise InputError(f"{fault}; give the painting a shorter name, or another folder") from error


def begun_with(journal: Path) -> str | None:
    """Return the name of the file that the journal at this path was begun with, None where it cannot be read."""
    try:
        entry = _LINE.validate_python(json.loads(read_whole(journal, "journal", _LARGEST).partition(b"\n")[0]))
    except (ValueError, RecursionError):
        return None
    return entry.file if isinstance(entry, Revision) else None


def latest_sheet(painting: Path) -> int:
    """Return the number of the latest sheet that was begun, from 1. Raises InputError where none was."""
    path = journal_of(painting)
    if not path.exists():
        raise InputError(f"there is no journal {path}, so nothing was begun", Remedy.START)
    return next(number for number in count(1) if not was_begun(journal_of(painting, number + 1)))


def latest_journal(painting: Path) -> Path | None:
    """Return the path of the journal of the latest sheet, None where none was begun. Raises as `was_begun` does."""
    return journal_of(painting, latest_sheet(painting)) if was_begun(journal_of(painting)) else None


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Lock the journal at `path`, whatever is in it, against other processes while the context lasts.

    Raises InputError where another has it, OutputError where nothing can be written there.
    """
    taken = f"another maulstick paints by {path}; wait until it has finished, or stop it"
    with held(path.with_name(f".{path.name}.lock"), taken, f"cannot write {path}", "mend that before painting"):
        yield


class Journal:
    """Journal that can be read and continued; only one process at a time has it open (`Journal.open`).

    painted: ids of the strokes that are finished.  unfinished: id of the stroke that was begun, not finished.
    options: the options that were last written, {} where none were.
    home: place (3,) of the tip while the sheet is put in or photographed, metres; None where none was written.
    begun: whether a machine began any stroke.
    revision: the latest revision of the painting.  revisions: number of revisions, that one included.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.painted: set[int] = set()
        self.unfinished: int | None = None
        self.options: dict[str, JsonValue] = {}
        self.home: Floats | None = None
        self.begun = False
        self.revision: Revision | None = None
        self.revisions = 0
        self._file: int | None = None

    @classmethod
    @contextmanager
    def open(cls, path: Path) -> Iterator[Self]:
        """Open the journal at `path`, and begin one where there is none.

        Raises InputError where another process has it, or it is not a journal; OutputError where it cannot be written.
        """
        with locked(path):
            journal = cls(path)
            try:
                journal._begin()
                yield journal
            finally:
                journal._end()

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read the journal at `path`, even if a process has it open. Raises InputError where it is none."""
        journal = cls(path)
        journal._take_whole_lines(read_whole(path, "journal", _LARGEST))
        return journal

    def revise(self, file: Path, painted: Iterable[int] = (), sha256: str | None = None) -> None:
        """Write that the painting is from now on this file beside the journal, and that these ids are painted.

        sha256: of the file when it was read, in hexadecimal digits; left out, as it is now.
        """
        digest = sha256 or file_sum(file, "painting")
        self._append(Revision(file=file.name, sha256=digest, painted=tuple(painted)))

    def write_options(self, options: dict[str, JsonValue]) -> None:
        """Write the options that the machine paints with from now on, unless they are the last ones written."""
        if options != self.options:
            self._append(OptionsLine(options=options))

    def write_home(self, place: Floats) -> None:
        """Write the place (3,) of the tip while the sheet is put in or photographed, unless it is written already."""
        if self.home is None or not np.array_equal(self.home, place):
            x, y, z = place.tolist()
            self._append(HomeLine(place=(x, y, z)))

    def begin(self, stroke: int) -> None:
        """Write that a stroke is about to be painted."""
        self._append(Begin(stroke=stroke))

    def end(self, stroke: int) -> None:
        """Write that a stroke is painted, by the machine, or because the operator says so."""
        self._append(End(stroke=stroke))

    def again(self, stroke: int) -> None:
        """Write that the unfinished stroke has to be painted again, as the operator decided."""
        self._append(Again(stroke=stroke))

    def painting(self) -> Path:
        """Return the file of the latest revision. Raises InputError where its content has changed since."""
        assert self.revision is not None
        path = self.path.with_name(self.revision.file)
        content = read_whole(file_to_read(path, "painting"), "painting", _LARGEST)
        if hashlib.sha256(content).hexdigest() != self.revision.sha256:
            raise InputError(f"{path} is not the file that {self.path} was begun with", Remedy.PUT_BACK_OR_RESTART)
        return path

    def _begin(self) -> None:
        try:
            self._file = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o644)
            sync_folder(self.path.parent)
            content = self.path.read_bytes()
            whole = self._take_whole_lines(content)
            if whole < len(content):
                os.ftruncate(self._file, whole)
                os.fsync(self._file)
        except OSError as error:
            raise OutputError(f"cannot write {self.path}: {error.strerror}; mend that before painting") from error

    def _take_whole_lines(self, content: bytes) -> int:
        """Read all complete lines of the content, and return their length in bytes."""
        whole = content[: content.rfind(b"\n") + 1]
        for number, line in enumerate(whole.splitlines(), start=1):
            self._take(line, number)
        return len(whole)

    def _take(self, line: bytes, number: int) -> None:
        fault = f"line {number} of {self.path} is not one of a journal"
        try:
            entry = _LINE.validate_python(
                json.loads(line)
            )  # pydantic's own reader refuses file names that are not UTF-8
        except (ValueError, RecursionError) as error:
            raise InputError(fault, Remedy.MEND_OR_RESTART) from error
        if self.revision is None and not isinstance(entry, Revision):
            raise InputError(fault, Remedy.MEND_OR_RESTART)
        self._understand(entry)

    def _understand(self, entry: Line) -> None:
        match entry:
            case Revision():
                self.revision = entry
                self.revisions += 1
                self.painted.update(entry.painted)
            case OptionsLine(options=options):
                self.options = options
            case HomeLine(place=place):
                self.home = np.array(place)
            case Begin(stroke=stroke):
                self.unfinished, self.begun = stroke, True
            case End(stroke=stroke):
                self.painted.add(stroke)
                self.unfinished = None
            case Again():
                self.unfinished = None

    def _append(self, entry: Line) -> None:
        assert self._file is not None
        try:
            append_whole(self._file, json.dumps(entry.model_dump(mode="json")).encode() + b"\n")
        except OSError as error:
            fault = f"cannot write {self.path}: {error.strerror}; mend that"
            if self.revision is None:  # nothing was begun, so there is nothing to go on with
                raise OutputError(f"{fault} before painting") from error
            raise OutputError(fault, Remedy.GO_ON) from error
        self._understand(entry)

    def _end(self) -> None:
        if self._file is not None:
            unused = os.fstat(self._file).st_size == 0
            os.close(self._file)
            self._file = None
            if unused:
                self.path.unlink(missing_ok=True)
