"""Uploaded files, called in errors by the names that people know."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeVar

from maulstick.errors import MaulstickError

LARGEST = 64 * 2**20
"""Largest upload, bytes."""

Content = TypeVar("Content")


@contextmanager
def known_as(path: Path, called: str) -> Iterator[None]:
    """Replace the path in errors that are raised inside by the name that people know the file by."""
    try:
        yield
    except MaulstickError as error:
        raise error.replaced(str(path), called) from error


def read_brought(content: bytes, read: Callable[[Path], Content], called: str) -> Content:
    """Read this content as `read` reads a file. called: name of the file in errors. Raises what `read` raises."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "brought"
        path.write_bytes(content)
        with known_as(path, called):
            return read(path)
