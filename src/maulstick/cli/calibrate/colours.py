"""``maulstick calibrate colours``: what the lamp and the camera do to colours."""

from pathlib import Path
from typing import Annotated

import typer

from maulstick.cli.calibrate.camera import four_points
from maulstick.cli.folder import check_absent
from maulstick.colour.palette import parse_colour
from maulstick.errors import InputError
from maulstick.painting.picture import read_picture
from maulstick.painting.raster import flat_canvas, parse_size


def colours(
    bare: Annotated[Path, typer.Argument(help="A photograph of the bare sheet with its tags.")],
    size: Annotated[str, typer.Option(metavar="SIZE", help="Of the sheet: 200x160mm, A4-landscape.")],
    chart: Annotated[
        Path | None,
        typer.Option(metavar="PHOTO", help="Another, with a chart of 24 patches lying on the sheet."),
    ] = None,
    patches: Annotated[
        str | None,
        typer.Option(
            metavar="X,Y X,Y X,Y X,Y",
            help="Where on the sheet, in mm: the middles of the patches dark skin, bluish green, black and white.",
        ),
    ] = None,
    grey: Annotated[
        Path | None, typer.Option(metavar="PHOTO", help="Another, with a grey card over the middle of the sheet.")
    ] = None,
    paper: Annotated[str, typer.Option(metavar="COLOUR", help="Of the sheet: white, or #rrggbb.")] = "white",
    tag: Annotated[float, typer.Option(metavar="MM", help="The side of the tags' black squares.")] = 20,
    out: Annotated[Path, typer.Option(metavar="FILE", help="Where the colours go.")] = Path("colours.json"),
    overwrite: Annotated[bool, typer.Option("--overwrite", metavar="", help="Replace a file that is there.")] = False,
) -> None:
    """Learn the light from a bare sheet, and true colours from a chart or a grey card."""
    if chart is not None and grey is not None:
        raise InputError("--chart tells all that --grey does; leave one of them out")
    if (chart is None) != (patches is None):
        raise InputError("--chart needs --patches, and the other way round: where on the sheet the chart lies")
    sheet, canvas = parse_size(size), flat_canvas(*parse_size(size))
    check_absent(out, "--out", overwrite)
    from maulstick.calibration.camera import locate
    from maulstick.calibration.chart import with_chart, with_grey_card
    from maulstick.calibration.colour import lamp_of, whites_of, write_colours
    from maulstick.robot.camera.tag_frame import TagFrame

    frame = TagFrame(*sheet, side=tag * 1e-3)
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
    write_colours(found, out)
    print(out, flush=True)
