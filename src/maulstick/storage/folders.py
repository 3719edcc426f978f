"""Folders of results: made and tested before the work begins, and filled with all results at once."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile
from typing import Final

from maulstick.errors import InputError, OutputError, option

MAKE_ROOM: Final = "make room for it there"
"""Remedy where nothing can be written into a folder that is not to be another."""

_OTHER = f"choose another {option('out')}"
_ROOM = 2**20  # bytes, about what a painting takes: room that must be free before the work begins


@contextmanager
def made_folder(out: Path, remedy: str | None = None) -> Iterator[None]:
    """Make the folder `out` and test that it can be written; at the end remove made folders that stayed empty.

    Raises OutputError, with a remedy as `as_output_error`, where the folder cannot be made or written.
    """
    with as_output_error(out, remedy):
        made = [folder for folder in (out, *out.parents) if not folder.exists()]
    try:
        with as_output_error(out, remedy):
            out.mkdir(parents=True, exist_ok=True)
            with TemporaryFile(dir=out) as file:
                file.write(bytes(_ROOM))
        yield
    finally:
        for folder in made:
            with suppress(OSError):  # not empty
                folder.rmdir()


def check_no_file(out: Path) -> None:
    """Raise OutputError where a file is in the place of the folder `out`."""
    if out.exists() and not out.is_dir():
        raise OutputError(f"{out} is a file, not a folder; {_OTHER}")


@contextmanager
def all_or_nothing(out: Path) -> Iterator[Path]:
    """Provide a temporary folder for results: at the end all are moved into `out`, or, after an error, none.

    Raises OutputError where a result cannot be written.
    """
    with as_output_error(out), TemporaryDirectory(dir=out, prefix=".maulstick-") as staging:
        try:
            yield Path(staging)
        except OutputError as error:
            raise error.replaced(staging, str(out)) from error
        written = sorted(Path(staging).iterdir())
        for path in written:
            if (out / path.name).is_dir():
                raise OutputError(f"cannot write {out / path.name}: it is a folder; choose another {option('out')}")
        for path in written:
            path.replace(out / path.name)


@contextmanager
def whole_folder(folder: Path, taken: str) -> Iterator[Path]:
    """Provide a temporary folder that is `folder` at the end; after an error nothing is left of it.

    Raises InputError with the text `taken` where there is such a folder by then, OutputError where there is no room.
    """
    with as_output_error(folder.parent, MAKE_ROOM), TemporaryDirectory(dir=folder.parent, prefix=".") as temporary:
        made = Path(temporary) / folder.name
        made.mkdir()
        yield made
        if folder.exists():  # and where it comes into being now, the rename fails
            raise InputError(taken)
        made.rename(folder)


@contextmanager
def as_output_error(out: Path, remedy: str | None = None) -> Iterator[None]:
    """Turn every OSError into an OutputError that names the folder `out`, and a remedy: another folder, if left out."""
    try:
        yield
    except OutputError:
        raise
    except OSError as error:
        told = f"cannot write into the folder {out}: {error.strerror or error}"
        raise OutputError(f"{told}; {remedy or _OTHER}") from error
