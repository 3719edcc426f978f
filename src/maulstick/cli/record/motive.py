"""``maulstick record motive``: reads a take of OptiTrack's Motive, and writes its ink."""

from pathlib import Path
from typing import Annotated

import typer

from maulstick.cli.record import options
from maulstick.cli.record.writing import check_outs, write_drawing
from maulstick.storage.folders import made_folder


def motive(
    take: Annotated[
        Path, typer.Argument(help="The take: CSV with its header, rigid bodies and markers, or NAME.take.npz.")
    ],
    pen_length: options.PenLength = None,
    pen_axis: options.PenAxis = None,
    pivot: options.PivotTake = None,
    pen: options.Pen = None,
    sheet: options.Board = None,
    corner: options.Corner = "upper-left",
    threshold: options.Threshold = None,
    merge: options.Merge = options.MERGE,
    shortest: options.Shortest = options.SHORTEST,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            show_default="TAKE.ink.npz here",
            rich_help_panel=options.WRITING,
            help=options.OUT,
        ),
    ] = None,
    plot: options.Plot = None,
    overwrite: options.Overwrite = False,
) -> None:
    """Find the strokes in a motion-capture take of a pen and a sheet.

    The sheet has a marker at three of its corners, and the pen is a rigid body. Writes the ink, and a plot of the
    tip's height over time with the strokes marked in it. Where they are wrong, read a threshold from the plot.

    Example: maulstick record motive take.csv --pen-length 139mm --out me.ink.npz
    """
    name = take.name.replace(".take.npz", ".npz")  # of a live take
    out = out or Path(f"{Path(name).stem}.ink.npz")
    contact = options.contact_options(threshold, merge, shortest)
    plot = check_outs(out, plot, overwrite)
    from maulstick.recording.mocap.drawing import drawing_of  # these load pandas and scipy
    from maulstick.recording.mocap.frames import check_corner
    from maulstick.recording.mocap.motive import read_motive

    check_corner(corner)
    with made_folder(out.parent), made_folder(plot.parent):  # before an hour is read
        tip, how = options.tip_of(pen_length, pen_axis, pivot, pen, sheet)
        drawing = drawing_of(read_motive(take, pen, sheet), tip, contact, corner, take.name)
        print(how)
        write_drawing(drawing, out, plot, overwrite)
