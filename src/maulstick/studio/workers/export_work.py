"""Files of a painting that people take elsewhere: for other machines, for the screen, and for print."""

import io
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

from maulstick.jobs.export import ExportOptions, exported
from maulstick.jobs.paintable import read_paintable
from maulstick.painting.picture import encode_png
from maulstick.painting.raster import Canvas
from maulstick.painting.video import FRAMES_PER_SECOND, LARGEST, Video

_PRINT = 300  # pixels per inch, as printers ask for
_INCH = 0.0254  # metres
_LARGEST_GIF = (640, 480)  # pixels: larger ones take long to encode, and tens of megabytes


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


def export_film(painting: Path, name: str, kind: str, seconds: int) -> Taken:
    """Return a film of a painting, on which its strokes come one after the other.

    kind: of `painting.video.FORMATS`.  seconds: until the last stroke; the whole painting then stays for two more.
    Raises InputError where that kind cannot be written here.
    """
    from maulstick.rendering.preview import growing  # loads torch

    video, plan = Video(kind), read_paintable(painting).painting
    width, height = plan.sheet.width, plan.sheet.height
    most_wide, most_high = _LARGEST_GIF if kind == "gif" else LARGEST
    canvas = Canvas(width, height, min(most_wide / width, most_high / height))
    ends = np.linspace(0, len(plan.strokes), FRAMES_PER_SECOND * seconds).round().astype(int)
    for frame in growing(plan, canvas, ends.tolist()):
        video.add(frame)
    return Taken(f"{name}.{kind}", video.encode())
