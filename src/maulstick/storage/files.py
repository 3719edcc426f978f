"""Files that are checked before they are read, written whole or not at all, or locked by one process."""

import errno
import hashlib
import os
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from filelock import FileLock, Timeout

from maulstick.errors import InputError, OutputError
from maulstick.storage.text import made_printable

_REMEDY = {  # what to do, by the system's error
    errno.ENOSPC: "the disk is full; free some space and run again",
    errno.EDQUOT: "your disk quota is used up; free some space and run again",
    errno.EFBIG: "the file would be larger than is allowed here; write to another disk",
    errno.EACCES: "there is no permission to write there; choose another folder",
    errno.EPERM: "there is no permission to write there; choose another folder",
    errno.EROFS: "that disk can only be read; choose another folder",
    errno.ENOENT: "its folder does not exist; make the folder first",
    errno.ENOTDIR: "its folder is a file; choose another folder",
    errno.ELOOP: "its links lead in a circle; choose another name",
    errno.ENAMETOOLONG: "its name is too long; choose a shorter one",
}


def file_to_read(path: str | Path, what: str) -> Path:
    """Return the path of an existing, readable file that is not empty.

    Raises InputError, which calls the file a `what` ("picture", "painting"), where it is not.
    """
    path = Path(path)
    try:
        status = path.stat()
    except (FileNotFoundError, NotADirectoryError):
        raise InputError(f"there is no {what} {path}; check its name and folder") from None
    except (OSError, ValueError) as error:
        raise InputError(f"cannot read the {what} {path}: {getattr(error, 'strerror', None) or error}") from error
    if stat.S_ISDIR(status.st_mode):
        inside = path / f"{what}.json"
        raise InputError(f"{path} is a folder; name {inside if inside.is_file() else f'the {what} itself'}")
    if not stat.S_ISREG(status.st_mode):
        raise InputError(f"{path} is a device or a pipe; a {what} must be a file")
    if not os.access(path, os.R_OK):
        raise InputError(f"there is no permission to read the {what} {path}; change its permissions or copy it")
    if status.st_size == 0:
        raise InputError(f"the {what} {path} is empty; make or copy it again")
    return path


def read_whole(path: str | Path, what: str, most: int) -> bytes:
    """Return the content of an existing file of at most `most` bytes.

    Raises InputError, which calls the file a `what`, where it is missing, too large or cannot be read.
    """
    path = file_to_read(path, what)
    try:
        if path.stat().st_size > most:
            raise InputError(f"{path} is larger than {most >> 20} MiB, too large for a {what}; name another")
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot read the {what} {path}: {error.strerror}") from error


def file_sum(path: str | Path, what: str = "file") -> str:
    """Return the SHA-256 of the file at `path`, as hexadecimal digits.

    Raises InputError, which calls the file a `what`, where it cannot be read.
    """
    try:
        with file_to_read(path, what).open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}") from error


def atomic_write(path: str | Path, content: bytes) -> None:
    """Write `content` to `path`, which at every moment holds either its old content or all of the new.

    The bytes go to a temporary file in the same folder and to the disk; then that file replaces the old one.
    Raises OutputError where that fails; the old file is then untouched and no temporary file is left behind.
    """
    target = _target(path)
    temporary = target.with_name(f".maulstick-{secrets.token_hex(8)}.part")
    try:
        with temporary.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(target)
        sync_folder(target.parent)
    except OSError as error:
        raise _unwritable(path, error) from error
    finally:
        with suppress(OSError):  # it is gone, or its folder never was
            temporary.unlink()


def _target(path: str | Path) -> Path:
    """Return the file that is written, to which `path` may be a link. Raises OutputError where it can be none."""
    try:
        target = Path(path).resolve()  # a link goes on pointing where it did
        is_folder, is_device = target.is_dir(), target.exists() and not target.is_file()
    except OSError as error:
        raise _unwritable(path, error) from error
    except RuntimeError as error:  # what Python says of such links before 3.13
        raise OutputError(f"cannot write {path}: {_REMEDY[errno.ELOOP]}") from error
    except ValueError as error:  # of letters that no name of a file has
        raise OutputError(f"cannot write {made_printable(str(path))}: {error}; choose another name") from error
    if is_folder:
        raise OutputError(f"cannot write {path}: it is a folder; name a file")
    if is_device:
        raise OutputError(f"cannot write {path}: it is a device or a pipe; name a file")
    return target


def _unwritable(path: str | Path, error: OSError) -> OutputError:
    return OutputError(f"cannot write {path}: {_REMEDY.get(error.errno or 0, error.strerror or str(error))}")


def append_whole(file: int, content: bytes) -> None:
    """Append to an open file, and wait until that is on the disk. Raises OSError; the file is then as it was before."""
    size = os.fstat(file).st_size
    try:
        if os.write(file, content) != len(content):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        os.fsync(file)
    except OSError:
        with suppress(OSError):
            os.ftruncate(file, size)
        raise


@contextmanager
def held(lock: Path, taken: str, cannot: str, remedy: str, patience: float = 0.0) -> Iterator[None]:
    """Hold the file `lock`, so that no other process can hold it; the file and its folder are made where missing.

    patience: seconds to wait for another process.  Raises InputError with the text `taken` where another process goes
    on holding it, and OutputError with the text `cannot`, the reason and the `remedy` where it cannot be written.
    """
    file = FileLock(lock, timeout=patience)
    try:
        file.acquire()
    except Timeout:
        raise InputError(taken) from None
    except OSError as error:
        raise OutputError(f"{cannot}: {error.strerror}; {remedy}") from error
    try:
        yield
    finally:
        file.release()


def sync_folder(folder: Path) -> None:
    """Write a folder's list of names to the disk, where the system allows it, so that a power cut cannot undo it."""
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
