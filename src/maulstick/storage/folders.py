"""Folders of results: made and tested before the work begins, and filled with all results at once."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile

from maulstick.errors import OutputError, option

_ROOM = 2**20  # bytes, about what a painting takes: room that must be free before the work begins


@contextmanager
def made_folder(out: Path) -> Iterator[None]:
    """Make the folder `out` and test that it can be written; at the end remove made folders that stayed empty.

    Raises OutputError where the folder cannot be made or written.
    """
    with as_output_error(out):
        made = [folder for folder in (out, *out.parents) if not folder.exists()]
    try:
        with as_output_error(out):
            out.mkdir(parents=True, exist_ok=True)
            with TemporaryFile(dir=out) as file:
                file.write(bytes(_ROOM))
        yield
    finally:
        for folder in made:
            with suppress(OSError):  # not empty
                folder.rmdir()


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
def as_output_error(out: Path) -> Iterator[None]:
    """Turn every OSError into an OutputError that names the folder `out`."""
    try:
        yield
    except OutputError:
        raise
    except OSError as error:
        raise OutputError(
            f"cannot write into the folder {out}: {error.strerror}; choose another {option('out')}"
        ) from error
