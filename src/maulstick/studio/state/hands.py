"""The hands that were drawn or uploaded, each in a folder of its own."""

import asyncio
from pathlib import Path
from typing import final

from nicegui import Event

from maulstick.errors import InputError
from maulstick.storage.records import read_record
from maulstick.studio.state.folder import Folder
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.hand_work import CARD, DRAWING, INK, HandCard, keep_drawing, learn, take_in


@final
class Hands:
    """They lie in files: drawing.json where one can go on drawing, hand.ink.npz, and a picture and a card of that.

    changed: a hand came, went or has another name, or its ink is another.
    """

    def __init__(self, folder: Folder, desk: Desk) -> None:
        self.changed = Event[[]]()
        self._folder, self._desk = folder, desk

    def names(self) -> list[str]:
        """The last one first."""
        return [name for name in reversed(self._folder.names("hands")) if self._is_one(self.path(name))]

    def path(self, name: str) -> Path:
        """The folder of a hand. Raises InputError for what is no name."""
        return self._folder.of("hands", name)

    def is_drawn(self, name: str) -> bool:
        """Whether one can go on drawing it."""
        return (self.path(name) / DRAWING).is_file()

    def card(self, name: str) -> HandCard | None:
        """What is known of its ink; None where it has none yet, or cannot be read."""
        try:
            return read_record(HandCard, self.path(name) / CARD, "hand's card")
        except InputError:
            return None

    async def keep_ink(self, name: str) -> None:
        """Make ink of what was drawn."""
        await self._desk.do(keep_drawing, self.path(name))
        self.changed.emit()

    async def take_in(self, file: Path, called: str, pen_millimetres: float | None) -> str:
        """Make a hand of an uploaded recording; its name.

        called: the name that the file had.  pen_millimetres: from the markers of a tracked pen to its tip.
        Raises InputError where it is no recording, or has no strokes.
        """
        name = self._folder.free_name("hands", called)
        await self._desk.do(take_in, file, called, pen_millimetres, self.path(name))
        self.changed.emit()
        return name

    async def learn(self, name: str, style: str) -> None:
        """Learn a style of one's own from a hand. Raises InputError where it has too few strokes."""
        await self._desk.do(learn, self.path(name), style)

    async def throw_away(self, name: str) -> Path:
        """Put a hand into the trash; where it lies then, for `take_back`."""
        grave = await asyncio.to_thread(self._folder.throw_away, self.path(name))
        self.changed.emit()
        return grave

    def take_back(self, grave: Path) -> None:
        """Have again what was thrown away. Raises OutputError where there is another of that name meanwhile."""
        self._folder.take_back(grave, self._folder.root / "hands")
        self.changed.emit()

    def _is_one(self, path: Path) -> bool:
        return (path / DRAWING).is_file() or (path / INK).is_file()
