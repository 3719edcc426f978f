"""Acts of a person who directs a plan, kept beside it: each can be undone and redone, also in a later studio."""

import asyncio
import hashlib
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, final

from nicegui import Event
from pydantic import ValidationError

from maulstick.errors import InputError, validation_fault
from maulstick.painting.stroke_edits import STROKE_EDIT
from maulstick.storage.files import atomic_write
from maulstick.storage.folders import MAKE_ROOM, as_output_error
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.stroke_marks import (
    ShownSheet,
    changed_marks,
    check_edits,
    drawn_edit,
    shown_sheet,
    write_edited,
)

_UNDO, _REDO = "undo", "redo"
_MOST_DRAWN = 20_000  # points of a stroke that is drawn: minutes of a pen


@final
class Directing:
    """Edits of one plan's painting, which itself stays as it was planned.

    They are a file of lines that only grows: each an edit, or that the last one was undone or redone.
    changed: event at each act.  planned: time of the painting, nanoseconds.
    """

    def __init__(self, painting: Path, desk: Desk) -> None:
        self.changed = Event[[]]()
        self._painting, self._desk = painting, desk
        self.planned = painting.stat().st_mtime_ns
        self._file = painting.with_name(f"edits-{_sum_of(painting)}.jsonl")
        self._lines = _read(self._file)
        self._acting = asyncio.Lock()  # an edit is checked after all before it

    @property
    def version(self) -> int:
        """Number of acts so far, undoing counted."""
        return len(self._lines)

    @property
    def edits(self) -> tuple[str, ...]:
        """Edits that are not undone, as JSON."""
        return _folded(self._lines)[0]

    @property
    def can_undo(self) -> bool:
        """Whether there is an edit to undo."""
        return bool(self.edits)

    @property
    def can_redo(self) -> bool:
        """Whether there is an edit to redo."""
        return bool(_folded(self._lines)[1])

    async def sheet(self) -> ShownSheet:
        """Return the sheet and the paints of the plan."""
        return await self._desk.do(shown_sheet, self._painting)

    async def marks(self, version: int, since: int | None) -> bytes:
        """Return the strokes after so many acts that are others than after `since` acts; all where that is None."""
        before = None if since is None else _folded(self._lines[:since])[0]
        return await self._desk.do(changed_marks, self._painting, _folded(self._lines[:version])[0], before)

    async def edit(self, sent: dict[str, Any]) -> None:
        """Do an edit, a record of `StrokeEdit` as a page sends it. Raises InputError where it cannot be."""
        try:
            edit = STROKE_EDIT.validate_python(sent)
        except ValidationError as error:
            raise InputError(f"that is no edit of strokes: {validation_fault(error)}; choose them again") from error
        await self._do(STROKE_EDIT.dump_json(edit).decode())

    async def draw(self, paint: int, points: Sequence[float]) -> None:
        """Add a stroke that a person drew. points: x, y in metres and pressure of each; raises as `drawn_edit`."""
        if not points or len(points) > 3 * _MOST_DRAWN or len(points) % 3:
            raise InputError(f"a stroke has {len(points) // 3} points; draw one with 1 to {_MOST_DRAWN}")
        triples = list(zip(points[::3], points[1::3], points[2::3], strict=True))
        await self._do(await self._desk.do(drawn_edit, self._painting, paint, triples))

    async def undo(self) -> None:
        """Undo the last edit that is not undone, if there is one."""
        async with self._acting:
            if self.can_undo:
                self._append({"act": _UNDO})

    async def redo(self) -> None:
        """Do again what was undone last, unless something else was done since."""
        async with self._acting:
            if self.can_redo:
                self._append({"act": _REDO})

    async def write(self, to: Path) -> bytes:
        """Write the painting as it is now into a file, and return a JPEG of it. Raises as `write_edited`."""
        return await self._desk.do(write_edited, self._painting, self.edits, to)

    async def _do(self, edit: str) -> None:
        async with self._acting:
            await self._desk.do(check_edits, self._painting, (*self.edits, edit))
            self._append({"edit": json.loads(edit)})

    def _append(self, line: dict[str, Any]) -> None:
        with as_output_error(self._file.parent, MAKE_ROOM), self._file.open("ab") as file:
            file.write(f"{json.dumps(line)}\n".encode())
            file.flush()
            os.fsync(file.fileno())
        self._lines.append(line)
        self.changed.emit()


def _sum_of(painting: Path) -> str:
    """Return a short sum of a painting's file: a plan that went on has other strokes than those that were edited."""
    return hashlib.sha256(painting.read_bytes()).hexdigest()[:12]


def _read(file: Path) -> list[dict[str, Any]]:
    """Return the acts in a file; what a power cut left of the last one is dropped from it."""
    if not file.is_file():
        return []
    kept, lines = [], file.read_bytes().splitlines(keepends=True)
    for line in lines:
        try:
            kept.append(_checked(json.loads(line)))
        except (ValueError, TypeError):
            break
    if len(kept) < len(lines) or not lines[-1].endswith(b"\n"):
        atomic_write(file, b"".join(f"{json.dumps(line)}\n".encode() for line in kept))
    return kept


def _checked(line: Any) -> dict[str, Any]:
    """Return an act as it was read. Raises ValueError where it is none."""
    if not isinstance(line, dict) or (line.get("act") not in (_UNDO, _REDO) and "edit" not in line):
        raise ValueError(f"{line!r} is no act")
    if "edit" in line:
        STROKE_EDIT.validate_python(line["edit"], strict=False)
    return line


def _folded(lines: Sequence[dict[str, Any]]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the edits that are done after acts, as JSON, and those that could be redone, the next one last."""
    done: list[str] = []
    undone: list[str] = []
    for line in lines:
        match line.get("act"):
            case "undo" if done:
                undone.append(done.pop())
            case "redo" if undone:
                done.append(undone.pop())
            case None:
                done.append(json.dumps(line["edit"]))
                undone.clear()
    return tuple(done), tuple(undone)
