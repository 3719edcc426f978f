"""Files of a painting that people take elsewhere: for other machines, for the screen, and for print."""

import io
import zipfile
from dataclasses import dataclass
from pathlib import Path

from PIL import Image

from maulstick.jobs.export import ExportOptions, exported
from maulstick.jobs.paintable import read_paintable
from maulstick.painting.picture import encode_png

_PRINT = 300  # pixels per inch, as printers ask for
_INCH = 0.0254  # metres


@dataclass(frozen=True)
class Taken:
    """File to save. name: of it, for people.  notes: sentences about what it leaves out."""

    name: str
    content: bytes
    notes: tuple[str, ...] = ()


def export_for_machine(painting: Path, name: str, options: ExportOptions) -> Taken:
    """Return an export of a painting; several files come in one archive. Raises InputError as `exported`."""
    export = exported(read_paintable(painting).painting, options)
    if len(export.files) == 1:
        return Taken(f"{name}.{options.format}", export.files[0].text.encode(), export.notes)
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as zipped:
        for number, file in enumerate(export.files, start=1):
            zipped.writestr(f"{name}-{number}.{options.format}", file.text)
        pens = "".join(f"{name}-{n}.{options.format}: {file.pens}\n" for n, file in enumerate(export.files, start=1))
        zipped.writestr("pens.txt", pens)
    return Taken(f"{name}-{options.format}.zip", archive.getvalue(), export.notes)


def export_picture(painting: Path, name: str, px: int | None) -> Taken:
    """Return a PNG that many pixels high, or where `px` is None, a PDF of the painting at its true size.

    Raises InputError as `preview_of_height`.
    """
    from maulstick.rendering.preview import preview_of_height  # loads torch

    plan = read_paintable(painting).painting
    if px is not None:
        return Taken(f"{name}.png", encode_png(preview_of_height(plan, px)))
    height = round(plan.sheet.height / _INCH * _PRINT)
    pdf = io.BytesIO()
    with Image.open(io.BytesIO(encode_png(preview_of_height(plan, height)))) as picture:
        picture.save(pdf, "PDF", resolution=height / plan.sheet.height * _INCH)
    return Taken(f"{name}.pdf", pdf.getvalue())
