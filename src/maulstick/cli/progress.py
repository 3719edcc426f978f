"""Progress bar, Ctrl-C and the recording of a video while a plan is made."""

import signal
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from math import ceil
from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from maulstick.painting.video import Video
from maulstick.storage.text import counted

if TYPE_CHECKING:
    from maulstick.planning.result import PlanProgress as Step

_FRAMES = 160  # of a video, at most: enough for some seconds of it


@contextmanager
def progress_bar(
    console: Console, strokes: int, wanted: Callable[[], bool]
) -> Iterator[Callable[[float, float, Mapping[str, float]], None]]:
    """Show a progress bar; yields a function that takes the share done in [0, 1], the loss, and its parts by name.

    wanted: whether nobody has stopped it; what was stopped ends where it was.
    """
    columns = (
        TextColumn(counted(strokes, "stroke")),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %"),
        TextColumn("loss {task.fields[loss]}{task.fields[parts]}"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console) as bar:
        task = bar.add_task("planning", total=1.0, loss="…", parts="")

        def show(done: float, loss: float, parts: Mapping[str, float]) -> None:
            shares = ", ".join(f"{name} {part / (loss or 1.0):.0%}" for name, part in parts.items())
            bar.update(task, completed=done, loss=f"{loss:.5f}", parts=f" ({shares})" if len(parts) > 1 else "")

        yield show
        if wanted():
            bar.update(task, completed=1.0)


@contextmanager
def stop_on_interrupt(
    console: Console, saying: str = "stopping: finishing the plan so far (Ctrl-C again leaves without it)"
) -> Iterator[Callable[[], bool]]:
    """Yield a function that returns whether to go on: True until the first Ctrl-C. The second interrupts as usual."""
    going = [True]

    def stop(*_: object) -> None:
        going[0] = False
        signal.signal(signal.SIGINT, before)
        console.print(saying)

    before = signal.signal(signal.SIGINT, stop)
    try:
        yield lambda: going[0]
    finally:
        signal.signal(signal.SIGINT, before)


class VideoRecorder:
    """Recorder of a video of planning, with at most 160 frames over the `steps`."""

    def __init__(self, video: Video, steps: int) -> None:
        self.video = video
        self._every = ceil(steps / _FRAMES)
        self._seen = 0

    def watch(self, step: "Step") -> None:
        """Add the canvas of this step to the video, if a frame is due."""
        if self._seen % self._every == 0:
            self.video.add(step.canvas.clamp(0, 1).permute(1, 2, 0).cpu().numpy())
        self._seen += 1
