"""Array types, and files of arrays: NumPy's own format with a kind and a version of the contents."""

import io
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from maulstick.errors import InputError
from maulstick.storage.files import atomic_write, file_to_read

Floats = NDArray[np.float64]
"""Real numbers, in double precision."""

Complexes = NDArray[np.complex128]
"""Directions without a sign, exp(2i angle), times how sure or how long they are."""

Ints = NDArray[np.int64]
"""Counts, or indices into another array."""

Bools = NDArray[np.bool_]
"""A mask, or one answer per row."""

Image = NDArray[np.float32]
"""A picture, (H, W, 3) in sRGB or (H, W) in grey, with values in [0, 1]."""

Pixels = NDArray[np.float32]
"""A value per pixel that need not be a colour, such as a difference; also a picture where `Image` means Pillow's."""

VERSION = 1
"""Version of the format that is written, and the only one that is read."""

LARGEST = 2**31
"""Bytes, unpacked, of a usual file: over 60 hours of drawing."""


def write_arrays(path: str | Path, kind: str, arrays: Mapping[str, NDArray[np.generic]]) -> None:
    """Write the arrays as a file of this kind, the same bytes for the same arrays.

    Raises OutputError where that fails; what was at `path` is then still there.
    """
    file = io.BytesIO()
    np.savez_compressed(file, allow_pickle=False, kind=np.array(kind), version=np.array(VERSION), **arrays)
    atomic_write(path, file.getvalue())


def kind_of(path: str | Path) -> str | None:
    """Return the kind of the file at `path`, or None where it is not a file of arrays.

    Raises InputError where there is no file, or it would unpack to more than 2 GiB.
    """
    path = file_to_read(path, "file")
    try:
        with _opened(path, "file") as entries:
            return str(_read(entries, "kind"))
    except InputError:
        raise
    except Exception:  # a broken zip raises nearly anything
        return None


def read_arrays(
    path: str | Path, kind: str, names: tuple[str, ...] | None = None, largest: int = LARGEST
) -> dict[str, NDArray[np.generic]]:
    """Return the arrays with these names, or all, in the file of this kind at `path`, of at most `largest` bytes.

    Raises InputError where there is no such file, it is of another kind, damaged or of another version, or an array
    holds neither numbers nor text.
    """
    path = file_to_read(path, kind)
    try:
        with _opened(path, kind, largest) as entries:
            if (came := str(_read(entries, "kind"))) != kind:
                raise InputError(f"{path} holds {came}; it must be a file of {kind}")
            if (version := int(_read(entries, "version"))) != VERSION:
                raise InputError(f"{path} is of version {version}, and this Maulstick reads {VERSION}; write it again")
            arrays = {name: _read(entries, name) for name in (names or _names(entries))}
    except InputError:
        raise
    except Exception as error:
        raise InputError(f"{path} is not a file of {kind}, or it is damaged: {' '.join(str(error).split())}") from error
    for name, array in arrays.items():
        if array.dtype.kind not in "fiuU":
            raise InputError(f"{path} is not a file of {kind}: {name} is made of {array.dtype}, not of numbers or text")
    return arrays


@contextmanager
def _opened(path: Path, kind: str, largest: int = LARGEST) -> Iterator[zipfile.ZipFile]:
    with zipfile.ZipFile(path) as entries:  # reads no more of an entry than it declares
        unpacked = sum(entry.file_size for entry in entries.infolist())
        if unpacked > largest:
            raise InputError(f"{path} unpacks to {unpacked >> 20} MiB; no {kind} is that large")
        yield entries


def _names(entries: zipfile.ZipFile) -> list[str]:
    names = (name.removesuffix(".npy") for name in entries.namelist())
    return [name for name in names if name not in ("kind", "version")]


def _read(entries: zipfile.ZipFile, name: str) -> NDArray[np.generic]:
    with entries.open(f"{name}.npy") as entry:
        array: NDArray[np.generic] = npy.read_array(entry, allow_pickle=False)
        return array
