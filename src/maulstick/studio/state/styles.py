"""The styles that all pages show: those that come with Maulstick, and one's own."""

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
from maulstick.studio.wording import said
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.style_work import Difference, Map, differences_of, draw_sheet, map_of
from maulstick.style.cards import STYLES, StyleCard, read_card, rename_style

MOST = 6
"""Styles on a map, and in a comparison."""


@dataclass(frozen=True)
class Entry:
    """A style of the gallery. card: what its file says; None where it cannot be used, and `fault` says why."""

    name: str
    is_built_in: bool
    card: StyleCard | None
    fault: str = ""


@dataclass(frozen=True)
class Thrown:
    """A style that was deleted, and where it lies."""

    name: str
    grave: Path


@final
class Styles:
    """They lie in files, and are read anew whenever they are asked for: other programs write there, too.

    changed: a style came, went, or has another name.  sheets: the folder of the sheets that were drawn.
    thrown_away: since the studio was opened, the last one last.
    """

    def __init__(self, folder: Folder, desk: Desk) -> None:
        self.changed = Event[[]]()
        self.thrown_away: list[Thrown] = []
        self._folder, self._desk = folder, desk
        self.sheets = folder.root / ".cache" / "sheets"

    def names(self) -> list[str]:
        """Those that come with Maulstick first."""
        return list(STYLES.paths())

    def entry(self, name: str) -> Entry:
        """What is known of a style. Raises InputError where there is none."""
        path = self._path(name)
        try:
            return Entry(name, STYLES.is_built_in(path), read_card(path))
        except InputError as error:
            return Entry(name, STYLES.is_built_in(path), None, said(error))

    async def sheet(self, name: str) -> Path:
        """The picture of strokes by the hand and by the style, drawn now if need be.

        Raises MaulstickError where the style cannot be used.
        """
        sheet = self._sheet(name)
        if not sheet.is_file():
            await self._desk.do(draw_sheet, self._path(name), sheet)
        return sheet

    async def map_of(self, names: Sequence[str]) -> Map:
        """Where the strokes of the styles' hands lie. Raises MaulstickError where there are none, or more than six."""
        return await self._desk.do(map_of, self._chosen(names, 1))

    async def differences_of(self, names: Sequence[str]) -> tuple[Difference, ...]:
        """Of each pair of two to six styles. Raises MaulstickError where that cannot be."""
        return await self._desk.do(differences_of, self._chosen(names, 2))

    async def rename(self, name: str, new: str) -> None:
        """Give a style of one's own another name. Raises InputError and OutputError, see `rename_style`."""
        await asyncio.to_thread(rename_style, name, new)
        self.changed.emit()

    async def delete(self, name: str) -> Thrown:
        """Throw a style of one's own away; what `take_back` needs. Raises InputError where it is none."""
        path = self._path(name)
        if STYLES.is_built_in(path):
            raise InputError(f"the style {name} comes with Maulstick and stays; only your own can be deleted")
        files = [file for file in (path, path.with_suffix(".safetensors")) if os.path.lexists(file)]
        grave = await asyncio.to_thread(self._folder.throw_away, *files)
        self.thrown_away.append(thrown := Thrown(name, grave))
        self.changed.emit()
        return thrown

    async def renew(self, name: str, learn: Callable[[], Awaitable[None]]) -> bool:
        """Learn a style of one's own anew; whether it was another before, which can be taken back then.

        What it was stays in its place until the new one takes it. Raises what `learn` raises.
        """
        former = STYLES.own() / f"{name}.json"
        grave = await asyncio.to_thread(self._folder.keep_former, former, former.with_suffix(".safetensors"))
        card = grave / former.name
        try:
            await learn()
        finally:
            is_another = card.is_file() and not (former.is_file() and former.read_bytes() == card.read_bytes())
            if is_another:
                self.thrown_away.append(Thrown(name, grave))
            else:
                await asyncio.to_thread(shutil.rmtree, grave, ignore_errors=True)
            self.changed.emit()
        return is_another

    async def take_back(self, thrown: Thrown) -> None:
        """Have again what was deleted. Raises OutputError where there is another of that name meanwhile."""
        if thrown in self.thrown_away:  # or another page was quicker
            await asyncio.to_thread(self._folder.take_back, thrown.grave, STYLES.own())
            self.thrown_away.remove(thrown)
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
        """Named by all that the picture depends on. Raises InputError where the style cannot be used."""
        content = f"{version('maulstick')} {name} {read_card(self._path(name)).model_dump_json()}"
        return self.sheets / f"{hashlib.sha256(content.encode()).hexdigest()[:32]}.png"
