"""A painting in Python: a file, an SVG, and a picture in a notebook."""

import warnings
from pathlib import Path
from typing import Any, Self

from pydantic import ValidationError

from maulstick.drawing.options import DrawingOptions
from maulstick.errors import InputError, validation_fault
from maulstick.jobs.paintable import read_paintable
from maulstick.painting import painting as records
from maulstick.painting.picture import encode_png
from maulstick.painting.svg import painting_svg

_NOTEBOOK_PX = 512  # height of the picture in a notebook, pixels: fits beside its code


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

    def save(self, path: str | Path) -> None:
        """Write painting.json, or an SVG in millimetres where the name ends in .svg.

        Raises OutputError where that fails; what was at `path` is then still there.

            >>> painting.save(folder / "cat.json")
        """
        if Path(path).suffix.lower() == ".svg":
            from maulstick.storage.files import atomic_write

            atomic_write(path, self.to_svg().encode())
        else:
            records.write_painting(self, path)

    def to_svg(self) -> str:
        """Return an SVG for plotters: real millimetres, one layer per paint, one open path per stroke.

        >>> painting.to_svg().startswith("<")
        True
        """
        return painting_svg(self)

    def _repr_png_(self) -> bytes:
        from maulstick.rendering.preview import preview_of_height  # loads torch

        return encode_png(preview_of_height(self, _NOTEBOOK_PX))


def read_painting(path: str | Path, **drawing: Any) -> Painting:
    """Read a painting.json, or an SVG as a painting that a machine draws as it is.

    drawing: fields of `DrawingOptions`, by which an SVG is read, lengths in metres: size, margin, rotate, hatch,
    hatch_angle, hatch_hand, no_repeats, shortest, keep_order.
    Raises InputError where there is none, or it is not a painting. Warns of what of an SVG is not drawn as it says.

        >>> read_painting(folder / "cat.json").sheet.width
        0.2
    """
    try:
        options = DrawingOptions.model_validate(drawing) if drawing else None
    except ValidationError as error:
        raise InputError(validation_fault(error)) from error
    read = read_paintable(path, options)
    for note in read.notes:
        warnings.warn(note, stacklevel=2)
    return Painting.of(read.painting)
