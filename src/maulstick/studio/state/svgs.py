"""SVGs that people brought to be painted as they are, each in a folder with drawing.svg, card.json and preview.png."""

import asyncio
from pathlib import Path
from typing import final

from nicegui import Event

from maulstick.drawing.options import DrawingOptions
from maulstick.errors import InputError
from maulstick.storage.records import read_record
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.titles import retitle, title_of
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.svg_work import CARD, SvgCard, keep_svg, read_svg


@final
class Svgs:
    """SVGs by their names. changed: emitted after one was added, removed, or read by other options."""

    def __init__(self, folder: Folder, desk: Desk) -> None:
        self.changed = Event[[]]()
        self._folder, self._desk = folder, desk
        self._keeping = asyncio.Lock()  # or two uploads at once could get the same name

    def cards(self) -> dict[str, SvgCard]:
        """Return the cards of all SVGs by their names, newest first."""
        found = {name: self.card(name) for name in reversed(self._folder.names("drawings"))}
        return {name: card for name, card in found.items() if card is not None}

    def file(self, name: str) -> Path:
        """Return the file of an SVG, which need not exist. Raises InputError for an invalid name."""
        return self._folder.of("drawings", name) / "drawing.svg"

    def card(self, name: str) -> SvgCard | None:
        """Read the card of an SVG; None where there is none of that name, or it cannot be read."""
        try:
            return read_record(SvgCard, self.file(name).with_name(CARD), "drawing's card")
        except InputError:
            return None

    async def keep(self, brought: Path, called: str) -> str:
        """Store an SVG and return its name here. called: name of its file. Raises InputError as `read_drawing`."""
        async with self._keeping:
            title = self._folder.title_for_file("drawings", called)
            name = self._folder.free_name("drawings", title)
            await self._desk.do(keep_svg, brought, called, self.file(name))
            retitle(self.file(name).parent, title)
        self.changed.emit()
        return name

    async def read(self, name: str, options: DrawingOptions) -> None:
        """Read an SVG by other options, which are kept with it. Raises InputError as `read_drawing`."""
        await self._desk.do(read_svg, file := self.file(name), title_of(file.parent), options)
        self.changed.emit()

    def retitle(self, name: str, title: str) -> None:
        """Give an SVG another title, while it is painted, too. Raises InputError as `titles.retitle`."""
        retitle(self.file(name).parent, title)
        self.changed.emit()

    async def throw_away(self, name: str) -> Path:
        """Move an SVG into the trash; return its place there, for `take_back`."""
        trashed = await asyncio.to_thread(self._folder.throw_away, self._folder.of("drawings", name))
        self.changed.emit()
        return trashed

    def take_back(self, trashed: Path, name: str = "") -> None:
        """Move an SVG back out of the trash; raises, and name, as `Folder.take_back`."""
        self._folder.take_back(trashed, self._folder.root / "drawings", name)
        self.changed.emit()
