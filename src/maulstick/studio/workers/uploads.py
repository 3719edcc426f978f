"""Files that people brought, read under the names that they know them by."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeVar

from maulstick.errors import MaulstickError

LARGEST = 64 * 2**20
"""Bytes of one upload."""

Content = TypeVar("Content")


@contextmanager
def known_as(path: Path, called: str) -> Iterator[None]:
    """While it lasts an error calls the file at `path` what people call it."""
    try:
        yield
    except MaulstickError as error:
        raise error.replaced(str(path), called) from error


def read_brought(content: bytes, read: Callable[[Path], Content], called: str) -> Content:
    """What `read` makes of a file with this content; raises as it does, with the file `called` so."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "brought"
        path.write_bytes(content)
        with known_as(path, called):
            return read(path)
