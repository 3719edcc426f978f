"""Drawing on the sheet: the same one on all pages, and on disk within half a second."""

import asyncio
from contextlib import suppress
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import final

from nicegui import Event

from maulstick.errors import InputError, OutputError
from maulstick.storage.files import atomic_write
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.hands import Hands
from maulstick.studio.state.titles import checked_title, retitle
from maulstick.studio.wording import error_text
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.drawn_sheet import (
    MOST_POINTS,
    MOST_STROKES,
    DrawnSheet,
    DrawnStroke,
    read_sheet,
    sheet_json,
)
from maulstick.studio.workers.hand_work import DRAWING

USUAL_SHEET = 0.21, 0.148  # metres; A5, landscape as most screens are

_PAUSE = 0.5  # seconds between two writings
_LARGEST_ID = 2**53  # up to which JavaScript counts exactly


@dataclass(frozen=True)
class _Step:
    """Change of the sheet: a stroke was added at, or removed from, this place in the order of drawing."""

    added: bool
    id: int
    stroke: DrawnStroke
    place: int


@dataclass(frozen=True)
class _Gesture:
    """Steps that were made, and are undone, together: one stroke drawn, or all that one swipe rubbed out.

    swipe: number of that swipe, None for a stroke.
    """

    steps: list[_Step]
    swipe: object = None


@final
class Drawing:
    """Drawing of the current hand; made in the server's event loop.

    Events: `changed` after its strokes or its name have changed, `added` with the id and the stroke, `removed` with
    the id, `renewed` after another sheet was opened.
    hands: all that were drawn or uploaded.  name: of the hand that is drawn now, which follows its title.
    size: (width, height), metres.
    strokes: by id, in the order of drawing.  trouble: why it is not on disk, or "".
    """

    def __init__(self, folder: Folder, desk: Desk) -> None:
        self.changed, self.renewed = Event[[]](), Event[[]]()
        self.added, self.removed = Event[[int, DrawnStroke]](), Event[[int]]()
        self.hands = Hands(folder, desk)
        self.trouble = ""
        self._folder, self._desk = folder, desk
        self.name: str
        self._had_folder: bool
        self._unsaved = False
        self._keeper: asyncio.Task[None] | None = None
        self._ids = count()
        self._writing, self._turning = asyncio.Lock(), asyncio.Lock()
        self._lay(*self._last())

    @property
    def title(self) -> str:
        """Title of the hand for people."""
        return self._title or self.name

    @property
    def can_undo(self) -> bool:
        """Whether there is a change to undo."""
        return bool(self._done)

    @property
    def can_redo(self) -> bool:
        """Whether there is a change to redo."""
        return bool(self._undone)

    def add(self, id: object, numbers: object) -> None:
        """Add a stroke to the sheet. numbers: see `DrawnStroke.of`. Raises InputError where it does not fit."""
        if type(id) is not int or not 0 <= id < _LARGEST_ID or id in self.strokes:
            raise InputError("that stroke is on the sheet already, or has no number of its own; draw it again")
        if len(self.strokes) >= MOST_STROKES or self._points >= MOST_POINTS:
            raise InputError("the sheet is full; begin a new one")
        self._do(_Step(True, id, DrawnStroke.of(numbers, self.size), len(self.strokes)))

    def rub_out(self, id: object, swipe: object = None) -> None:
        """Remove a stroke from the sheet; another page may have removed it already.

        swipe: number of the movement that rubs it out, whose strokes are undone together; None for this one alone.
        """
        if type(id) is int and id in self.strokes:
            self._do(_Step(False, id, self.strokes[id], list(self.strokes).index(id)), swipe)

    def undo(self) -> None:
        """Undo the last gesture, if there is one."""
        if self._done:
            self._undone.append(gesture := self._done.pop())
            for step in reversed(gesture.steps):
                self._apply(step, not step.added)

    def redo(self) -> None:
        """Redo the gesture that was undone last, if there is one."""
        if self._undone:
            self._done.append(gesture := self._undone.pop())
            for step in gesture.steps:
                self._apply(step, step.added)

    async def begin(self, size: tuple[float, float]) -> None:
        """Store this sheet with the others and begin a new one. size: (width, height), metres."""
        await self._turn_to(DrawnSheet(size, ()), None)

    async def open(self, name: str) -> None:
        """Store this sheet with the others and go on with another. Raises InputError where that one cannot be read."""
        if name != self.name:
            await self._turn_to(await self._desk.do(read_sheet, self._folder.of("hands", name) / DRAWING), name)

    async def rename(self, wanted: str) -> None:
        """Give the hand another title, and a free name as near to it as possible. Raises InputError for an empty one.

        Raises OutputError where it cannot be written.
        """
        title = checked_title(wanted)
        async with self._turning, self._writing:
            if title == self.title:
                return
            name = self._folder.free_name("hands", title, but=self.name)
            if has_folder := self._has_folder:
                self._path.rename(self._folder.of("hands", name))
                retitle(self._folder.of("hands", name), title)
            self.name, self._had_folder, self._title = name, has_folder, title
        self.changed.emit()

    async def throw_away(self, name: str) -> Path:
        """Move a hand, which may be this one, into the trash; return its place there, for `hands.take_back`."""
        if name == self.name:
            await self.begin(self.size)
        return await self.hands.throw_away(name)

    async def keep(self) -> None:
        """Write the drawing, its ink and its picture to disk before returning. Raises OutputError if that fails."""
        await self._write()
        if self._has_folder:
            await self.hands.keep_ink(self.name)

    async def close(self) -> None:
        """Write the drawing to disk before returning, if that is possible; if not, `trouble` says why."""
        with suppress(OutputError):
            await self._write()

    @property
    def _path(self) -> Path:
        return self._folder.of("hands", self.name)

    @property
    def _has_folder(self) -> bool:
        return self._had_folder and self._path.is_dir()  # another page may have thrown it away

    def _last(self) -> tuple[DrawnSheet, str | None]:
        drawn = [path / DRAWING for path in map(self.hands.path, self.hands.names()) if (path / DRAWING).is_file()]
        if not drawn:
            return DrawnSheet(USUAL_SHEET, ()), None
        last = max(drawn, key=lambda path: path.stat().st_mtime)
        try:
            return read_sheet(last), last.parent.name
        except InputError as error:
            self.trouble = error_text(error)
            return DrawnSheet(USUAL_SHEET, ()), None

    def _lay(self, sheet: DrawnSheet, name: str | None) -> None:
        self.name, self.size = name or self._folder.free_name("hands", "my-hand"), sheet.size
        self._title = "" if name is None else self.hands.title(name)
        self._had_folder = name is not None
        self.strokes = {next(self._ids): stroke for stroke in sheet.strokes}
        self._points = sum(len(stroke.points) for stroke in sheet.strokes)
        self._done: list[_Gesture] = []
        self._undone: list[_Gesture] = []

    async def _turn_to(self, sheet: DrawnSheet, name: str | None) -> None:
        async with self._turning:
            if name == self.name:  # another click, or page, was sooner
                return
            await self._write()  # after which nothing is awaited until the other sheet lies there
            before = self.name if self._has_folder else None
            self._lay(sheet, name)
        self.renewed.emit()
        self.changed.emit()
        self.hands.changed.emit()
        if before is not None:
            await self.hands.keep_ink(before)

    def _do(self, step: _Step, swipe: object = None) -> None:
        self._undone.clear()
        if swipe is not None and self._done and self._done[-1].swipe == swipe:
            self._done[-1].steps.append(step)
        else:
            self._done.append(_Gesture([step], swipe))
        self._apply(step, step.added)

    def _apply(self, step: _Step, adds: bool) -> None:
        if adds:
            order = list(self.strokes.items())
            order.insert(step.place, (step.id, step.stroke))
            self.strokes = dict(order)
            self._points += len(step.stroke.points)
            self.added.emit(step.id, step.stroke)
        else:
            del self.strokes[step.id]
            self._points -= len(step.stroke.points)
            self.removed.emit(step.id)
        self.changed.emit()
        self._unsaved = True
        if self._keeper is None or self._keeper.done():
            self._keeper = asyncio.create_task(self._keep_on())

    async def _keep_on(self) -> None:
        while self._unsaved:
            with suppress(OutputError):  # `trouble` says so, and there may be room again soon
                await self._write()
            await asyncio.sleep(_PAUSE)

    async def _write(self) -> None:
        async with self._writing:
            while self._unsaved:
                self._unsaved = False
                try:
                    self._make_folder()
                    await asyncio.to_thread(_write_sheet, self._path, self.size, list(self.strokes.values()))
                except OutputError as error:
                    self._unsaved = True
                    self._say(error_text(error))
                    raise
                self._say("")

    def _make_folder(self) -> None:
        if self._has_folder:
            return
        if self._path.exists():  # another hand has taken that name meanwhile
            self.name = self._folder.free_name("hands", self.name)
        try:
            self._path.mkdir()
            if self._title:
                retitle(self._path, self._title)
        except OSError as error:
            raise OutputError(f"cannot write {self._path}: {error.strerror}; make room for it there") from error
        self._had_folder = True

    def _say(self, trouble: str) -> None:
        if trouble != self.trouble:
            self.trouble = trouble
            self.changed.emit()


def _write_sheet(path: Path, size: tuple[float, float], strokes: list[DrawnStroke]) -> None:
    atomic_write(path / DRAWING, sheet_json(size, strokes))
