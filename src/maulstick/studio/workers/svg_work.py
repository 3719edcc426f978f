"""Tasks of the desk with SVGs: keeping one that was brought, and reading it in other ways."""

import shutil
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict

from maulstick.drawing.options import DrawingOptions
from maulstick.jobs.paintable import is_svg, read_paintable
from maulstick.painting.picture import encode_png
from maulstick.storage.files import atomic_write
from maulstick.storage.folders import whole_folder
from maulstick.storage.records import read_record, write_record
from maulstick.studio.workers.uploads import known_as

CARD, PICTURE = "card.json", "preview.png"
"""Files beside an SVG: what was read of it, and what it looks like as a pen draws it."""

_LONGER = 1024  # pixels of a picture's longer side


class SvgCard(BaseModel):
    """Content of card.json about an SVG, as it is read by these options.

    sheet: width and height, metres.  paths: their number.  metres: length of all of them.  pens: their number.
    notes: sentences about what of the file is not painted as it says.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    version: Literal[1] = 1
    options: DrawingOptions
    sheet: tuple[float, float]
    paths: int
    metres: float
    pens: int
    notes: tuple[str, ...] = ()


def keep_svg(brought: Path, called: str, file: Path) -> None:
    """Store an SVG that was brought as `file` in a new folder with its card and its picture, whole or not at all.

    called: its name in errors. Raises InputError where it cannot be drawn, and where the folder exists by now;
    OutputError where there is no room for it.
    """
    taken = f"there is a drawing {file.parent.name} meanwhile; use that one, or bring yours again"
    with whole_folder(file.parent, taken) as made:
        shutil.copyfile(brought, made / file.name)
        read_svg(made / file.name, called, DrawingOptions())


def read_svg(file: Path, called: str, options: DrawingOptions) -> None:
    """Read an SVG by these options, and write its picture and its card.

    called: its name in errors. Raises InputError where it cannot be drawn so, and leaves what was written before.
    """
    from maulstick.rendering.preview import preview_of_height  # loads torch

    with known_as(file, called):
        read = read_paintable(file, options)
    painting = read.painting
    size = painting.sheet.width, painting.sheet.height
    picture = preview_of_height(painting, max(1, round(_LONGER * size[1] / max(size))))
    card = SvgCard(
        options=options,
        sheet=size,
        paths=len(painting.strokes),
        metres=float(painting.lengths().sum()),
        pens=len(painting.paints),
        notes=read.notes,
    )
    atomic_write(file.with_name(PICTURE), encode_png(picture))
    write_record(card, file.with_name(CARD))


def options_of(file: Path) -> DrawingOptions | None:
    """Return the options by which an SVG is read, as its card says; None for a painting.json, or without a card.

    Raises InputError for a card that cannot be read.
    """
    card = file.with_name(CARD)
    return read_record(SvgCard, card, "drawing's card").options if is_svg(file) and card.is_file() else None
