"""Edits of a painting's strokes by a person: locked, taken out, moved, given another paint, or drawn by hand.

What a person has moved, painted otherwise or drawn is locked, or planning again would undo it.
"""

from collections.abc import Iterable
from math import cos, sin
from typing import Annotated, Literal, TypeVar

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from maulstick.errors import InputError
from maulstick.painting.fields import Length, Metres, NineDigits, Point
from maulstick.painting.painting import Painting, Stroke
from maulstick.painting.painting_file import painting_fault
from maulstick.storage.text import counted

Some = TypeVar("Some", bound=Painting)
Ids = Annotated[tuple[int, ...], Field(min_length=1)]


class _Edit(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class LockStrokes(_Edit):
    """Lock strokes, by their ids: planning again leaves them as they are."""

    kind: Literal["lock"] = "lock"
    strokes: Ids


class UnlockStrokes(_Edit):
    """Let planning change strokes again."""

    kind: Literal["unlock"] = "unlock"
    strokes: Ids


class RemoveStrokes(_Edit):
    """Take strokes out."""

    kind: Literal["remove"] = "remove"
    strokes: Ids


class MoveStrokes(_Edit):
    """Turn strokes about the middle of their common box, `turn` radians, then move them `by` (x, y), metres."""

    kind: Literal["move"] = "move"
    strokes: Ids
    by: tuple[Metres, Metres] = (0.0, 0.0)
    turn: NineDigits = 0.0


class RepaintStrokes(_Edit):
    """Give strokes the paint of this index; they are painted after all others of that paint."""

    kind: Literal["repaint"] = "repaint"
    strokes: Ids
    paint: int


class AddStroke(_Edit):
    """Add a person's own stroke, painted after all others of its paint; fields as those of `Stroke`."""

    kind: Literal["add"] = "add"
    paint: int
    trajectory: Annotated[tuple[Point, ...], Field(min_length=1)]
    speed: tuple[Length, ...] | None = None


StrokeEdit = Annotated[
    LockStrokes | UnlockStrokes | RemoveStrokes | MoveStrokes | RepaintStrokes | AddStroke, Field(discriminator="kind")
]
"""An edit of strokes; in JSON its `kind` says which."""

STROKE_EDIT: TypeAdapter[StrokeEdit] = TypeAdapter(StrokeEdit)
"""Reader and writer of edits as JSON."""


def edited(painting: Some, edits: Iterable[StrokeEdit]) -> Some:
    """Return the painting after the edits, one after another.

    Strokes that are added get the ids after the painting's largest, in the order of their edits. Where an edit changes
    what is painted, the metrics of the painting, which are of what was planned, are left out.
    Raises InputError for a stroke or paint that is not there, and a stroke that would leave the sheet.
    """
    free = 1 + max((stroke.id for stroke in painting.strokes), default=-1)
    strokes, provenance = list(painting.strokes), painting.provenance
    for edit in edits:
        if not isinstance(edit, LockStrokes | UnlockStrokes):
            provenance = painting.provenance.model_copy(update={"metrics": {}})
        if isinstance(edit, AddStroke):
            _check_paint(edit.paint, painting)
            if edit.speed is not None and len(edit.speed) != len(edit.trajectory):
                raise InputError(
                    f"it has {counted(len(edit.speed), 'speed')} for {counted(len(edit.trajectory), 'point')}; "
                    "give as many"
                )
            own = Stroke(
                id=free, paint=edit.paint, trajectory=edit.trajectory, speed=edit.speed, locked=True, origin="person"
            )
            strokes, free = _after_its_paint(strokes, [own]), free + 1
        else:
            strokes = _with_edit(painting, strokes, edit)
    try:
        changes = {"strokes": tuple(strokes), "provenance": provenance}
        return type(painting).model_validate({**dict(painting), **changes})
    except ValidationError as error:
        raise InputError(painting_fault(error)) from error


def _with_edit(
    painting: Painting,
    strokes: list[Stroke],
    edit: LockStrokes | UnlockStrokes | RemoveStrokes | MoveStrokes | RepaintStrokes,
) -> list[Stroke]:
    wanted, there = set(edit.strokes), {stroke.id for stroke in strokes}
    if missing := wanted - there:
        raise InputError(f"there is no stroke {min(missing)} in the painting; name strokes by their ids")
    if isinstance(edit, RemoveStrokes):
        return [stroke for stroke in strokes if stroke.id not in wanted]
    if isinstance(edit, RepaintStrokes):
        _check_paint(edit.paint, painting)
        change = {"paint": edit.paint, "locked": True}
        repainted = [stroke.model_copy(update=change) for stroke in strokes if stroke.id in wanted]
        return _after_its_paint([stroke for stroke in strokes if stroke.id not in wanted], repainted)
    if isinstance(edit, MoveStrokes):
        moved = iter(_moved([stroke for stroke in strokes if stroke.id in wanted], edit))
        return [next(moved) if stroke.id in wanted else stroke for stroke in strokes]
    locked = isinstance(edit, LockStrokes)
    return [stroke.model_copy(update={"locked": locked}) if stroke.id in wanted else stroke for stroke in strokes]


def _moved(strokes: list[Stroke], edit: MoveStrokes) -> list[Stroke]:
    """Return the strokes moved together, with the poses of their styles."""
    every = np.concatenate([np.array(stroke.trajectory)[:, :2] for stroke in strokes])
    middle = (every.min(axis=0) + every.max(axis=0)) / 2
    turned = np.array([[cos(edit.turn), -sin(edit.turn)], [sin(edit.turn), cos(edit.turn)]])
    moved = []
    for stroke in strokes:
        points = np.array(stroke.trajectory)
        points[:, :2] = (points[:, :2] - middle) @ turned.T + middle + edit.by
        fields = {**dict(stroke), "trajectory": tuple(map(tuple, points.tolist())), "locked": True}
        if stroke.style is not None:
            x, y = turned @ (np.array(stroke.style.pose[:2]) - middle) + middle + edit.by
            fields["style"] = {**dict(stroke.style), "pose": (float(x), float(y), stroke.style.pose[2] + edit.turn)}
        moved.append(Stroke.model_validate(fields))
    return moved


def _after_its_paint(strokes: list[Stroke], new: list[Stroke]) -> list[Stroke]:
    """Return the strokes with new ones of one paint after the last of that paint, or where it has none, at the end."""
    last = max((place for place, stroke in enumerate(strokes) if stroke.paint == new[0].paint), default=len(strokes))
    return [*strokes[: last + 1], *new, *strokes[last + 1 :]]


def _check_paint(paint: int, painting: Painting) -> None:
    if not 0 <= paint < len(painting.paints):
        raise InputError.of_range(
            "the paint", paint, f"an index into the {counted(len(painting.paints), 'paint')}, from 0"
        )
