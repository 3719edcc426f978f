"""``maulstick brush show``: a picture of a brush."""

from pathlib import Path
from typing import Annotated

import typer

from maulstick.cli.show import check_picture
from maulstick.painting.brush import load_brush
from maulstick.storage.files import atomic_write


def show(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Of a brush, or its JSON.")],
    px: Annotated[int, typer.Option(metavar="N", help="Height of the picture, in pixels.")] = 1024,
    out: Annotated[Path | None, typer.Option(metavar="FILE", show_default="NAME.png here", help="The PNG.")] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", metavar="", help="Replace a picture that is there.")
    ] = False,
) -> None:
    """Draw a brush: its mark, its width over pressure, the profile across it, and its numbers."""
    called = Path(name).stem
    path = out or Path(f"{called}.png")
    check_picture(path, px, overwrite)
    brush = load_brush(name)
    from maulstick.plots.brush import brush_plot  # loads torch

    atomic_write(path, brush_plot(brush, called, px))
    print(path, flush=True)
