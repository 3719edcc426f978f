"""``maulstick show``: draws a picture of a file that Maulstick has written."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from maulstick.cli.drawing import read_plan
from maulstick.cli.folder import check_place
from maulstick.errors import InputError
from maulstick.jobs.paintable import is_svg
from maulstick.storage.arrays import kind_of
from maulstick.storage.files import atomic_write, read_whole

_SMALLEST_PX, _LARGEST_PX = 240, 2400  # pixels: texts in a plot cannot be read below, and fill memory above
_LARGEST_FILE = 256 * 2**20  # bytes: more than any file of ours has


def show(
    file: Annotated[Path, typer.Argument(help="File with ink, strokes, a style, a brush or a painting, or an SVG.")],
    px: Annotated[int, typer.Option(metavar="N", help="Height of the picture in pixels.")] = 1024,
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", show_default="beside the file", help="The PNG file to write.")
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", metavar="", help="Replace an earlier picture.")] = False,
) -> None:
    """Draw a picture of ink, strokes, a style, a brush, a painting or an SVG.

    Example: maulstick show me.ink.npz --out me.png
    """
    path = out or file.parent / f"{file.stem}-{px}px.png"
    check_picture(path, px, overwrite)
    kind = _kind(file)
    atomic_write(path, _PICTURES[kind](file, px))
    print(path, flush=True)


def check_picture(path: Path, px: int, overwrite: bool) -> None:
    """Raise InputError where no such picture can be drawn, and OutputError where the file at `path` would be lost."""
    if path.suffix.lower() != ".png":
        raise InputError(f"--out is {path}; a picture is written as PNG, so let its name end in .png")
    if not _SMALLEST_PX <= px <= _LARGEST_PX:
        raise InputError.of_range("--px", px, f"from {_SMALLEST_PX} to {_LARGEST_PX}")
    check_place(path, "--out", overwrite)


def kind_in(file: Path) -> str | None:
    """Return the kind of content that a file of Maulstick seems to have, such as ``ink``; None for other files."""
    kind = kind_of(file)
    return _kind_of_json(file) if kind is None and file.suffix.lower() == ".json" else kind


def _kind(file: Path) -> str:
    """Return the kind of content of a file. Raises InputError where there is no picture of it."""
    kind = "svg" if is_svg(file) else kind_in(file)
    if kind not in _PICTURES:
        raise InputError(
            f"{file} is none of what can be shown: {', '.join(sorted(_PICTURES))}; "
            "where it is another program's drawing, make ink of it with maulstick record ink"
        )
    return kind


def _kind_of_json(file: Path) -> str | None:
    """Return the kind of a JSON file by one of its field names; its reader checks the rest."""
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
    from maulstick.painting.picture import encode_png

    plan = read_plan(file, None)
    from maulstick.rendering.preview import preview_of_height  # loads torch

    return encode_png(preview_of_height(plan, px))


_PICTURES: dict[str, Callable[[Path, int], bytes]] = {
    "ink": _ink,
    "strokes": _strokes,
    "style": _style,
    "brush": _brush,
    "painting": _painting,
    "svg": _painting,
}
