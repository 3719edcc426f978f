"""Acts of a person in a file of lines that only grows: each an edit, or that the last one was undone or redone."""

import asyncio
import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, final

from nicegui import Event

from maulstick.errors import InputError
from maulstick.storage.files import append_whole, atomic_write
from maulstick.storage.folders import MAKE_ROOM, as_output_error
from maulstick.studio.workers.stroke_marks import no_plan

_UNDO, _REDO = "undo", "redo"


@final
class Acts:
    """Acts in a file, each a record under the name of its kind, checked by that kind's function when it is read.

    changed: event at each act.  turn: lock under which an act is checked after all before it, and done.
    Raises InputError where a line of the file is no act, and leaves the file as it is.
    """

    def __init__(self, file: Path, kinds: Mapping[str, Callable[[Any], object]]) -> None:
        self.changed = Event[[]]()
        self.turn = asyncio.Lock()
        self._file, self._kinds = file, kinds
        self._lines = self._read()

    @property
    def version(self) -> int:
        """Number of acts so far, undoing counted."""
        return len(self._lines)

    @property
    def can_undo(self) -> bool:
        """Whether there is an act to undo."""
        return bool(_folded(self._lines)[0])

    @property
    def can_redo(self) -> bool:
        """Whether there is an act to redo."""
        return bool(_folded(self._lines)[1])

    def done(self, kind: str, version: int | None = None) -> tuple[str, ...]:
        """Return the acts of a kind, as JSON, that are not undone after the first `version` lines, or after all."""
        return tuple(json.dumps(line[kind]) for line in _folded(self._lines[:version])[0] if kind in line)

    async def undo(self) -> None:
        """Undo the last act that is not undone, if there is one."""
        async with self.turn:
            if self.can_undo:
                self._append({"act": _UNDO})

    async def redo(self) -> None:
        """Do again what was undone last, unless something else was done since."""
        async with self.turn:
            if self.can_redo:
                self._append({"act": _REDO})

    def add(self, kind: str, act: str) -> None:
        """Add an act of a kind, in JSON. Raises OutputError where it cannot be written, InputError as `no_plan`."""
        self._append({kind: json.loads(act)})

    def _append(self, line: dict[str, Any]) -> None:
        if not self._file.parent.is_dir():
            raise no_plan()
        with as_output_error(self._file.parent, MAKE_ROOM), self._file.open("ab") as file:
            append_whole(file.fileno(), f"{json.dumps(line)}\n".encode())
        self._lines.append(line)
        self.changed.emit()

    def _read(self) -> list[dict[str, Any]]:
        """Return the acts in the file; what a power cut left of the last one is dropped from it."""
        if not self._file.is_file():
            return []
        content = self._file.read_bytes()
        whole = content[: content.rfind(b"\n") + 1]
        acts = []
        for number, line in enumerate(whole.split(b"\n")[:-1], start=1):
            try:
                acts.append(self._checked(json.loads(line)))
            except (ValueError, TypeError, RecursionError) as error:
                raise InputError(
                    f"line {number} of {self._file} is no act that this Maulstick knows; update Maulstick, or move the "
                    "file elsewhere to begin without these acts"
                ) from error
        if len(whole) < len(content):
            atomic_write(self._file, whole)
        return acts

    def _checked(self, line: Any) -> dict[str, Any]:
        """Return an act as it was read. Raises ValueError where it is none."""
        act: dict[str, Any] = line if isinstance(line, dict) else {}
        if act.get("act") not in (_UNDO, _REDO):
            if (kind := next((kind for kind in self._kinds if kind in act), None)) is None:
                raise ValueError(f"{line!r} is no act")
            self._kinds[kind](act[kind])
        return act


def _folded(lines: Sequence[dict[str, Any]]) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Return the acts that are done after lines, and those that could be redone, the next one last."""
    done: list[dict[str, Any]] = []
    undone: list[dict[str, Any]] = []
    for line in lines:
        match line.get("act"):
            case "undo" if done:
                undone.append(done.pop())
            case "redo" if undone:
                done.append(undone.pop())
            case None:
                done.append(line)
                undone.clear()
    return done, undone
