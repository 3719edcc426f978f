"""``maulstick show``: a picture of whatever Maulstick has written."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from maulstick.cli.folder import check_absent
from maulstick.errors import InputError
from maulstick.storage.arrays import kind_of
from maulstick.storage.files import atomic_write, read_whole

_SMALLEST_PX, _LARGEST_PX = 240, 2400
_WIDEST_PX = 8192  # widest picture, pixels, which bounds memory
_LARGEST_FILE = 256 * 2**20  # bytes: a larger file is refused before it is read into memory


def show(
    file: Annotated[Path, typer.Argument(help="Ink, strokes, a style, a brush or a painting: NAME.npz or NAME.json.")],
    px: Annotated[int, typer.Option(metavar="N", help="Height of the picture, in pixels.")] = 1024,
    out: Annotated[Path | None, typer.Option(metavar="FILE", help="The PNG; by default beside the file.")] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", metavar="", help="Replace a picture that is there.")
    ] = False,
) -> None:
    """Draw a picture of ink, strokes, a style, a brush or a painting."""
    path = out or file.with_name(f"{file.stem}-{px}px.png")
    check_picture(path, px, overwrite)
    kind = _kind(file)
    atomic_write(path, _PICTURES[kind](file, px))
    print(path, flush=True)


def check_picture(path: Path, px: int, overwrite: bool) -> None:
    """Raise InputError where there can be no such picture, and OutputError where what is at `path` would be lost."""
    if path.suffix.lower() != ".png":
        raise InputError(f"--out is {path}; a picture is written as PNG, so let its name end in .png")
    if not _SMALLEST_PX <= px <= _LARGEST_PX:
        raise InputError.of_range("--px", px, f"from {_SMALLEST_PX} to {_LARGEST_PX}")
    check_absent(path, "--out", overwrite)


def kind_in(file: Path) -> str | None:
    """Which of the things that Maulstick writes seems to be in the file, if any."""
    kind = kind_of(file)
    return _kind_of_json(file) if kind is None and file.suffix.lower() == ".json" else kind


def _kind(file: Path) -> str:
    """Which of the things that have a picture is in the file."""
    kind = kind_in(file)
    if kind not in _PICTURES:
        raise InputError(
            f"{file} is none of what can be shown: {', '.join(sorted(_PICTURES))}; "
            "where it is another program's drawing, make ink of it with maulstick record ink"
        )
    return kind


def _kind_of_json(file: Path) -> str | None:
    """A painting by its paints, a brush by its alpha, a style by its arrays' sum; their readers say if all is well."""
    content = read_whole(file, "file", _LARGEST_FILE)
    signs = {"painting": b'"paints"', "brush": b'"alpha"', "style": b'"sha256"'}
    return next((kind for kind, sign in signs.items() if sign in content), None)


def _ink(file: Path, px: int) -> bytes:
    from maulstick.plots.ink import ink_plot
    from maulstick.strokes.ink import read_ink

    return ink_plot(read_ink(file), file.name, px)


def _strokes(file: Path, px: int) -> bytes:
    from maulstick.plots.strokes import strokes_plot
    from maulstick.strokes.strokes import read_strokes

    return strokes_plot(read_strokes(file), file.name, px)


def _style(file: Path, px: int) -> bytes:
    from maulstick.plots.style import style_plot  # loads torch
    from maulstick.style.store import read_style

    return style_plot(read_style(file), file.name, px)


def _brush(file: Path, px: int) -> bytes:
    from maulstick.painting.brush import load_brush
    from maulstick.plots.brush import brush_plot  # loads torch

    return brush_plot(load_brush(str(file)), file.name, px)


def _painting(file: Path, px: int) -> bytes:
    from maulstick.painting.painting import read_painting
    from maulstick.painting.picture import encode_png
    from maulstick.painting.raster import Canvas

    plan = read_painting(file)
    canvas = Canvas.of_height((plan.sheet.width, plan.sheet.height), px)
    if canvas.width_px > _WIDEST_PX:
        raise InputError(f"the picture would be {canvas.width_px} pixels wide; choose a smaller --px")
    from maulstick.rendering.preview import preview  # loads torch

    return encode_png(preview(plan, canvas))


_PICTURES: dict[str, Callable[[Path, int], bytes]] = {
    "ink": _ink,
    "strokes": _strokes,
    "style": _style,
    "brush": _brush,
    "painting": _painting,
}
