"""Folders of results: made and seen to be writable before the work, and all results in one appear together."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile

from maulstick.errors import OutputError, option

_ROOM = 2**20  # bytes: what a painting takes at least


@contextmanager
def made_folder(out: Path) -> Iterator[None]:
    """Make the folder `out` and see that it can be written; at the end whatever was made and is empty goes again."""
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
    """A folder to write results into, which at the end all take their places in `out`, or, after an error, none."""
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
    """Whatever cannot be done in the folder `out` is an OutputError."""
    try:
        yield
    except OutputError:
        raise
    except OSError as error:
        raise OutputError(
            f"cannot write into the folder {out}: {error.strerror}; choose another {option('out')}"
        ) from error
