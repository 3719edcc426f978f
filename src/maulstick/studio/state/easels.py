"""Easel files, which say where a sheet lies in front of a machine, kept in the studio's folder by name."""

import re
from pathlib import Path
from typing import final

from maulstick.errors import InputError, OutputError
from maulstick.robot.easel import read_easel, write_easel
from maulstick.storage.library import NAME
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.titles import plain_name, title_of_file
from maulstick.studio.workers.uploads import read_brought


@final
class Easels:
    """Easels in the folder ``easels``, including files that somebody puts there by hand."""

    def __init__(self, folder: Folder) -> None:
        self._folder, self._root = folder, folder.root / "easels"

    def names(self) -> list[str]:
        """Return the names of the easels, sorted."""
        return sorted(path.stem for path in self._root.glob("*.json") if re.fullmatch(NAME, path.stem))

    def path(self, name: str) -> Path:
        """Return the file of an easel. Raises InputError where there is none of that name."""
        if name not in (names := self.names()):
            raise InputError.of_choice("easel", name, names)
        return self._root / f"{name}.json"

    def take_back(self, trashed: Path) -> None:
        """Move an easel back out of the trash; raises as `Folder.take_back`."""
        self._folder.take_back(trashed, self._root)

    def keep(self, file: str, content: bytes) -> str:
        """Store an easel and return its name; one that came from a file of the same name before goes into the trash.

        Waits for the disk; may be called from any thread.

        Raises InputError where the content is no easel, OutputError where it cannot be written.
        """
        easel = read_brought(content, read_easel, "that file")
        name = plain_name(title_of_file(file)) or "easel"
        try:
            self._root.mkdir(exist_ok=True)
        except OSError as error:
            raise OutputError(f"cannot make the folder {self._root}: {error.strerror}; make room for it") from error
        self._folder.keep_former(path := self._root / f"{name}.json")
        write_easel(easel, path)
        return name
