"""Trash of the studio: what was thrown away, and the way back. Nothing is ever removed from it."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import final

from maulstick.errors import InputError
from maulstick.storage.records import read_record
from maulstick.studio.state.folder import KINDS, Folder
from maulstick.studio.state.styles import Styles
from maulstick.studio.state.thrown import RECORD, STYLES_FOLDER, TrashRecord
from maulstick.studio.state.titles import clean_title, title_of

_ID = r"\d{1,19}-[0-9a-f]{8}"  # nanoseconds since 1970, and a random number
_PICTURES = {
    "hands": ("hand.png",),
    "pictures": ("small.jpg",),
    "plans": ("preview.png", "target.jpg"),
    "drawings": ("preview.png",),
}
"""Pictures that a page may show of a thing, by kind; the first that is there is shown."""

TakeBack = Callable[[Path, str], None]
"""Function that moves things out of a folder in the trash to where they were, under another name unless that is ""."""


@dataclass(frozen=True)
class Thrown:
    """Thing in the trash.

    id: its folder's name.  title: for people.  where: folder that it was in, None where nothing says so.
    when: it was thrown away.  name: that it had.
    """

    id: str
    title: str
    where: str | None
    when: datetime
    name: str

    @property
    def is_thing(self) -> bool:
        """Whether it is a thing with a name, and no file of the studio's settings."""
        return self.where in KINDS or self.where == STYLES_FOLDER


@final
class Trash:
    """Things in the trash. take_back: how a thing returns, by the folder that it was in."""

    def __init__(self, folder: Folder, styles: Styles, take_back: Mapping[str, TakeBack]) -> None:
        self._folder, self._styles, self._take_back = folder, styles, take_back

    def things(self) -> list[Thrown]:
        """Return all things, the one that was thrown away last first."""
        folders = [path for path in (self._folder.root / "trash").iterdir() if re.fullmatch(_ID, path.name)]
        newest = sorted(folders, key=lambda path: int(path.name.partition("-")[0]), reverse=True)
        return [thing for thing in map(_thing, newest) if thing is not None]

    def thing(self, id: str) -> Thrown:
        """Return the thing of that id. Raises InputError where it is there no more."""
        found = _thing(self._of(id)) if re.fullmatch(_ID, id) else None
        if found is None:
            raise InputError("it was taken out of the trash already; look where it was before")
        return found

    def picture(self, id: str) -> Path | None:
        """Return a small picture of a thing; None where there is none."""
        try:
            thing = self.thing(id)
        except InputError:
            return None
        files = (self._of(id) / thing.name / file for file in _PICTURES.get(thing.where or "", ()))
        return next((file for file in files if file.is_file()), None)

    def free_name(self, thing: Thrown) -> str:
        """Return the name that it can have: its own, or one like it where that is taken by now."""
        if thing.where == STYLES_FOLDER:
            return thing.name if thing.name not in self._styles.names() else self._styles.free_name(thing.name)
        if not thing.is_thing or self._folder.is_free(thing.where or "", thing.name):
            return thing.name
        return self._folder.free_name(thing.where or "", thing.name)

    def put_back(self, thing: Thrown, name: str) -> None:
        """Move a thing back to where it was. name: from `free_name`.

        A file of settings changes places with the present one. Raises InputError where nothing says where it was, or
        it is there no more, and OutputError where it cannot be moved.
        """
        if thing.where is None or thing.where not in self._take_back:
            raise InputError("nothing says where that was; move it by hand, out of the folder trash")
        if not thing.is_thing and (present := self._folder.root / thing.where / thing.name).is_file():
            self._folder.throw_away(present)
        self._take_back[thing.where](self._of(thing.id), "" if name == thing.name else name)

    def _of(self, id: str) -> Path:
        return self._folder.root / "trash" / id


def _thing(path: Path) -> Thrown | None:
    """Read what a folder in the trash holds; None where it is empty, or no folder."""
    try:
        names = sorted(each.name for each in path.iterdir() if each.name != RECORD)
    except OSError:
        return None
    if not names:
        return None
    when = datetime.fromtimestamp(int(path.name.partition("-")[0]) / 1e9).astimezone()
    try:
        record = read_record(TrashRecord, path / RECORD, "record of the trash")
    except InputError:  # of an earlier Maulstick
        return Thrown(path.name, ", ".join(names), None, when, names[0])
    name = names[0] if record.where != STYLES_FOLDER else Path(names[0]).stem
    title = title_of(path / name) if record.where in KINDS else clean_title(record.title) or name
    return Thrown(path.name, title, record.where, when, name)
