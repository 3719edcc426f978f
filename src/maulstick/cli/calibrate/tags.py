"""``maulstick calibrate tags``: draws the tags by which a camera finds the sheet."""

from pathlib import Path
from typing import Annotated

import typer

from maulstick.cli.folder import check_place
from maulstick.cli.lengths import metres
from maulstick.painting.raster import parse_size


def tags(
    size: Annotated[str, typer.Option(metavar="SIZE", help="Size of the sheet: 200x160mm, A4-landscape.")],
    tag: Annotated[str, typer.Option(metavar="MM", help="Side of the black squares of the tags.")] = "20",
    page: Annotated[str, typer.Option(metavar="SIZE", help="Size of the paper to print on.")] = "A4",
    out: Annotated[
        Path, typer.Option(metavar="FILE", help="PDF or PNG file to write, to print at its true size.")
    ] = Path("tags.pdf"),
    overwrite: Annotated[bool, typer.Option("--overwrite", metavar="", help="Replace an earlier file.")] = False,
) -> None:
    """Draw four tags to print and to fix beside the corners of the sheet.

    Example: maulstick calibrate tags --size 200x160mm --out tags.pdf
    """
    width, height = parse_size(size)
    check_place(out, "--out", overwrite)
    from maulstick.calibration.tag_page import write_tag_page
    from maulstick.robot.camera.tag_frame import TagFrame

    write_tag_page(out, TagFrame(width, height, side=metres(tag, "--tag")), parse_size(page))
    print(out, flush=True)
