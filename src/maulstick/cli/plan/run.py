"""Planning under the eyes of a person: progress, Ctrl-C, a film, and a file to go on from."""

import time
from pathlib import Path

from rich.console import Console
from typer import Exit

from maulstick.cli.exit_codes import STOPPED
from maulstick.cli.plan.summary import print_summary
from maulstick.cli.plan.tries import plan_in_processes
from maulstick.cli.progress import Camera, progress_bar, stop_on_interrupt
from maulstick.errors import InputError
from maulstick.jobs.plan.checkpoints import plan_with
from maulstick.jobs.plan.options import Job, state_files
from maulstick.jobs.plan.prepare import Prepared, prepare
from maulstick.jobs.plan.results import write_results
from maulstick.painting.video import Film
from maulstick.planning.planner import Progress
from maulstick.planning.state import read_state
from maulstick.rendering.preview import preview
from maulstick.storage.folders import made_folder


def begin(job: Job, out: Path) -> None:
    """Plan what is asked, and write it into the folder `out`."""
    console, prepared = _console(), prepare(job)
    if job.frames is not None and prepared.mural is not None:
        raise InputError("--frames films one canvas, and this one is planned in windows; leave it out, or --px smaller")
    _note_pale_lines(prepared, console)
    with made_folder(out):
        for file in state_files(out):  # of an earlier run, which is to be replaced
            file.unlink()
        _run(prepared, out, console)


def go_on(out: Path) -> None:
    """Go on with the plan that was cut off in the folder `out`; a film of it begins here.

    Raises InputError where there is none, or what it was made with has changed.
    """
    files = state_files(out) if out.is_dir() else []
    if not files:
        raise InputError(f"there is no unfinished plan in {out}; name the folder that --out named when it began")
    job = Job.from_json(read_state(files[0])[1], files[0])
    prepared = prepare(job)
    job.check_unchanged(prepared.job.sums)
    _run(prepared, out, _console())


def _run(prepared: Prepared, out: Path, console: Console) -> None:
    film = Film(prepared.job.frames) if prepared.job.frames is not None else None
    started = time.monotonic()
    with stop_on_interrupt(console) as wanted:
        with progress_bar(console, prepared.job.strokes) as show:
            if prepared.job.tries > 1:
                painting = plan_in_processes(prepared.job, out, show, wanted)
            else:
                camera = Camera(film, prepared.job.steps) if film is not None else None

                def watch(step: Progress) -> bool:
                    show(step.done, step.loss, step.parts)
                    if camera is not None:
                        camera.watch(step)
                    return wanted()

                painting = plan_with(prepared, out, prepared.job, watch)
        seconds = time.monotonic() - started
        if film is not None:
            film.add(preview(painting, prepared.layout.canvas))
        written = write_results(painting, out, film)
        stopped = not wanted()
    print_summary(painting, seconds, out, written)
    if not stopped:
        for file in state_files(out):
            file.unlink()
        return
    if state_files(out):  # it was not stopped when nothing was left to do
        console.print(f"maulstick paint --resume {out} goes on from where it was stopped", soft_wrap=True)
    raise Exit(STOPPED)


def _console() -> Console:
    return Console(stderr=True, markup=False, highlight=False)


def _note_pale_lines(prepared: Prepared, console: Console) -> None:
    brush = prepared.brush
    thinnest = brush.thinnest * prepared.layout.canvas.pixels_per_metre
    if 0 < thinnest < 1:
        console.print(
            f"note: the thinnest mark of the brush {brush.name} is {thinnest:.2f} pixels in half-width at this "
            "resolution, so fine lines are planned pale",
            soft_wrap=True,
        )
