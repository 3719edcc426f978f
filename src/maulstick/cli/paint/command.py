"""The words of ``maulstick paint``."""

from pathlib import Path
from typing import Annotated

import typer

from maulstick.errors import InputError
from maulstick.robot.machines import SPECS

UNFINISHED = {"painted": True, "again": False}
"""What became of the stroke that was under the brush when an earlier run was cut off: whether it is painted."""


def run(
    painting: Annotated[Path, typer.Argument(help="The painting.json to paint.")],
    robot: Annotated[str | None, typer.Option(metavar="MACHINE", show_default="sim", help=f"{SPECS}.")] = None,
    easel: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Where the sheet lies, from maulstick calibrate touch; arms need it."),
    ] = None,
    tray: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Wells, water and cloth, for a brush that is to be dipped.")
    ] = None,
    speed: Annotated[
        float | None,
        typer.Option(metavar="MM/S", show_default="the hand's, or the machine's", help="Draw no faster than this."),
    ] = None,
    replan: Annotated[
        int | None, typer.Option(metavar="N", help="Look after every N strokes, and plan again what is left.")
    ] = None,
    camera: Annotated[
        str | None,
        typer.Option(
            metavar="CAMERA", show_default="the easel's, with sim", help="With --replan: usb:0, or folder:PATH."
        ),
    ] = None,
    picture: Annotated[
        Path | None, typer.Option(metavar="PICTURE", help="With --replan: the picture that the painting is of.")
    ] = None,
    view: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="With --replan, without tags: from maulstick calibrate camera --keep."),
    ] = None,
    tag: Annotated[
        float | None,
        typer.Option(metavar="MM", show_default="20", help="With --replan: the side of the tags' black squares."),
    ] = None,
    colours: Annotated[
        Path | None, typer.Option(metavar="FILE", help="With --replan: from maulstick calibrate colours, of a chart.")
    ] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", metavar="", help="Do everything but move.")] = False,
    from_stroke: Annotated[
        int | None, typer.Option(metavar="N", help="Begin with the Nth stroke; those before count as painted.")
    ] = None,
    resume: Annotated[
        bool,
        typer.Option("--resume", metavar="", help="Go on where an earlier run ended, with what was asked then."),
    ] = False,
    unfinished: Annotated[
        str | None,
        typer.Option(metavar="painted|again", help="With --resume: what became of the stroke under the brush."),
    ] = None,
    restart: Annotated[
        bool, typer.Option("--restart", metavar="", help="Start again on a new sheet; the old journal is kept.")
    ] = False,
) -> None:
    """Let a machine paint a painting.

    Every stroke is written into a journal beside the painting, before it and after it, so that --resume goes on after
    Ctrl-C, a lost cable or a power cut. Space pauses after a stroke; s or Ctrl-C stops at once and lifts the pen.
    """
    if resume and (restart or from_stroke is not None):
        raise InputError("--resume knows where to go on; leave out --restart and --from-stroke")
    if unfinished is not None and not resume:
        raise InputError("--unfinished is about the stroke that an earlier run began; it goes with --resume")
    if unfinished is not None and unfinished not in UNFINISHED:
        raise InputError.of_choice("answer to --unfinished", unfinished, UNFINISHED)
    from maulstick.cli.paint.run import Job, paint
    from maulstick.jobs.paint.options import PaintOptions
    from maulstick.jobs.paint.session import PaintRequest

    words = {
        "robot": robot,
        "easel": easel,
        "tray": tray,
        "speed": None if speed is None else speed * 1e-3,
        "replan": replan,
        "look": None if replan is None else False,
        "camera": camera,
        "picture": picture,
        "view": view,
        "tag": None if tag is None else tag * 1e-3,
        "colours": colours,
    }
    options = PaintOptions.model_validate({name: word for name, word in words.items() if word is not None})
    options.check()
    answer = None if unfinished is None else UNFINISHED[unfinished]
    paint(Job(PaintRequest(painting, options, from_stroke, resume, restart), dry_run, answer))
