"""Where results go: nothing there is lost by accident, and all results in a folder appear together."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile

from maulstick.errors import OutputError

_ROOM = 2**20  # bytes: what a painting takes at least


def check_absent(path: Path, option: str, overwrite: bool) -> None:
    """Raise OutputError where there is something at `path`, which that option sets, that is not to be overwritten."""
    if os.path.lexists(path) and not overwrite:
        raise OutputError(f"{path} is already there; choose another {option}, or add --overwrite")


def check_free(out: Path, overwrite: bool) -> None:
    """Raise OutputError where `out` is a file, or a folder with something in it that is not to be overwritten."""
    with _as_output_error(out):
        if out.exists() and not out.is_dir():
            raise OutputError(f"{out} is a file, not a folder; choose another --out")
        if out.is_dir() and any(out.iterdir()) and not overwrite:
            raise OutputError(f"the folder {out} is not empty; choose another --out, or add --overwrite")


@contextmanager
def made_folder(out: Path) -> Iterator[None]:
    """Make the folder `out` and see that it can be written; at the end whatever was made and is empty goes again."""
    with _as_output_error(out):
        made = [folder for folder in (out, *out.parents) if not folder.exists()]
    try:
        with _as_output_error(out):
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
    with _as_output_error(out), TemporaryDirectory(dir=out, prefix=".maulstick-") as staging:
        try:
            yield Path(staging)
        except OutputError as error:
            raise OutputError(str(error).replace(staging, str(out))) from error
        written = sorted(Path(staging).iterdir())
        for path in written:
            if (out / path.name).is_dir():
                raise OutputError(f"cannot write {out / path.name}: it is a folder; choose another --out")
        for path in written:
            path.replace(out / path.name)


@contextmanager
def _as_output_error(out: Path) -> Iterator[None]:
    try:
        yield
    except OutputError:
        raise
    except OSError as error:
        raise OutputError(f"cannot write into the folder {out}: {error.strerror}; choose another --out") from error
