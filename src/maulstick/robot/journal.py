"""The journal of a painting: what a machine began and what it finished, a line at a time, each on the disk before more.

It lies beside its painting. A line that a power cut tore is dropped when it is opened again: what it said had not
happened yet, or is asked about.
"""

import errno
import hashlib
import json
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Annotated, Final, Literal, Self

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, JsonValue, TypeAdapter

from maulstick.errors import InputError, OutputError, Remedy
from maulstick.storage.files import file_to_read, held, read_whole, sync_folder

SCHEMA_VERSION: Final = 1
_LARGEST = 2**28  # bytes: millions of strokes
_Sum = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
_Id = Annotated[int, Field(ge=0)]


def _lies_beside(file: str) -> str:
    if file in ("", ".", "..") or "/" in file:
        raise ValueError("it must be the name of a file beside the journal")
    return file


class _Line(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Revision(_Line):
    """From here on the painting is this file, beside the journal; the first line of a journal is one.

    painted: ids of its strokes that count as painted before the machine began.
    """

    event: Literal["revision"] = "revision"
    schema_version: Literal[1] = SCHEMA_VERSION
    file: Annotated[str, AfterValidator(_lies_beside)]
    sha256: _Sum
    painted: tuple[_Id, ...] = ()


class Begin(_Line):
    """The machine is about to paint this stroke."""

    event: Literal["begin"] = "begin"
    stroke: _Id


class End(_Line):
    """After a stroke."""

    event: Literal["end"] = "end"
    stroke: _Id


class Again(_Line):
    """A stroke was begun, and is to be painted as if it had not been."""

    event: Literal["again"] = "again"
    stroke: _Id


class OptionsLine(_Line):
    """The options that the machine is asked to paint with from here on, so that --resume need not repeat them."""

    event: Literal["options"] = "options"
    options: dict[str, JsonValue]


Line = Annotated[Revision | OptionsLine | Begin | End | Again, Field(discriminator="event")]
_LINE: TypeAdapter[Line] = TypeAdapter(Line)


def journal_of(painting: Path) -> Path:
    """Where the journal of a painting lies."""
    return painting.with_name(f"{painting.stem}.log.jsonl")


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """While it lasts no other process opens the journal at `path`, whatever is in it.

    Raises InputError where another has it, OutputError where nothing can be written there.
    """
    taken = f"another maulstick paints by {path}; wait until it has finished, or stop it"
    with held(path.with_name(f".{path.name}.lock"), taken, f"cannot write {path}", "mend that before painting"):
        yield


class Journal:
    """A journal, open to be read and continued; one process at a time has it (`Journal.open`).

    painted: ids of the strokes that are finished.  unfinished: the stroke that was begun and not finished, if any.
    options: those that the machine was last asked to paint with, {} where none were written.
    revision: the painting as it is painted now.  revisions: how many there were, that one included.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.painted: set[int] = set()
        self.unfinished: int | None = None
        self.options: dict[str, JsonValue] = {}
        self.revision: Revision | None = None
        self.revisions = 0
        self._file: int | None = None

    @classmethod
    @contextmanager
    def open(cls, path: Path) -> Iterator[Self]:
        """The journal at `path`, which is begun if there is none.

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
        """The journal at `path` as it is now, whoever continues it. Raises InputError where it is none."""
        journal = cls(path)
        journal._take_whole_lines(read_whole(path, "journal", _LARGEST))
        return journal

    def revise(self, file: Path, painted: Iterable[int] = ()) -> None:
        """From now on the painting is that file, beside the journal, and the strokes with these ids are painted."""
        content = read_whole(file, "painting", _LARGEST)
        digest = hashlib.sha256(content).hexdigest()
        self._append(Revision(file=file.name, sha256=digest, painted=tuple(painted)))

    def write_options(self, options: dict[str, JsonValue]) -> None:
        """Write down the options that the machine paints with from now on, unless they are the last ones written."""
        if options != self.options:
            self._append(OptionsLine(options=options))

    def begin(self, stroke: int) -> None:
        """Before a stroke."""
        self._append(Begin(stroke=stroke))

    def end(self, stroke: int) -> None:
        """After it; also for a stroke that a person says was painted."""
        self._append(End(stroke=stroke))

    def again(self, stroke: int) -> None:
        """A person says that the unfinished stroke has to be painted."""
        self._append(Again(stroke=stroke))

    def painting(self) -> Path:
        """The file of the latest revision. Raises InputError where it is not the file that it was."""
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
        """How many bytes they are."""
        whole = content[: content.rfind(b"\n") + 1]
        for number, line in enumerate(whole.splitlines(), start=1):
            self._take(line, number)
        return len(whole)

    def _take(self, line: bytes, number: int) -> None:
        fault = f"line {number} of {self.path} is not one of a journal"
        try:
            entry = _LINE.validate_python(json.loads(line))  # pydantic's own reader knows no names of any bytes
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
            case Begin(stroke=stroke):
                self.unfinished = stroke
            case End(stroke=stroke):
                self.painted.add(stroke)
                self.unfinished = None
            case Again():
                self.unfinished = None

    def _append(self, entry: Line) -> None:
        assert self._file is not None
        line = json.dumps(entry.model_dump(mode="json")).encode() + b"\n"
        size = os.fstat(self._file).st_size
        try:
            if os.write(self._file, line) != len(line):
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            os.fsync(self._file)
        except OSError as error:
            with suppress(OSError):
                os.ftruncate(self._file, size)
            raise OutputError(f"cannot write {self.path}: {error.strerror}; mend that", Remedy.GO_ON) from error
        self._understand(entry)

    def _end(self) -> None:
        if self._file is not None:
            unused = os.fstat(self._file).st_size == 0
            os.close(self._file)
            self._file = None
            if unused:
                self.path.unlink(missing_ok=True)
