"""Strokes that a person has changed in a plan, counted."""

from dataclasses import dataclass
from pathlib import Path

from maulstick.studio.workers.stroke_marks import after_edits


@dataclass(frozen=True)
class StrokeChanges:
    """Numbers of strokes that differ after a person's edits; each counts once, under the first that it is.

    left: number of all that there are then.
    """

    drawn: int = 0
    removed: int = 0
    moved: int = 0
    repainted: int = 0
    locked: int = 0
    unlocked: int = 0
    left: int = 0


def changes_of(file: Path, edits: tuple[str, ...]) -> StrokeChanges:
    """Count what edits, in JSON, change in the plan in a file. Raises InputError as `after_edits`."""
    before = {stroke.id: stroke for stroke in after_edits(file, ()).strokes}
    now = {stroke.id: stroke for stroke in after_edits(file, edits).strokes}
    both = [(before[id], now[id]) for id in before.keys() & now.keys()]
    stayed = [(was, is_) for was, is_ in both if was.trajectory == is_.trajectory]
    same = [(was.locked, is_.locked) for was, is_ in stayed if was.paint == is_.paint]
    return StrokeChanges(
        drawn=len(now.keys() - before.keys()),
        removed=len(before.keys() - now.keys()),
        moved=len(both) - len(stayed),
        repainted=len(stayed) - len(same),
        locked=same.count((False, True)),
        unlocked=same.count((True, False)),
        left=len(now),
    )
