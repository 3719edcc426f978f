"""Hands that were drawn or uploaded, each in a folder of its own."""

import asyncio
from pathlib import Path
from typing import final

from nicegui import Event

from maulstick.errors import InputError
from maulstick.storage.records import read_record
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.titles import retitle, title_of
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.hand_work import CARD, DRAWING, INK, HandCard, keep_drawing, learn, take_in


@final
class Hands:
    """Hands in their files: drawing.json if the hand was drawn here, hand.ink.npz, and a picture and a card of the ink.

    changed: emitted after a hand was added, removed or renamed, or its ink has changed.
    """

    def __init__(self, folder: Folder, desk: Desk) -> None:
        self.changed = Event[[]]()
        self._folder, self._desk = folder, desk
        self._keeping = asyncio.Lock()  # or two uploads at once could get the same name

    def names(self) -> list[str]:
        """Return the names of all hands, newest first."""
        return [name for name in reversed(self._folder.names("hands")) if self._is_hand(self.path(name))]

    def path(self, name: str) -> Path:
        """Return the folder of a hand. Raises InputError for an invalid name."""
        return self._folder.of("hands", name)

    def title(self, name: str) -> str:
        """Return the title of a hand, as it was written."""
        return title_of(self.path(name))

    def titles(self) -> dict[str, str]:
        """Return the titles of all hands by name, told apart."""
        return self._folder.titles("hands")

    def is_drawn(self, name: str) -> bool:
        """Whether the hand was drawn here, so that drawing can go on."""
        return (self.path(name) / DRAWING).is_file()

    def card(self, name: str) -> HandCard | None:
        """Read the card of a hand's ink; None where there is none yet, or it cannot be read."""
        try:
            return read_record(HandCard, self.path(name) / CARD, "hand's card")
        except InputError:
            return None

    async def keep_ink(self, name: str) -> None:
        """Write the ink, the picture and the card of the hand's drawing."""
        await self._desk.do(keep_drawing, self.path(name))
        self.changed.emit()

    async def take_in(self, file: Path, called: str, pen_millimetres: float | None) -> str:
        """Make a hand from an uploaded recording; return its name.

        called: name of the uploaded file.  pen_millimetres: length of a tracked pen from its markers to its tip.
        Raises InputError where it is no recording, or has no strokes.
        """
        async with self._keeping:
            title = self._folder.title_for_file("hands", called)
            name = self._folder.free_name("hands", title)
            await self._desk.do(take_in, file, called, pen_millimetres, self.path(name))
            retitle(self.path(name), title)
        self.changed.emit()
        return name

    async def learn(self, name: str, style: str) -> None:
        """Learn a style from a hand and store it with the user's styles. Raises InputError for too few strokes."""
        await self._desk.do(learn, self.path(name), style, self.title(name))

    async def throw_away(self, name: str) -> Path:
        """Move a hand into the trash; return its place there, for `take_back`."""
        trashed = await asyncio.to_thread(self._folder.throw_away, self.path(name))
        self.changed.emit()
        return trashed

    def take_back(self, trashed: Path, name: str = "") -> None:
        """Move a hand back out of the trash; raises, and name, as `Folder.take_back`."""
        self._folder.take_back(trashed, self._folder.root / "hands", name)
        self.changed.emit()

    def _is_hand(self, path: Path) -> bool:
        return (path / DRAWING).is_file() or (path / INK).is_file()
