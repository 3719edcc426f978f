"""Results of planning: files, all together or none, and what is said of a painting that was planned."""

import io
from pathlib import Path
from typing import Final

from maulstick.colour.palette import swatches
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import write_painting
from maulstick.painting.picture import encode_png
from maulstick.painting.raster import Canvas
from maulstick.painting.svg import painting_svg
from maulstick.painting.video import FORMATS, Video
from maulstick.rendering.preview import preview
from maulstick.storage.files import atomic_write
from maulstick.storage.folders import all_or_nothing

RESULTS: Final = (
    "painting.json",
    "painting.svg",
    "preview.png",
    "palette.png",
    *(f"progress.{kind}" for kind in FORMATS),
)
"""Names of all files that planning may write."""

_PREVIEW_PX = 1024  # height of the preview: fills a screen
_WIDEST_PX = 4096  # largest width of the preview, for sheets that are much wider than high


def notes_on(painting: Painting) -> list[str]:
    """Return sentences for people on a painting that was planned, and is other than they expect."""
    if painting.strokes:
        return []
    return [
        "no stroke is left, for none brings the sheet nearer to what is asked for; take inks or paints that show on "
        "its paper, a picture that it does not show yet, or more or larger strokes"
    ]


def write_results(painting: Painting, out: Path, video: Video | None) -> list[str]:
    """Write all files, and return their names. A video of an earlier plan is removed: it does not show this one."""
    with all_or_nothing(out) as folder:
        write_painting(painting, folder / "painting.json")
        atomic_write(folder / "painting.svg", painting_svg(painting).encode())
        atomic_write(folder / "preview.png", _preview(painting))
        atomic_write(folder / "palette.png", _palette(painting))
        if video is not None:
            atomic_write(folder / f"progress.{video.kind}", video.encode())
        names = sorted(path.name for path in folder.iterdir())
    for kind in FORMATS:
        if (older := f"progress.{kind}") not in names:
            (out / older).unlink(missing_ok=True)
    return names


def _preview(painting: Painting) -> bytes:
    width, height = painting.sheet.width, painting.sheet.height
    return encode_png(preview(painting, Canvas(width, height, min(_PREVIEW_PX / height, _WIDEST_PX / width))))


def _palette(painting: Painting) -> bytes:
    colours = painting.colours()
    labels = [f"{i}   {paint.label}   {metres:.2f} m" for i, (paint, metres) in enumerate(colours, start=1)]
    file = io.BytesIO()
    swatches([paint.colour for paint, _ in colours], labels).save(file, format="PNG")
    return file.getvalue()
