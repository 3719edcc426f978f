"""Things that are kept by name: some come with Maulstick, others are the user's own."""

import os
import re
from dataclasses import dataclass
from pathlib import Path

from platformdirs import user_data_path

from maulstick.errors import InputError, OutputError, option

NAME = r"[a-z0-9][a-z0-9-]{0,39}"
"""What a name may be; it must never be a path."""


@dataclass(frozen=True)
class Library:
    """One JSON a thing, NAME.json, in two folders.

    what: one of the things, for people.  folder: of the user's own ones, within the user's data.
    built_in: the folder of those that come along.  taken: a name that belongs to something without a file.
    """

    what: str
    folder: str
    built_in: Path
    taken: str | None = None

    def own(self) -> Path:
        """The folder that the user's own are kept in."""
        return user_data_path("maulstick", appauthor=False) / self.folder

    def paths(self) -> dict[str, Path]:
        """The JSON of each that has a name, the built-in ones before the user's own."""
        built_in, own = (
            {path.stem: path for path in sorted(folder.glob("*.json")) if re.fullmatch(NAME, path.stem)}
            for folder in (self.built_in, self.own())
        )
        return built_in | {name: path for name, path in own.items() if name not in {*built_in, self.taken}}

    def is_built_in(self, path: Path) -> bool:
        """Whether that whose JSON is at `path` comes with Maulstick."""
        return path.parent == self.built_in

    def check_name(self, name: str) -> str:
        """The name itself. Raises InputError where nothing on this library may be called so."""
        if not re.fullmatch(NAME, name) or name == self.taken:
            allowed = "up to 40 of a-z, 0-9 and -, beginning with a letter or a digit"
            if self.taken is not None:
                allowed += f", and not {self.taken}"
            raise InputError.of_range(f"the name of a {self.what}", repr(name), allowed)
        return name

    def check_own_name(self, name: str, overwrite: bool) -> str:
        """The name itself. Raises InputError where the user may not use it, and OutputError where it is in use."""
        path = self.paths().get(self.check_name(name))
        if path is not None and self.is_built_in(path):
            raise InputError(f"the {self.what} {name} comes with Maulstick; choose another {option('name')}")
        if os.path.lexists(self.own() / f"{name}.json") and not overwrite:
            raise OutputError(
                f"there is a {self.what} {name} already; choose another {option('name')}, or add {option('overwrite')}"
            )
        return name
