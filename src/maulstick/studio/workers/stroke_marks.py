"""Strokes of a plan as a page draws them: the places and half-widths of their marks, in a compact binary form."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Final

import numpy as np

from maulstick.errors import InputError
from maulstick.painting.brush import Brush
from maulstick.painting.painting import Painting, Stroke, hex_colour
from maulstick.painting.painting_file import read_painting, write_painting
from maulstick.painting.refined import refined
from maulstick.painting.stroke_edits import STROKE_EDIT, AddStroke, edited
from maulstick.storage.arrays import Floats
from maulstick.storage.text import counted
from maulstick.strokes.strokes import resample
from maulstick.studio.workers.first_frame import first_frame

BESIDE: Final = 0.02
"""Metres beyond the sheet's edges within which marks are told; brushes reach less far."""

_PRESSURES = np.linspace(0, 1, 9)  # at which a page knows a brush's half-width; it interpolates
_POINTS = 32  # of a stroke that a person draws, as those of planned ones
_STEPS = 65535  # of a coordinate: 4 micrometres on A4


@dataclass(frozen=True)
class ShownPaint:
    """Paint as a page shows it. half_widths: of its bare mark at pressures from 0 to 1, millimetres."""

    colour: str
    label: str
    brush: str
    half_widths: tuple[float, ...]


@dataclass(frozen=True)
class ShownSheet:
    """Sheet of a plan, millimetres, the colour of its paper, and its paints in their order."""

    width: float
    height: float
    paper: str
    paints: tuple[ShownPaint, ...]


@dataclass(frozen=True)
class Written:
    """Plan that was written with edits. frame: a JPEG of it.  strokes: planned and locked, None where it says none."""

    frame: bytes
    strokes: int | None


def shown_sheet(file: Path) -> ShownSheet:
    """Return the sheet and the paints of the painting in a file. Raises InputError as `read_painting`."""
    painting = after_edits(file, ())
    sheet = painting.sheet
    paints = tuple(
        ShownPaint(paint.hex, paint.label, paint.brush, _half_widths(painting.brushes[paint.brush]))
        for paint in painting.paints
    )
    return ShownSheet(1e3 * sheet.width, 1e3 * sheet.height, hex_colour(sheet.paper), paints)


def changed_marks(file: Path, edits: tuple[str, ...], before: tuple[str, ...] | None) -> bytes:
    """Return `as_bytes` of the strokes that differ between a plan after some edits and after others, in JSON.

    before: the edits of what a page shows; None where it shows nothing yet. Raises InputError as `edited`.
    """
    changed = file.stat().st_mtime_ns
    painting = _edited(file, changed, edits)
    if before is None:
        return as_bytes(painting, painting.strokes)
    known = {stroke.id: stroke for stroke in _edited(file, changed, before).strokes}
    return as_bytes(painting, [stroke for stroke in painting.strokes if not _is_same(known.get(stroke.id), stroke)])


def check_edits(file: Path, edits: tuple[str, ...]) -> None:
    """Raise InputError where a plan cannot have these edits, in JSON."""
    after_edits(file, edits)


def write_edited(file: Path, edits: tuple[str, ...], to: Path) -> Written:
    """Write the plan with these edits, in JSON, into another file. Raises InputError, and OutputError for no room."""
    painting = after_edits(file, edits)
    write_painting(painting, to)
    strokes = painting.provenance.options.get("strokes")
    return Written(first_frame(painting), strokes if isinstance(strokes, int) else None)


def drawn_edit(file: Path, paint: int, points: list[tuple[float, float, float]]) -> str:
    """Return the edit, in JSON, that adds a stroke whose mark lies where a person drew it.

    points: x, y in metres and pressure in [0, 1]. Raises InputError for a paint that is not there.
    """
    painting = after_edits(file, ())
    if not 0 <= paint < len(painting.paints):
        raise InputError.of_range(
            "the paint", paint, f"an index into the {counted(len(painting.paints), 'paint')}, from 0"
        )
    brush = painting.brushes[painting.paints[paint].brush]
    path = resample(np.array(points, dtype=np.float64), min(_POINTS, len(points)))
    offset, scale = np.array((brush.b_x, brush.b_y)), np.array((brush.m_x, brush.m_y))
    start = path[:1, :2] - offset  # `Brush.mark` scales about the first commanded point
    path[:, :2] = (start + (path[:, :2] - offset - start) / scale).clip(
        0, (painting.sheet.width, painting.sheet.height)
    )
    path[:, 2] = path[:, 2].clip(0, 1)
    return STROKE_EDIT.dump_json(AddStroke(paint=paint, trajectory=tuple(map(tuple, path.tolist())))).decode()


def after_edits(file: Path, edits: tuple[str, ...]) -> Painting:
    """Return the painting in a file after edits, in JSON. Raises InputError as `read_painting` and `edited`."""
    try:
        changed = file.stat().st_mtime_ns
    except OSError as error:
        raise no_plan() from error
    return _edited(file, changed, edits)


def no_plan() -> InputError:
    """Return the error for a plan that was thrown away meanwhile."""
    return InputError("that plan is there no more; look in the trash")


@lru_cache(maxsize=4)
def _edited(file: Path, changed: int, edits: tuple[str, ...]) -> Painting:
    """Return the painting in a file after edits, in JSON. changed: when the file was, in nanoseconds."""
    if not edits:
        return read_painting(file)
    return edited(_edited(file, changed, ()), map(STROKE_EDIT.validate_json, edits))


def _is_same(known: Stroke | None, stroke: Stroke) -> bool:
    return known is stroke or known == stroke


def as_bytes(painting: Painting, strokes: Sequence[Stroke]) -> bytes:
    """Return the order of all strokes of a painting, and the marks of some of them, for a page.

    Little-endian: six float64 (number of all strokes, of these, of their points; left, upper, millimetres per step),
    the ids of all strokes in their order and those of these strokes, float64; the number of points of each, uint32; and
    as uint16 its paint, its opacity in 255ths, 1 where it is locked, and x, y and half-width of all points, in steps.
    """
    marks = _marks(painting, strokes)
    counts = np.array([len(mark) for mark, _ in marks], dtype="<u4")
    longest = max(painting.sheet.width, painting.sheet.height) + 2 * BESIDE
    step = longest / _STEPS
    points = np.concatenate([mark for mark, _ in marks]) if marks else np.zeros((0, 3))
    told = (points + np.array((BESIDE, BESIDE, 0))) / step
    head = [len(painting.strokes), len(strokes), len(points), -1e3 * BESIDE, -1e3 * BESIDE, 1e3 * step]
    return b"".join(
        [
            np.array(head, dtype="<f8").tobytes(),
            np.array([stroke.id for stroke in painting.strokes], dtype="<f8").tobytes(),
            np.array([stroke.id for stroke in strokes], dtype="<f8").tobytes(),
            counts.tobytes(),
            np.array([stroke.paint for stroke in strokes], dtype="<u2").tobytes(),
            np.array([round(255 * opacity) for _, opacity in marks], dtype="<u2").tobytes(),
            np.array([stroke.locked for stroke in strokes], dtype="<u2").tobytes(),
            told.round().clip(0, _STEPS).astype("<u2").tobytes(),
        ]
    )


def _marks(painting: Painting, strokes: Sequence[Stroke]) -> list[tuple[Floats, float]]:
    """Return of each stroke its mark (n, 3), metres, with half-widths as of `_seen`, and its opacity."""
    fine = refined(painting.model_copy(update={"strokes": tuple(strokes)}))
    marks = []
    for stroke in fine.strokes:
        brush = painting.brushes[painting.paints[stroke.paint].brush]
        points, widths, opacity = brush.bare_mark(np.array(stroke.trajectory, dtype=np.float64))
        marks.append((np.column_stack([points, widths.clip(min=0) * _seen(brush)]), opacity))
    return marks


def _seen(brush: Brush) -> float:
    """Share of a mark's half-width within which it is at least half as dark as in its middle: where an eye ends it."""
    return float(1 - (1 - brush.plateau) * 0.5 ** (1 / brush.falloff))


def _half_widths(brush: Brush) -> tuple[float, ...]:
    widths: list[float] = (1e3 * brush.half_width(_PRESSURES).clip(min=0) * _seen(brush)).tolist()
    return tuple(widths)
