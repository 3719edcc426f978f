"""Checks that no file is lost where results are written."""

import os
from collections.abc import Mapping
from pathlib import Path

from maulstick.errors import InputError, OutputError
from maulstick.storage.folders import as_output_error, check_no_file


def check_absent(path: Path, option: str, overwrite: bool) -> None:
    """Raise OutputError where there is a file at `path`, which `option` sets, and it is not to be overwritten."""
    if os.path.lexists(path) and not overwrite:
        raise OutputError(f"{path} is already there; choose another {option}, or add --overwrite")


def check_place(path: Path, option: str, overwrite: bool) -> None:
    """Raise OutputError where the folder of `path` does not exist, before the work begins, and as `check_absent`."""
    if not path.parent.is_dir():
        raise OutputError(f"cannot write {path}: its folder does not exist; make the folder first")
    check_absent(path, option, overwrite)


def check_other(path: Path, option: str, read: Mapping[str, Path | None]) -> None:
    """Raise InputError where the file that `option` sets is one that is read; read: such files, by what they are."""
    for what, each in read.items():
        if each is not None and path.resolve() == each.resolve():
            raise InputError(f"{option} is {path}, {what} itself; choose another {option}")


def check_free(out: Path, overwrite: bool) -> None:
    """Raise OutputError where `out` is a file, or a folder with files in it that are not to be overwritten."""
    with as_output_error(out):
        check_no_file(out)
        if out.is_dir() and any(out.iterdir()) and not overwrite:
            raise OutputError(f"the folder {out} is not empty; choose another --out, or add --overwrite")
