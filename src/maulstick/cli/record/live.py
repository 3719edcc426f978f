"""``maulstick record live``: records what Motive streams, and writes its ink."""

from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.status import Status

from maulstick.cli.folder import check_absent
from maulstick.cli.progress import stop_on_interrupt
from maulstick.cli.record import options
from maulstick.cli.record.writing import beside, check_outs, write_drawing
from maulstick.errors import InputError, MaulstickError
from maulstick.storage.folders import made_folder
from maulstick.storage.text import counted

if TYPE_CHECKING:
    from collections.abc import Callable

    from maulstick.recording.mocap.natnet import Seen
    from maulstick.recording.mocap.take import Take

_recording = partial(typer.Option, rich_help_panel="The recording")


def live(
    out: Annotated[Path, typer.Option(metavar="FILE", rich_help_panel=options.WRITING, help=options.OUT)],
    server: Annotated[
        str, _recording(metavar="ADDRESS", help="Address of the computer that runs Motive, as in 192.168.1.5.")
    ] = "127.0.0.1",
    local: Annotated[
        str | None,
        _recording(
            metavar="ADDRESS",
            show_default="the one that reaches it",
            help="Address of this computer on the same network.",
        ),
    ] = None,
    multicast: Annotated[
        bool, _recording("--multicast", metavar="", help="Receive a multicast stream instead of a unicast one.")
    ] = False,
    seconds: Annotated[
        float | None, _recording(metavar="N", show_default="until Ctrl-C", help="Seconds to record.")
    ] = None,
    pen_length: options.PenLength = None,
    pen_axis: options.PenAxis = None,
    pivot: options.PivotTake = None,
    pen: options.Pen = None,
    sheet: options.Board = None,
    corner: options.Corner = "upper-left",
    threshold: options.Threshold = None,
    merge: options.Merge = options.MERGE,
    shortest: options.Shortest = options.SHORTEST,
    plot: options.Plot = None,
    overwrite: options.Overwrite = False,
) -> None:
    """Record a pen that OptiTrack's Motive tracks, and find its strokes.

    Ctrl-C ends the recording. It is kept as NAME.take.npz, which `maulstick record motive` reads again, as with another
    threshold.

    Example: maulstick record live --pen-length 139mm --out me.ink.npz
    """
    contact = options.contact_options(threshold, merge, shortest)
    plot = check_outs(out, plot, overwrite)
    kept = beside(out, ".take.npz")
    check_absent(kept, "--out", overwrite)
    if seconds is not None and not seconds > 0:
        raise InputError.of_range("--seconds", f"{seconds:g}", "more than 0")
    tip, how = options.tip_of(pen_length, pen_axis, pivot, pen, sheet)

    from maulstick.recording.mocap.drawing import drawing_of  # these load scipy
    from maulstick.recording.mocap.frames import check_corner
    from maulstick.recording.mocap.take import write_take

    check_corner(corner)
    with made_folder(out.parent), made_folder(plot.parent):  # before anything is recorded
        take = _record(server, local, pen, sheet, multicast, seconds)
        write_take(take, kept)
        try:
            drawing = drawing_of(take, tip, contact, corner, kept.name)
            print(how)
            write_drawing(drawing, out, plot, overwrite)
        except MaulstickError as error:
            kept_take = f"the take is kept; try again with: maulstick record motive {kept}"
            raise type(error)(f"{error.fault} ({kept_take})", error.remedy, **error.values) from error
    print(kept, flush=True)


def _record(
    server: str, local: str | None, pen: str | None, sheet: str | None, multicast: bool, seconds: float | None
) -> "Take":
    from maulstick.recording.mocap.natnet import receive

    console = Console(stderr=True, markup=False, highlight=False)
    with ExitStack() as recorded, console.status(f"asking {server} …") as status:
        recording = _Recording(status, recorded, seconds)
        take = receive(
            server, recording.going, local=local, pen=pen, canvas=sheet, multicast=multicast, watch=recording.show
        )
    if recording.going():
        console.print(f"note: no later frame came from {server}, so the recording ends there", soft_wrap=True)
    return take


class _Recording:
    """Display of a recording, and the decision when it ends.

    recorded: lasts as long as the recording. Ctrl-C ends it in order only once there is something to keep.
    """

    def __init__(self, status: Status, recorded: ExitStack, seconds: float | None) -> None:
        self._status, self._recorded, self._most = status, recorded, seconds
        self._seconds = 0.0
        self._wanted: Callable[[], bool] | None = None

    def going(self) -> bool:
        """Return whether to go on: until Ctrl-C, or until there are enough seconds."""
        return (self._wanted is None or self._wanted()) and (self._most is None or self._seconds < self._most)

    def show(self, seen: "Seen") -> None:
        """Show what has been received so far."""
        if self._wanted is None:
            self._wanted = self._recorded.enter_context(stop_on_interrupt(Console(quiet=True)))
        self._seconds = seen.seconds
        pen, sheet = ("seen" if what else "NOT SEEN" for what in (seen.pen, seen.canvas))
        self._status.update(
            f"recording: {counted(seen.frames, 'frame')}, {seen.seconds:.1f} s, pen {pen}, canvas {sheet} (Ctrl-C ends)"
        )
