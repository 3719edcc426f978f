"""Acts of a person who directs a plan, kept beside it: each can be undone and redone, also in a later studio."""

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any, final

from nicegui import Event
from pydantic import ValidationError

from maulstick.errors import InputError, validation_fault
from maulstick.painting.stroke_edits import STROKE_EDIT
from maulstick.studio.state.acts import Acts
from maulstick.studio.state.saying import SAID, Saying
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.said import SAID_ACT
from maulstick.studio.workers.stroke_changes import StrokeChanges, changes_of
from maulstick.studio.workers.stroke_marks import (
    ShownSheet,
    Written,
    changed_marks,
    check_edits,
    drawn_edit,
    shown_sheet,
    write_edited,
)

_EDIT = "edit"  # kind of the acts on strokes
_MOST_DRAWN = 20_000  # points of a stroke that is drawn: minutes of a pen


@final
class Directing:
    """Edits of one plan's painting, which itself stays as it was planned.

    saying: what is said of places on its sheet, in the same file of acts.
    planned: time of the painting, nanoseconds.
    Raises InputError where the regions that the plan was made with, or acts on it, cannot be read.
    """

    def __init__(self, painting: Path, desk: Desk) -> None:
        self._painting, self._desk = painting, desk
        self.planned = painting.stat().st_mtime_ns
        kinds = {_EDIT: STROKE_EDIT.validate_python, SAID: SAID_ACT.validate_python}
        self._acts = Acts(painting.with_name(f"edits-{_sum_of(painting)}.jsonl"), kinds)
        self.saying = Saying(painting, desk, self._acts)

    @property
    def changed(self) -> Event[[]]:
        """Event at each act."""
        return self._acts.changed

    @property
    def version(self) -> int:
        """Number of acts so far, undoing counted."""
        return self._acts.version

    @property
    def edits(self) -> tuple[str, ...]:
        """Edits of strokes that are not undone, as JSON."""
        return self._acts.done(_EDIT)

    @property
    def can_undo(self) -> bool:
        """Whether there is an act to undo."""
        return self._acts.can_undo

    @property
    def can_redo(self) -> bool:
        """Whether there is an act to redo."""
        return self._acts.can_redo

    async def sheet(self) -> ShownSheet:
        """Return the sheet and the paints of the plan."""
        return await self._desk.do(shown_sheet, self._painting)

    async def marks(self, version: int, since: int | None) -> bytes:
        """Return the strokes after so many acts that are others than after `since` acts; all where that is None."""
        before = None if since is None else self._acts.done(_EDIT, since)
        return await self._desk.do(changed_marks, self._painting, self._acts.done(_EDIT, version), before)

    async def edit(self, sent: dict[str, Any]) -> None:
        """Do an edit, a record of `StrokeEdit` as a page sends it. Raises InputError where it cannot be."""
        try:
            edit = STROKE_EDIT.validate_python(sent)
        except ValidationError as error:
            raise InputError(f"that is no edit of strokes: {validation_fault(error)}; choose them again") from error
        async with self._acts.turn:
            await self._do(STROKE_EDIT.dump_json(edit).decode())

    async def draw(self, paint: int, points: Sequence[float]) -> None:
        """Add a stroke that a person drew. points: x, y in metres and pressure of each; raises as `drawn_edit`."""
        if not points or len(points) > 3 * _MOST_DRAWN or len(points) % 3:
            raise InputError(f"a stroke has {len(points) // 3} points; draw one with 1 to {_MOST_DRAWN}")
        triples = list(zip(points[::3], points[1::3], points[2::3], strict=True))
        async with self._acts.turn:  # or what is undone meanwhile would be the act before
            await self._do(await self._desk.do(drawn_edit, self._painting, paint, triples))

    async def undo(self) -> None:
        """Undo the last act that is not undone, if there is one."""
        await self._acts.undo()

    async def redo(self) -> None:
        """Do again what was undone last, unless something else was done since."""
        await self._acts.redo()

    async def write(self, to: Path) -> Written:
        """Write the painting as it is now into a file; raises as `write_edited`."""
        return await self._desk.do(write_edited, self._painting, self.edits, to)

    async def changes(self) -> StrokeChanges:
        """Count the strokes that are others than those that were planned."""
        return await self._desk.do(changes_of, self._painting, self.edits)

    async def _do(self, edit: str) -> None:
        """Do an edit in its turn."""
        await self._desk.do(check_edits, self._painting, (*self.edits, edit))
        self._acts.add(_EDIT, edit)


def _sum_of(painting: Path) -> str:
    """Return a short sum of a painting's file: a plan that went on has other strokes than those that were edited."""
    return hashlib.sha256(painting.read_bytes()).hexdigest()[:12]
