"""Planning from a terminal: progress bar, Ctrl-C, a video, and a file to go on from."""

import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from rich.console import Console
from typer import Exit

from maulstick.cli.exit_codes import STOPPED
from maulstick.cli.plan.summary import print_summary
from maulstick.cli.plan.tries import plan_in_processes
from maulstick.cli.progress import VideoRecorder, progress_bar, stop_on_interrupt
from maulstick.errors import InputError, OutputError
from maulstick.jobs.plan.checkpoints import plan_with
from maulstick.jobs.plan.prepare import prepare
from maulstick.jobs.plan.prepared import Prepared
from maulstick.jobs.plan.request import PlanRequest, state_files
from maulstick.jobs.plan.results import RESULTS, notes_on, write_results
from maulstick.painting.brush import finest_of
from maulstick.painting.video import Video
from maulstick.planning.result import PlanProgress
from maulstick.planning.state import read_state
from maulstick.rendering.preview import preview
from maulstick.storage.folders import made_folder


def begin(request: PlanRequest, out: Path) -> None:
    """Plan a request, and write the results into the folder `out`."""
    for file in request.files:
        if file.name in RESULTS and file.resolve() == (out / file.name).resolve():
            how = "again" if file == request.options.again else "from"
            raise InputError(f"{file} is planned {how}, and the results in {out} would replace it; name another --out")
    console, prepared = _console(), prepare(request)
    if request.video is not None and prepared.mural is not None:
        raise InputError("--video records one canvas, and this one is planned in windows; leave it out or lower --px")
    _note(prepared.notes, console)
    _note_pale_lines(prepared, console)
    with made_folder(out):
        for file in state_files(out):  # of an earlier run, which is to be replaced
            file.unlink()
        _run(prepared, out, console)


def go_on(out: Path, workers: int | None) -> None:
    """Go on with the unfinished plan in the folder `out`; its video begins here.

    workers: as many as then, where left out; the plan does not depend on them.
    Raises InputError where there is none, or a file that it was made with has changed.
    """
    files = state_files(out) if out.is_dir() else []
    if not files:
        raise InputError(f"there is no unfinished plan in {out}; name the folder that --out named when it began")
    request = PlanRequest.from_json(read_state(files[0])[1], files[0])
    if workers is not None:
        request = replace(request, workers=workers)
    prepared = prepare(request)
    request.check_unchanged(prepared.request.sums)
    console = _console()
    _note(prepared.notes, console)
    _run(prepared, out, console)


def _run(prepared: Prepared, out: Path, console: Console) -> None:
    video = Video(prepared.request.video) if prepared.request.video is not None else None
    started = time.monotonic()
    with stop_on_interrupt(console) as wanted, _saying_how_to_go_on(out, console):
        with progress_bar(console, prepared.settings.strokes, wanted) as show:
            if prepared.request.tries > 1:
                painting = plan_in_processes(prepared.request, out, show, wanted)
            else:
                recorder = VideoRecorder(video, prepared.request.options.steps) if video is not None else None

                def watch(step: PlanProgress) -> bool:
                    show(step.done, step.loss, step.parts)
                    if recorder is not None:
                        recorder.watch(step)
                    return wanted()

                painting = plan_with(prepared, out, prepared.request, watch)
        seconds = time.monotonic() - started
        if video is not None:
            video.add(preview(painting, prepared.layout.canvas))
        written = write_results(painting, out, video)
        stopped = not wanted()
    print_summary(painting, seconds, out, written)
    _note(notes_on(painting), console)
    if not stopped:
        for file in state_files(out):
            file.unlink()
        return
    if state_files(out):  # it was not stopped when nothing was left to do
        console.print(f"maulstick plan --resume {out} goes on from where it was stopped", soft_wrap=True)
    raise Exit(STOPPED)


@contextmanager
def _saying_how_to_go_on(out: Path, console: Console) -> Iterator[None]:
    """Say how to go on where planning fails and left a file to go on from."""
    try:
        yield
    except OutputError:
        if state_files(out):
            console.print(f"maulstick plan --resume {out} goes on from what was kept last", soft_wrap=True)
        raise


def _console() -> Console:
    return Console(stderr=True, markup=False, highlight=False)


def _note(notes: Iterable[str], console: Console) -> None:
    for note in notes:
        console.print(f"note: {note}", soft_wrap=True)


def _note_pale_lines(prepared: Prepared, console: Console) -> None:
    brush = finest_of(prepared.brushes)
    canvas = prepared.layout.canvas if prepared.mural is None else prepared.mural.canvas
    thinnest = brush.thinnest * canvas.pixels_per_metre
    if 0 < thinnest < 1:
        console.print(
            f"note: the thinnest mark of the brush {brush.name} is {thinnest:.2f} pixels in half-width at this "
            "resolution, so fine lines are planned pale",
            soft_wrap=True,
        )
