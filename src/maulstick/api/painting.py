"""A painting in Python: a file, an SVG, and a picture in a notebook."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Self

import numpy as np
import numpy.typing as npt
from pydantic import ValidationError

from maulstick.api.usual_torch import in_usual_torch
from maulstick.api.warning import warn
from maulstick.drawing.options import DrawingOptions
from maulstick.errors import InputError, validation_fault
from maulstick.jobs.paintable import read_paintable
from maulstick.kinds import check_names, checked
from maulstick.painting import painting as records
from maulstick.painting.painting_file import write_painting
from maulstick.painting.picture import encode_png
from maulstick.painting.stroke_edits import (
    AddStroke,
    LockStrokes,
    MoveStrokes,
    RemoveStrokes,
    RepaintStrokes,
    StrokeEdit,
    UnlockStrokes,
    edited,
)
from maulstick.painting.svg import painting_svg
from maulstick.storage.text import counted

_NOTEBOOK_PX = 512  # height of the picture in a notebook, pixels: fits beside its code
_WIDEST_PX = 4096  # its largest width: a frieze that is as high would be wider than any picture that is drawn


class Painting(records.Painting):
    """Strokes in painting order, with their sheet, brushes and paints; the record itself, and ways to show and save it.

    Fields are those of the file painting.json: `sheet`, `area`, `provenance`, `brushes`, `paints`, `strokes`, and
    `succession` where strokes are drawn in the order of a hand; lengths in metres, colours sRGB in [0, 1].

        >>> import maulstick as ms
        >>> painting = ms.plan(demo_picture, strokes=5, steps=2, px=16)
        >>> len(painting.strokes) <= 5
        True
    """

    @classmethod
    def of(cls, record: records.Painting) -> Self:
        """Return a painting with the same fields as the record."""
        return cls.model_construct(record.model_fields_set, **dict(record))

    @checked
    def save(self, path: str | Path) -> None:
        """Write painting.json, or an SVG in millimetres where the name ends in .svg.

        Raises InputError for a name that ends otherwise, and OutputError where writing fails; what was at `path` is
        then still there.

            >>> painting.save(folder / "cat.json")
        """
        ending = Path(path).suffix.lower()
        if ending not in (".json", ".svg"):
            raise InputError(f"{path} ends neither in .json nor in .svg, as a painting is kept; give it such a name")
        if ending == ".svg":
            from maulstick.storage.files import atomic_write

            atomic_write(path, self.to_svg().encode())
        else:
            write_painting(self, path)

    def to_svg(self) -> str:
        """Return an SVG for plotters: real millimetres, one layer per paint, one open path per stroke.

        >>> painting.to_svg().startswith("<")
        True
        """
        return painting_svg(self)

    def lock(self, *ids: int) -> Self:
        """Return the painting with these strokes locked, by their ids: planning again leaves them as they are.

        Raises InputError for a stroke that is not there.

            >>> [stroke.locked for stroke in painting.lock(painting.strokes[0].id).strokes][:1]
            [True]
        """
        return self._edited(LockStrokes, strokes=ids) if ids else self

    def unlock(self, *ids: int) -> Self:
        """Return the painting with these strokes unlocked. Raises InputError for a stroke that is not there.

        >>> any(stroke.locked for stroke in painting.unlock(painting.strokes[0].id).strokes)
        False
        """
        return self._edited(UnlockStrokes, strokes=ids) if ids else self

    def remove(self, *ids: int) -> Self:
        """Return the painting without these strokes. Raises InputError for a stroke that is not there.

        >>> len(painting.remove(painting.strokes[0].id).strokes) == len(painting.strokes) - 1
        True
        """
        return self._edited(RemoveStrokes, strokes=ids) if ids else self

    def move(self, *ids: int, by: tuple[float, float] = (0.0, 0.0), turn: float = 0.0) -> Self:
        """Return the painting with these strokes turned about their common middle, then moved, and locked.

        by: metres, to the right and down.  turn: radians, clockwise.
        Raises InputError for a stroke that is not there, or would leave the sheet.

            >>> painting.move(painting.strokes[0].id, by=(0.0, 0.0), turn=0.1).strokes[0].locked
            True
        """
        return self._edited(MoveStrokes, strokes=ids, by=by, turn=turn) if ids else self

    def repaint(self, *ids: int, paint: int) -> Self:
        """Return the painting with these strokes in the paint of this index, after all others of it, and locked.

        Raises InputError for a stroke or a paint that is not there.

            >>> painting.repaint(painting.strokes[0].id, paint=0).strokes[0].paint
            0
        """
        return self._edited(RepaintStrokes, strokes=ids, paint=paint) if ids else self

    def add(self, trajectory: npt.ArrayLike, *, paint: int, speed: Sequence[float] | None = None) -> Self:
        """Return the painting with a person's own stroke, after all others of its paint, and locked.

        trajectory: (n, 3) of x and y on the sheet, metres, and pressure in [0, 1].  paint: its index.
        speed: metres per second at each point.
        Raises InputError for a trajectory of another shape, a paint that is not there, and a stroke off the sheet.

            >>> mine = painting.add([(0.1, 0.1, 0.5), (0.12, 0.1, 0.5)], paint=0)
            >>> [stroke.origin for stroke in mine.strokes].count("person")
            1
        """
        try:
            if np.iscomplexobj(trajectory):
                raise TypeError("it has complex numbers")
            points = np.asarray(trajectory, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise InputError(f"a trajectory is no array: {error}; it must be (n, 3) of x, y and pressure") from error
        if points.ndim != 2 or points.shape[1] != 3 or not len(points):
            raise InputError(f"a trajectory has shape {points.shape}; it must be (n, 3) of x, y and pressure")
        return self._edited(AddStroke, paint=paint, trajectory=points.tolist(), speed=speed)

    def _edited(self, kind: type[StrokeEdit], **fields: object) -> Self:
        try:
            return edited(self, [kind.model_validate(fields)])
        except ValidationError as error:
            raise InputError(validation_fault(error)) from error

    def __repr__(self) -> str:
        """Say how many strokes there are, in how many paints and on which sheet; they themselves fill pages."""
        return (
            f"<Painting: {counted(len(self.strokes), 'stroke')}, {counted(len(self.paints), 'paint')}, "
            f"{self.sheet.millimetres}>"
        )

    __str__ = __repr__

    @in_usual_torch
    def _repr_png_(self) -> bytes:
        from maulstick.rendering.preview import preview_of_height  # loads torch

        widest = round(_WIDEST_PX * self.sheet.height / self.sheet.width)
        return encode_png(preview_of_height(self, max(1, min(_NOTEBOOK_PX, widest))))


@checked
@in_usual_torch
def read_painting(path: str | Path, **drawing: Any) -> Painting:
    """Read a painting.json, or an SVG as a painting that a machine draws as it is.

    drawing: fields of `DrawingOptions`, by which an SVG is read, as in ``size="A4", hatch="1mm"``, or in metres: size,
    margin, rotate, hatch, hatch_angle, hatch_hand, no_repeats, join, shortest, keep_order.
    Raises InputError where there is none, or it is not a painting. Warns of what of an SVG is not drawn as it says.

        >>> read_painting(folder / "cat.json").sheet.width
        0.2
    """
    check_names(drawing, DrawingOptions.model_fields)
    try:
        options = DrawingOptions.model_validate(drawing) if drawing else None
    except ValidationError as error:
        raise InputError(validation_fault(error)) from error
    read = read_paintable(path, options)
    for note in read.notes:
        warn(note)
    return Painting.of(read.painting)
