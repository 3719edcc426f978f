"""Styles that all pages show: those that come with Maulstick, and the user's own."""

import asyncio
import hashlib
import os
import shutil
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import final

from nicegui import Event

from maulstick.errors import InputError
from maulstick.studio.state.folder import Folder
from maulstick.studio.wording import error_text
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.style_work import Difference, Map, differences_of, draw_sheet, is_arranged, map_of
from maulstick.style.cards import STYLES, StyleCard, read_card, rename_style

MOST = 6
"""Most styles on a map, and in a comparison: there is a colour for each."""


@dataclass(frozen=True)
class Entry:
    """Entry of the gallery of styles. card: None where the style cannot be used; `fault` then says why."""

    name: str
    is_built_in: bool
    card: StyleCard | None
    fault: str = ""


@dataclass(frozen=True)
class DeletedStyle:
    """Style that was deleted, and the folder in the trash that holds its files."""

    name: str
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

    def names(self) -> list[str]:
        """Return the names of all styles; those that come with Maulstick are first."""
        return list(STYLES.paths())

    def entry(self, name: str) -> Entry:
        """Read the gallery's entry of a style. Raises InputError where there is none of that name."""
        path = self._path(name)
        try:
            return Entry(name, STYLES.is_built_in(path), read_card(path))
        except InputError as error:
            return Entry(name, STYLES.is_built_in(path), None, error_text(error))

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
        return await self._desk.do(is_arranged, self._path(name))

    async def map_of(self, names: Sequence[str]) -> Map:
        """Map the strokes of the styles' hands. Raises MaulstickError where there are no styles, or more than six."""
        return await self._desk.do(map_of, self._chosen(names, 1))

    async def differences_of(self, names: Sequence[str]) -> tuple[Difference, ...]:
        """Compare each pair of two to six styles. Raises MaulstickError for another number, or an unusable style."""
        return await self._desk.do(differences_of, self._chosen(names, 2))

    async def rename(self, name: str, new: str) -> None:
        """Rename one of the user's styles. Raises InputError and OutputError, see `rename_style`."""
        await asyncio.to_thread(rename_style, name, new)
        self.changed.emit()

    async def delete(self, name: str) -> DeletedStyle:
        """Move one of the user's styles into the trash; return what `take_back` needs. Raises InputError for others."""
        path = self._path(name)
        if STYLES.is_built_in(path):
            raise InputError(f"the style {name} comes with Maulstick and stays; only your own can be deleted")
        files = [file for file in (path, path.with_suffix(".safetensors")) if os.path.lexists(file)]
        trashed = await asyncio.to_thread(self._folder.throw_away, *files)
        self.thrown_away.append(deleted := DeletedStyle(name, trashed))
        self.changed.emit()
        return deleted

    async def renew(self, name: str, learn: Callable[[], Awaitable[None]]) -> bool:
        """Learn one of the user's styles again; return whether it replaced a different one, which can be taken back.

        The former one stays in its place until the new one replaces it. Raises what `learn` raises.
        """
        former = STYLES.own() / f"{name}.json"
        trashed = await asyncio.to_thread(self._folder.keep_former, former, former.with_suffix(".safetensors"))
        card = trashed / former.name
        try:
            await learn()
        finally:
            is_another = card.is_file() and not (former.is_file() and former.read_bytes() == card.read_bytes())
            if is_another:
                self.thrown_away.append(DeletedStyle(name, trashed))
            else:
                await asyncio.to_thread(shutil.rmtree, trashed, ignore_errors=True)
            self.changed.emit()
        return is_another

    async def take_back(self, deleted: DeletedStyle) -> None:
        """Move a deleted style back. Raises OutputError where another has its name by now."""
        if deleted in self.thrown_away:  # else another page has done so already
            await asyncio.to_thread(self._folder.take_back, deleted.trashed, STYLES.own())
            self.thrown_away.remove(deleted)
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
