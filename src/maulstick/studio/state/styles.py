"""Styles that all pages show: those that come with Maulstick, and the user's own."""

import asyncio
import hashlib
import os
import shutil
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path
from typing import final

from nicegui import Event

from maulstick.errors import InputError
from maulstick.storage.records import write_record
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.titles import Stamp, checked_title, clean_title, free_among, stamp_of, titles_apart
from maulstick.studio.wording import error_text
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.style_work import Difference, Map, differences_of, draw_sheet, is_arranged, map_of
from maulstick.style.cards import STYLES, StyleCard, read_card, rename_style, title_style

MOST = 6
"""Most styles on a map, and in a comparison: there is a colour for each."""


@dataclass(frozen=True)
class Entry:
    """Entry of the gallery of styles. card: None where the style cannot be used; `fault` then says why."""

    name: str
    title: str
    is_built_in: bool
    card: StyleCard | None
    fault: str = ""


@dataclass(frozen=True)
class DeletedStyle:
    """Style that was deleted, and the folder in the trash that holds its files."""

    name: str
    title: str
    trashed: Path


@final
class Styles:
    """Styles in their files, which are read again each time: other programs write there, too.

    changed: emitted after a style was added, removed or renamed.  sheets: folder of the drawn sheets.
    thrown_away: styles deleted since the studio was opened, the newest last.
    """

    def __init__(self, folder: Folder, desk: Desk) -> None:
        self.changed = Event[[]]()
        self.thrown_away: list[DeletedStyle] = []
        self._folder, self._desk = folder, desk
        self.sheets = folder.root / ".cache" / "sheets"
        self._arranged: dict[tuple[Path, int], bool] = {}  # by file and when it was written

    def names(self) -> list[str]:
        """Return the names of all styles; those that come with Maulstick are first."""
        return list(STYLES.paths())

    def titles(self) -> dict[str, str]:
        """Return the titles of all styles by name, in the order of `names`, told apart."""
        return titles_apart({name: _title_of(name, path) for name, path in STYLES.paths().items()})

    def title(self, name: str) -> str:
        """Return the title of a style; its name where there is none of that name."""
        return self.titles().get(name, name)

    def own_title(self, name: str) -> str:
        """Return the title of a style as it was written; its name where it has none."""
        return _title_of(name, self._path(name))

    def entry(self, name: str) -> Entry:
        """Read the gallery's entry of a style. Raises InputError where there is none of that name."""
        path = self._path(name)
        try:
            return Entry(name, self.title(name), STYLES.is_built_in(path), read_card(path))
        except InputError as error:
            return Entry(name, name, STYLES.is_built_in(path), None, error_text(error))

    async def sheet(self, name: str) -> Path:
        """Return the file of a style's sheet: strokes by the hand and by the style. Draw it where there is none yet.

        Raises MaulstickError where the style cannot be used.
        """
        sheet = self._sheet(name)
        if not sheet.is_file():
            await self._desk.do(draw_sheet, self._path(name), sheet)
        return sheet

    async def is_arranged(self, name: str) -> bool:
        """Return whether it is known how a style's hand arranges its strokes.

        Raises MaulstickError where the style cannot be used.
        """
        path = self._path(name)
        key = path, path.stat().st_mtime_ns if path.is_file() else 0
        if key not in self._arranged:
            self._arranged[key] = await self._desk.do(is_arranged, path)
        return self._arranged[key]

    async def map_of(self, names: Sequence[str]) -> Map:
        """Map the strokes of the styles' hands. Raises MaulstickError where there are no styles, or more than six."""
        return await self._desk.do(map_of, self._chosen(names, 1))

    async def differences_of(self, names: Sequence[str]) -> tuple[Difference, ...]:
        """Compare each pair of two to six styles. Raises MaulstickError for another number, or an unusable style."""
        return await self._desk.do(differences_of, self._chosen(names, 2))

    async def rename(self, name: str, wanted: str) -> str:
        """Give one of the user's styles another title, and a free name like it; return the name.

        Raises InputError where no title is left, or as `rename_style`.
        """
        title = checked_title(wanted)
        if (new := self.free_name(title, but=name)) != name:
            await asyncio.to_thread(rename_style, name, new)
        await asyncio.to_thread(title_style, new, title)
        self.changed.emit()
        return new

    def free_name(self, title: str, but: str = "") -> str:
        """Return a name like the title that no style has. but: name that counts as free."""
        taken = {*STYLES.paths(), STYLES.taken or ""} - {but}
        return free_among(taken, title, STYLES.what)

    def name_for(self, name: str, title: str) -> str:
        """Return the name of the style that is learned from a hand: another than that of a style of another title."""
        path = STYLES.paths().get(name)
        if path is None or STYLES.is_built_in(path) or _title_of(name, path) == title:
            return name
        return next(
            (own for own, at in STYLES.paths().items() if not STYLES.is_built_in(at) and _title_of(own, at) == title),
            self.free_name(title),
        )

    async def delete(self, name: str) -> DeletedStyle:
        """Move one of the user's styles into the trash; return what `take_back` needs. Raises InputError for others."""
        path = self._path(name)
        if STYLES.is_built_in(path):
            raise InputError(f"the style {name} comes with Maulstick and stays; only your own can be deleted")
        files = [file for file in (path, path.with_suffix(".safetensors")) if os.path.lexists(file)]
        title = _title_of(name, path)
        trashed = await asyncio.to_thread(lambda: self._folder.throw_away(*files, title=title))
        self.thrown_away.append(deleted := DeletedStyle(name, title, trashed))
        self.changed.emit()
        return deleted

    async def renew(self, name: str, learn: Callable[[], Awaitable[None]]) -> bool:
        """Learn one of the user's styles again; return whether it replaced a different one, which can be taken back.

        The former one stays in its place until the new one replaces it. Raises what `learn` raises.
        """
        former = STYLES.own() / f"{name}.json"
        files, title = (former, former.with_suffix(".safetensors")), _title_of(name, former)
        trashed = await asyncio.to_thread(lambda: self._folder.keep_former(*files, title=title))
        card = trashed / former.name
        try:
            await learn()
        finally:
            is_another = card.is_file() and not (former.is_file() and former.read_bytes() == card.read_bytes())
            if is_another:
                self.thrown_away.append(DeletedStyle(name, title, trashed))
            else:
                await asyncio.to_thread(shutil.rmtree, trashed, ignore_errors=True)
            self.changed.emit()
        return is_another

    def take_back(self, trashed: Path, name: str = "") -> None:
        """Move a style back out of the trash; raises, and name, as `Folder.take_back`."""
        for path in self._folder.take_back(trashed, STYLES.own(), name):
            if name and path.suffix == ".json":
                write_record(read_card(path).model_copy(update={"name": name}), path)
        self.thrown_away = [each for each in self.thrown_away if each.trashed != trashed]
        self.changed.emit()

    def _path(self, name: str) -> Path:
        paths = STYLES.paths()
        if name not in paths:
            raise InputError.of_choice("style", name, paths)
        return paths[name]

    def _chosen(self, names: Sequence[str], fewest: int) -> dict[str, Path]:
        chosen = {name: self._path(name) for name in names}
        if not fewest <= len(chosen) <= MOST:
            raise InputError.of_range("the number of styles", len(chosen), f"from {fewest} to {MOST}")
        return chosen

    def _sheet(self, name: str) -> Path:
        """Path of a style's sheet, named by a hash of all that it shows. Raises InputError for an unusable style."""
        content = f"{version('maulstick')} {name} {read_card(self._path(name)).model_dump_json()}"
        return self.sheets / f"{hashlib.sha256(content.encode()).hexdigest()[:32]}.png"


def _title_of(name: str, path: Path) -> str:
    """Return the title in the card of a style; its name where it has none, or cannot be read."""
    stamp = stamp_of(path)
    return name if stamp is None else _read_title(path, stamp) or name


@lru_cache(maxsize=1024)
def _read_title(path: Path, stamp: Stamp) -> str:
    """Read the title in the card of a style, again for each stamp of its file."""
    try:
        return clean_title(read_card(path).title or "")
    except InputError:
        return ""
