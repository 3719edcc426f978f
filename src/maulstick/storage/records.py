"""Files of one record each: JSON that a pydantic model checks, written whole or not at all."""

from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from maulstick.errors import InputError, validation_fault
from maulstick.storage.files import atomic_write, read_whole

Record = TypeVar("Record", bound=BaseModel)

_LARGEST = 2**20  # bytes: far more than any record takes; a larger file is something else


def read_record(kind: type[Record], path: str | Path, what: str) -> Record:
    """Return the record in the file at `path`, which errors call a `what`. Raises InputError where there is none."""
    try:
        return kind.model_validate_json(read_whole(path, what, _LARGEST))
    except ValidationError as error:
        raise InputError(f"{path} is not {_article(what)} {what}: {validation_fault(error)}") from error


def write_record(record: BaseModel, path: str | Path) -> None:
    """Write the record as JSON. Raises OutputError where that fails; what was at `path` is then still there."""
    atomic_write(path, f"{record.model_dump_json(indent=2, exclude_none=True)}\n".encode())


def _article(what: str) -> str:
    return "an" if what[0] in "aeiou" else "a"
