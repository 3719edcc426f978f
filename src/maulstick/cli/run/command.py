"""The words of ``maulstick run``."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from maulstick.errors import InputError

if TYPE_CHECKING:
    from maulstick.cli.run.eyes import Watching

_MOST_SPEED = 10_000


class Unfinished(StrEnum):
    """What became of the stroke that was under the brush when an earlier run was cut off."""

    PAINTED = "painted"
    AGAIN = "again"


def run(
    painting: Annotated[Path, typer.Argument(help="The painting.json to paint.")],
    robot: Annotated[
        str,
        typer.Option(metavar="MACHINE", help="sim, sim:real, grbl:/dev/ttyUSB0, axidraw, xarm:IP, franka:IP or ur:IP."),
    ] = "sim",
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
    tag: Annotated[float, typer.Option(metavar="MM", help="With --replan: the side of the tags' black squares.")] = 20,
    dry_run: Annotated[bool, typer.Option("--dry-run", metavar="", help="Do everything but move.")] = False,
    from_stroke: Annotated[
        int | None, typer.Option(metavar="N", help="Begin with the Nth stroke; those before count as painted.")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", metavar="", help="Go on where an earlier run ended.")] = False,
    unfinished: Annotated[
        Unfinished | None,
        typer.Option(metavar="painted|again", help="With --resume: what became of the stroke under the brush."),
    ] = None,
    anew: Annotated[
        bool, typer.Option("--anew", metavar="", help="Start again on a new sheet; the old journal is kept.")
    ] = False,
) -> None:
    """Let a machine paint a painting.

    Every stroke is written into a journal beside the painting, before it and after it, so that --resume goes on after
    Ctrl-C, a lost cable or a power cut. Space pauses after a stroke; s or Ctrl-C stops at once and lifts the pen.
    """
    if speed is not None and not 0 < speed <= _MOST_SPEED:
        raise InputError.of_range("--speed", f"{speed:g}", f"above 0 and at most {_MOST_SPEED} mm/s")
    if resume and (anew or from_stroke is not None):
        raise InputError("--resume knows where to go on; leave out --anew and --from-stroke")
    if unfinished is not None and not resume:
        raise InputError("--unfinished is about the stroke that an earlier run began; it goes with --resume")
    watching = _watching(robot, replan, camera, picture, tag)
    from maulstick.cli.run.job import Job, paint

    paint(
        Job(
            painting=painting,
            robot=robot,
            easel=easel,
            tray=tray,
            speed=None if speed is None else speed * 1e-3,
            watching=watching,
            dry_run=dry_run,
            from_stroke=from_stroke,
            resume=resume,
            unfinished=None if unfinished is None else unfinished is Unfinished.PAINTED,
            anew=anew,
        )
    )


def _watching(robot: str, every: int | None, camera: str | None, picture: Path | None, tag: float) -> "Watching | None":
    if every is None:
        if camera is not None or picture is not None:
            raise InputError("--camera and --picture are for --replan; add it, or leave them out")
        return None
    if every < 1:
        raise InputError.of_range("--replan", every, "at least 1 stroke")
    if picture is None:
        raise InputError("--replan goes by the picture that the painting is of; name it with --picture")
    if camera is None and not robot.startswith("sim"):
        raise InputError("--replan needs a camera over the sheet; name it with --camera usb:0, or folder:PATH")
    from maulstick.cli.run.eyes import Watching

    return Watching(camera or "sim", every, picture, tag * 1e-3)
