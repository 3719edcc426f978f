"""Options of ``maulstick paint``."""

from functools import partial
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
)
from maulstick.cli.lengths import metres
from maulstick.errors import InputError
from maulstick.robot.machines import SPECS

UNFINISHED = {"painted": True, "again": False}
"""What became of the stroke that was under the brush when an earlier run was cut off: whether it is painted."""

_machine = partial(typer.Option, rich_help_panel="The machine")
_camera = partial(typer.Option, rich_help_panel="Looking at the sheet on the way")
_stops = partial(typer.Option, rich_help_panel="Stops on the way")
_progress = partial(typer.Option, rich_help_panel="Where to begin")


def paint(
    painting: Annotated[Path, typer.Argument(metavar="PAINTING", help="The painting.json, or SVG, to paint.")],
    robot: Annotated[
        str | None, _machine(metavar="MACHINE", show_default="sim", help=f"The machine that paints: {SPECS}.")
    ] = None,
    easel: Annotated[
        Path | None,
        _machine(metavar="FILE", help="Place of the sheet, from `maulstick calibrate touch`. Arms need it."),
    ] = None,
    tray: Annotated[
        Path | None, _machine(metavar="FILE", help="Places of paint wells, water and cloth, for a dipped brush.")
    ] = None,
    pen: Annotated[
        str | None,
        _machine(
            metavar="PEN",
            show_default="as planned",
            help="Pen that draws, from the catalogue: see `maulstick brush pens`.",
        ),
    ] = None,
    speed: Annotated[
        float | None,
        _machine(metavar="MM/S", show_default="the hand's, or the machine's", help="Speed of drawing, at most."),
    ] = None,
    pause_at: Annotated[
        list[int] | None, _stops(metavar="N", help="Pause before the Nth stroke; may be given several times.")
    ] = None,
    refill_after: Annotated[
        str | None,
        _stops(metavar="20m|5min", help="Metres or minutes of drawing, after which you refill or clean the pen."),
    ] = None,
    refill_at: Annotated[
        str | None,
        _stops(
            metavar="X,Y",
            show_default="where it is",
            help="Place of the pen while you do, in mm from the sheet's upper left corner.",
        ),
    ] = None,
    copies: Annotated[
        int | None, _stops(metavar="N", show_default="1", help="Number of sheets. You put in the next one.")
    ] = None,
    dry_run: Annotated[bool, _machine("--dry-run", metavar="", help="Check everything, and move nothing.")] = False,
    replan: Annotated[
        int | None, _camera(metavar="N", help="Photograph the sheet after every N strokes, and plan the rest again.")
    ] = None,
    camera: Annotated[
        str | None,
        _camera(metavar="CAMERA", show_default="the easel's, with sim", help="The camera: usb:0, or folder:PATH."),
    ] = None,
    picture: Annotated[Path | None, _camera(metavar="PICTURE", help="The picture that was planned.")] = None,
    view: Annotated[
        Path | None,
        _camera(metavar="FILE", help="The camera's view, from `maulstick calibrate camera --keep`, instead of tags."),
    ] = None,
    tag: Annotated[
        str | None, _camera(metavar="MM", show_default="20", help="Side of the black squares of the tags.")
    ] = None,
    colours: Annotated[
        Path | None, _camera(metavar="FILE", help="The camera's colours, from `maulstick calibrate colours`.")
    ] = None,
    size: Size = None,
    margin: Margin = None,
    rotate: Rotate = "0",
    hatch: Hatch = None,
    hatch_hand: HatchHand = None,
    no_repeats: NoRepeats = False,
    join: Join = None,
    shortest: Shortest = None,
    keep_order: KeepOrder = False,
    from_stroke: Annotated[
        int | None, _progress(metavar="N", help="Begin with the Nth stroke. Those before count as painted.")
    ] = None,
    from_pen: Annotated[
        int | None,
        _progress(metavar="K", help="Begin where the Kth pen is put in. Strokes before count as painted."),
    ] = None,
    resume: Annotated[
        bool, _progress("--resume", metavar="", help="Go on where an earlier run ended, with the same options.")
    ] = False,
    unfinished: Annotated[
        str | None,
        _progress(metavar="painted|again", help="State of the stroke that was under the brush, with --resume."),
    ] = None,
    restart: Annotated[
        bool, _progress("--restart", metavar="", help="Start again on a new sheet. The old journal is kept.")
    ] = False,
) -> None:
    """Let a machine paint a painting, or draw an SVG.

    Every stroke is written into a journal beside the painting, before it and after it, so that --resume goes on after
    Ctrl-C, a lost cable or a power cut. Space pauses after a stroke; s or Ctrl-C stops at once and lifts the pen; +
    draws faster, and - slower.

    Example: maulstick paint cat/painting.json --robot grbl:/dev/ttyUSB0 --speed 40

    Example: maulstick paint drawing.svg --robot axidraw --size A4 --margin 10
    """
    if unfinished is not None and not resume:
        raise InputError("--unfinished is about the stroke that an earlier run began; it goes with --resume")
    if unfinished is not None and unfinished not in UNFINISHED:
        raise InputError.of_choice("answer to --unfinished", unfinished, UNFINISHED)
    from maulstick.cli.paint.run import Run, run
    from maulstick.jobs.paint.options import PaintOptions
    from maulstick.jobs.paint.request import PaintRequest

    given = {
        "robot": robot,
        "easel": easel,
        "tray": tray,
        "speed": None if speed is None else speed * 1e-3,
        "replan": replan,
        "look": None if replan is None else False,
        "camera": camera,
        "picture": picture,
        "view": view,
        "tag": None if tag is None else metres(tag, "--tag"),
        "colours": colours,
        "drawing": drawing_options(size, margin, rotate, hatch, hatch_hand, no_repeats, join, shortest, keep_order),
        "pen": pen,
        "pause_at": tuple(pause_at) if pause_at else None,
        "refill_after": refill_after,
        "refill_at": None if refill_at is None else _place(refill_at),
        "copies": copies,
    }
    options = PaintOptions.model_validate({name: value for name, value in given.items() if value is not None})
    options.check()
    answer = None if unfinished is None else UNFINISHED[unfinished]
    run(Run(PaintRequest(painting, options, from_stroke, resume, restart, from_pen=from_pen), dry_run, answer))


def _place(text: str) -> tuple[float, float]:
    """Return x and y, metres, of a place in millimetres. Raises InputError where the text is none."""
    try:
        x, y = (1e-3 * float(number) for number in text.split(","))
    except ValueError:
        raise InputError(f"--refill-at is {text!r}; it must be two numbers in mm, as in 20,50") from None
    return x, y
