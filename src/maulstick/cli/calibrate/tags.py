"""``maulstick calibrate tags``: the cards that tell a camera where the sheet lies."""

from pathlib import Path
from typing import Annotated

import typer

from maulstick.cli.folder import check_absent
from maulstick.painting.raster import parse_size


def tags(
    size: Annotated[str, typer.Option(metavar="SIZE", help="Of the sheet: 200x160mm, A4-landscape.")],
    tag: Annotated[float, typer.Option(metavar="MM", help="The side of a tag's black square.")] = 20,
    page: Annotated[str, typer.Option(metavar="SIZE", help="Of the paper to print on.")] = "A4",
    out: Annotated[Path, typer.Option(metavar="FILE", help="A PDF or a PNG, which prints at its true size.")] = Path(
        "tags.pdf"
    ),
    overwrite: Annotated[bool, typer.Option("--overwrite", metavar="", help="Replace a file that is there.")] = False,
) -> None:
    """Draw the four tags to print and fix beside the sheet's corners."""
    width, height = parse_size(size)
    check_absent(out, "--out", overwrite)
    from maulstick.calibration.tag_page import write_tag_page
    from maulstick.robot.camera.tag_frame import TagFrame

    write_tag_page(out, TagFrame(width, height, side=tag * 1e-3), parse_size(page))
    print(out, flush=True)
