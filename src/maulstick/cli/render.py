"""``maulstick render``: draws a painting as an image of any size."""

from pathlib import Path
from typing import Annotated

import typer

from maulstick.cli.drawing import (
    Hatch,
    HatchHand,
    Join,
    KeepOrder,
    Margin,
    NoRepeats,
    Rotate,
    Shortest,
    Size,
    drawing_options,
    read_plan,
)
from maulstick.cli.folder import check_place
from maulstick.errors import InputError
from maulstick.painting.picture import encode_png
from maulstick.storage.files import atomic_write


def render(
    painting: Annotated[Path, typer.Argument(help="The painting.json, or SVG, to draw.")],
    px: Annotated[int, typer.Option(metavar="N", help="Height of the image in pixels.")] = 1024,
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", show_default="beside the painting", help="The PNG file to write.")
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", metavar="", help="Replace an earlier image.")] = False,
    size: Size = None,
    margin: Margin = None,
    rotate: Rotate = "0",
    hatch: Hatch = None,
    hatch_hand: HatchHand = None,
    no_repeats: NoRepeats = False,
    join: Join = None,
    shortest: Shortest = None,
    keep_order: KeepOrder = False,
) -> None:
    """Draw a painting, or an SVG as a pen would draw it, as an image of any size.

    Example: maulstick render cat/painting.json --px 3000
    """
    path = out or painting.parent / f"{painting.stem}-{px}px.png"
    if path.suffix.lower() != ".png":
        raise InputError(f"--out is {path}; an image is written as PNG, so let its name end in .png")
    check_place(path, "--out", overwrite)
    plan = read_plan(
        painting, drawing_options(size, margin, rotate, hatch, hatch_hand, no_repeats, join, shortest, keep_order)
    )
    from maulstick.rendering.preview import preview_of_height  # loads torch

    atomic_write(path, encode_png(preview_of_height(plan, px)))
    print(path, flush=True)
