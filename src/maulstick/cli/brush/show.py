"""``maulstick brush show``: draws a picture of a brush."""

from pathlib import Path
from typing import Annotated

import typer

from maulstick.cli.show import check_picture
from maulstick.painting.brush import load_brush
from maulstick.storage.files import atomic_write


def show(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of a brush, or its JSON file.")],
    px: Annotated[int, typer.Option(metavar="N", help="Height of the picture in pixels.")] = 1024,
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", show_default="NAME.png here", help="The PNG file to write.")
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", metavar="", help="Replace an earlier picture.")] = False,
) -> None:
    """Draw a brush: its mark, its width over pressure, the profile across it, and its numbers.

    Example: maulstick brush show marker --out marker.png
    """
    called = Path(name).stem
    path = out or Path(f"{called}.png")
    check_picture(path, px, overwrite)
    brush = load_brush(name)
    from maulstick.plots.brush import brush_plot  # loads torch

    atomic_write(path, brush_plot(brush, called, px))
    print(path, flush=True)
