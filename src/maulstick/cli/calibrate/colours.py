"""``maulstick calibrate colours``: measures how the light and the camera change colours."""

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from maulstick.cli.calibrate.camera import four_points
from maulstick.cli.folder import check_other, check_place
from maulstick.cli.lengths import metres
from maulstick.colour.palette import parse_colour
from maulstick.errors import InputError
from maulstick.painting.picture import read_picture
from maulstick.painting.raster import flat_canvas, parse_size

_sheet = partial(typer.Option, rich_help_panel="The sheet")
_truth = partial(typer.Option, rich_help_panel="True colours")
_writing = partial(typer.Option, rich_help_panel="What is written")


def colours(
    bare: Annotated[Path, typer.Argument(help="Photograph of the bare sheet with its tags.")],
    size: Annotated[str, _sheet(metavar="SIZE", help="Size of the sheet: 200x160mm, A4-landscape.")],
    chart: Annotated[
        Path | None,
        _truth(metavar="PHOTO", help="Photograph with a colour chart of 24 patches on the sheet."),
    ] = None,
    patches: Annotated[
        str | None,
        _truth(
            metavar="X,Y X,Y X,Y X,Y",
            help="Middles of the patches dark skin, bluish green, black and white, in mm on the sheet.",
        ),
    ] = None,
    grey: Annotated[
        Path | None, _truth(metavar="PHOTO", help="Photograph with a grey card over the middle of the sheet.")
    ] = None,
    paper: Annotated[str, _sheet(metavar="COLOUR", help="Colour of the sheet: white, or #rrggbb.")] = "white",
    tag: Annotated[str, _sheet(metavar="MM", help="Side of the black squares of the tags.")] = "20",
    out: Annotated[Path, _writing(metavar="FILE", help="File to write.")] = Path("colours.json"),
    overwrite: Annotated[bool, _writing("--overwrite", metavar="", help="Replace an earlier file.")] = False,
) -> None:
    """Measure the light by a bare sheet, and the camera's colours by a chart or a grey card.

    Example: maulstick calibrate colours bare.jpg --size 200x160mm --grey card.jpg --out colours.json
    """
    if chart is not None and grey is not None:
        raise InputError("--chart tells all that --grey does; leave one of them out")
    if (chart is None) != (patches is None):
        raise InputError("--chart needs --patches, and the other way round: where on the sheet the chart lies")
    sheet, canvas = parse_size(size), flat_canvas(*parse_size(size))
    check_other(out, "--out", {"the photograph": bare, "that of --chart": chart, "that of --grey": grey})
    check_place(out, "--out", overwrite)
    from maulstick.calibration.camera import locate
    from maulstick.calibration.chart import with_chart, with_grey_card
    from maulstick.calibration.colour import lamp_of, whites_of, write_colours
    from maulstick.robot.camera.tag_frame import TagFrame

    frame = TagFrame(*sheet, side=metres(tag, "--tag"))
    photo = read_picture(bare)
    view = locate(photo, frame)
    found = lamp_of(view.rectify(photo, canvas), whites_of(photo, view, frame), parse_colour(paper))
    if (other := chart or grey) is not None:
        photo = read_picture(other)
        view = locate(photo, frame)
        flat, whites = view.rectify(photo, canvas), whites_of(photo, view, frame)
        if patches is not None:
            found, errors = with_chart(found, flat, whites, canvas, 1e-3 * four_points(patches, "--patches"))
            print(errors, flush=True)
        else:
            width, height = sheet
            found = with_grey_card(found, flat, whites, canvas, (width / 3, height / 3, width / 3, height / 3))
    write_colours(found.with_sheet(sheet), out)
    print(out, flush=True)
