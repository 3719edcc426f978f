"""Presets: settings of a plan that are kept under a title, and written as a file that other studios read."""

import re
from pathlib import Path
from typing import Final, Literal, final

from nicegui import Event
from pydantic import BaseModel, ConfigDict, ValidationError, field_validator

from maulstick.errors import InputError, validation_fault
from maulstick.storage.files import atomic_write
from maulstick.storage.folders import MAKE_ROOM, as_output_error
from maulstick.storage.library import NAME
from maulstick.storage.records import read_record
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.settings import Choices
from maulstick.studio.state.titles import checked_title, clean_title, free_among, titles_apart

PRESETS_FOLDER: Final = "presets"
"""Name of the folder of presets within the studio's."""

_FORMAT: Final = "maulstick settings of a plan"


class Preset(BaseModel):
    """Content of a preset's file: nothing in it is a path. title: "" where it was saved without one."""

    model_config = ConfigDict(frozen=True, extra="ignore")

    format: Literal["maulstick settings of a plan"]
    version: Literal[1]
    title: str = ""
    settings: Choices

    @field_validator("title")
    @classmethod
    def _clean(cls, title: str) -> str:
        return clean_title(title)

    @classmethod
    def of(cls, title: str, settings: Choices) -> "Preset":
        """Return the preset of these settings."""
        return cls(format=_FORMAT, version=1, title=title, settings=settings)

    @classmethod
    def read(cls, content: bytes, called: str) -> "Preset":
        """Return the preset in a file's content. called: name of the file. Raises InputError where it holds none."""
        try:
            return cls.model_validate_json(content)
        except ValidationError as error:
            fault = f"{called} holds no settings of a plan: {validation_fault(error)}"
            raise InputError(
                f"{fault}; choose a file that was saved here, by “Save these settings as a file”"
            ) from error

    def written(self) -> bytes:
        """Return the content of its file."""
        return f"{self.model_dump_json(indent=2, exclude={'settings': {'schema_version'}})}\n".encode()


@final
class Presets:
    """Presets in the studio's folder, a file each. changed: emitted after one came or went."""

    def __init__(self, folder: Folder) -> None:
        self.changed = Event[[]]()
        self._folder, self._root = folder, folder.root / PRESETS_FOLDER

    def titles(self) -> dict[str, str]:
        """Return the titles of all presets by name, in the order of titles; files that hold none are left out."""
        found = {}
        for path in self._root.glob("*.json"):
            try:
                found[path.stem] = self.of(path.stem).title or path.stem
            except InputError:
                continue
        return titles_apart(dict(sorted(found.items(), key=lambda each: each[1].casefold())))

    def of(self, name: str) -> Preset:
        """Return the preset of that name. Raises InputError where there is none."""
        return read_record(Preset, self._path(name), "preset")

    def keep(self, typed: str, settings: Choices) -> bool:
        """Keep settings under a title; what had that title before goes into the trash. Returns whether something had.

        Raises InputError where nothing of the title can be seen, OutputError where it cannot be written.
        """
        title = checked_title(typed)
        names = [path.stem for path in self._root.glob("*.json")]
        former = next((name for name in names if self._title(name) == title), None)
        path = self._path(former or free_among(names, title, "settings"))
        with as_output_error(self._root, MAKE_ROOM):
            self._root.mkdir(exist_ok=True)
        if former is not None:
            self._folder.keep_former(path, title=title)
        atomic_write(path, Preset.of(title, settings).written())
        self.changed.emit()
        return former is not None

    def throw_away(self, name: str) -> Path:
        """Move a preset into the trash; return its place there. Raises InputError where there is none of that name."""
        trashed = self._folder.throw_away(self._path(name), title=self.of(name).title or name)
        self.changed.emit()
        return trashed

    def take_back(self, trashed: Path) -> None:
        """Move a preset back out of the trash; raises as `Folder.take_back`."""
        self._folder.take_back(trashed, self._root)
        self.changed.emit()

    def _title(self, name: str) -> str:
        try:
            return self.of(name).title
        except InputError:
            return ""

    def _path(self, name: str) -> Path:
        if not re.fullmatch(NAME, name):
            raise InputError(f"there are no settings {name!r}; choose others")
        return self._root / f"{name}.json"
