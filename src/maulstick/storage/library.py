"""Libraries of things with names (brushes, styles): some come with Maulstick, others are the user's own."""

import os
import re
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

from platformdirs import user_data_path

from maulstick.errors import InputError, OutputError, option
from maulstick.storage.files import held
from maulstick.storage.folders import MAKE_ROOM

NAME = r"[a-z0-9][a-z0-9-]{0,39}"
"""Regular expression of allowed names; none of them can be a path."""

_PATIENCE = 10.0  # seconds to wait for another process that writes


@dataclass(frozen=True)
class Library:
    """Two folders with one file NAME.json per thing: the built-in ones and the user's own.

    what: the word for one thing ("brush"), for people.  folder: name of the user's own folder within the user's data.
    built_in: folder of those that come with Maulstick.  taken: a reserved name, of something without a file.
    """

    what: str
    folder: str
    built_in: Path
    taken: str | None = None

    def own(self) -> Path:
        """Return the folder of the user's own things."""
        return user_data_path("maulstick", appauthor=False) / self.folder

    def paths(self) -> dict[str, Path]:
        """Return the path of each thing's JSON by its name, the built-in ones before the user's own."""
        built_in, own = (
            {path.stem: path for path in sorted(folder.glob("*.json")) if re.fullmatch(NAME, path.stem)}
            for folder in (self.built_in, self.own())
        )
        return built_in | {name: path for name, path in own.items() if name not in {*built_in, self.taken}}

    def is_built_in(self, path: Path) -> bool:
        """Return whether the thing whose JSON is at `path` comes with Maulstick."""
        return path.parent == self.built_in

    def check_name(self, name: str) -> str:
        """Return the name itself. Raises InputError where nothing in this library may have it."""
        if not re.fullmatch(NAME, name) or name == self.taken:
            allowed = "up to 40 of a-z, 0-9 and -, beginning with a letter or a digit"
            if self.taken is not None:
                allowed += f", and not {self.taken}"
            raise InputError.of_range(f"the name of a {self.what}", repr(name), allowed)
        return name

    def check_own_name(self, name: str, overwrite: bool) -> str:
        """Return the name. Raises InputError where it is not allowed or built in, OutputError where it is in use.

        overwrite: allow a name that is in use by one of the user's own.
        """
        path = self.paths().get(self.check_name(name))
        if path is not None and self.is_built_in(path):
            raise InputError(f"the {self.what} {name} comes with Maulstick; choose another {option('name')}")
        if not overwrite:
            self.check_unused(name, self.own())
        return name

    def writing_into(self, folder: Path) -> AbstractContextManager[None]:
        """Hold a folder of such things, so that no two processes mix the files of one or take the same name.

        Raises InputError where another process goes on holding it, and OutputError where nothing can be written beside
        it.
        """
        taken = f"another maulstick is writing into {folder}; wait until it has finished"
        lock = folder.parent / f".{folder.name}.lock"
        return held(lock, taken, f"cannot write into the folder of {self.folder} {folder}", MAKE_ROOM, _PATIENCE)

    def check_unused(self, name: str, folder: Path) -> None:
        """Raise OutputError where something in the folder has this name."""
        if os.path.lexists(folder / f"{name}.json"):
            raise OutputError(
                f"there is a {self.what} {name} already; choose another {option('name')}, or add {option('overwrite')}"
            )


def placed(name: str, folder: Path) -> str:
    """Return a name as it is, and that of a JSON file, seen from a folder, as its absolute path."""
    return str((folder / name).absolute()) if Path(name).suffix == ".json" else name


def all_placed(names: str, folder: Path) -> str:
    """Return the same of several names with commas between them."""
    return ",".join(placed(name.strip(), folder) for name in names.split(","))
