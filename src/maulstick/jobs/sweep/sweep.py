"""Sweep: hands cells to an engine, tries those that fail again, and stops when it is told to."""

import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Protocol

from maulstick.errors import OutputError, option
from maulstick.jobs.sweep.cell import STOP, begin, is_cell, is_finished, share_of, summed
from maulstick.jobs.sweep.grid import SHEET, TABLE, Cell, Grid
from maulstick.kinds import check_whole
from maulstick.painting.painting_file import read_painting
from maulstick.storage.files import file_sum, held
from maulstick.storage.folders import as_output_error, check_no_file, made_folder

_LOOK = 0.3  # seconds between two looks at the jobs: enough for a progress bar
_LOOK_EACH = 1e-3  # seconds more for each job: a disk that machines share is slow
_MOST_RETRIES = 100
_UNSEEN = "what it wrote is not seen here; all machines must see the sweep's folder at the same path"


class Job(Protocol):
    """A cell that is being planned; a Future is one."""

    def done(self) -> bool:
        """Return whether it came to an end."""
        ...

    def result(self) -> str | None:
        """Return what `plan_cell` returned. Raises an exception where its process was lost."""
        ...


class Engine(Protocol):
    """What runs `plan_cell` somewhere.

    room: how many cells it takes at a time, or infinity where it keeps a queue of its own.
    """

    room: float

    def submit(self, folders: Sequence[Path]) -> Sequence[Job]:
        """Begin to plan the cells in these folders, at least one."""
        ...

    def stop(self) -> Sequence[Job]:
        """Take back what has not begun, and return it; what has begun sees the file that stops it."""
        ...

    def close(self) -> None:
        """Let all go, and end what still runs."""
        ...


@dataclass(eq=False)
class Standing:
    """How a cell stands: in [0, 1] planned, so many times failed, and why the last time; whether it is under way."""

    cell: Cell
    folder: Path
    finished: bool = False
    share: float = 0.0
    failures: int = 0
    fault: str | None = None
    running: bool = False


def check_retries(retries: int) -> None:
    """Raise InputError for a number of retries that is out of its range."""
    check_whole("retries", retries, 0, _MOST_RETRIES)


@contextmanager
def opened(grid: Grid, folder: Path, out: Path, note: Callable[[str], None]) -> Iterator[list[Standing]]:
    """Make the folders of a grid's cells in `out`, and yield how they stand; no other sweep can work there meanwhile.

    folder: that its paths are relative to.  note: is told sentences for people.
    Raises InputError for a grid that cannot be planned, before anything is written, and for a cell that another process
    plans as it was asked for before; OutputError for a folder that cannot be written, or holds something else.
    """
    sum_once, read_once = cache(file_sum), cache(read_painting)
    requests = [(cell, summed(cell.request, sum_once, read_once)) for cell in grid.cells(folder, read_once)]
    check_no_file(out)
    _check_free(out)
    with made_folder(out):
        taken = f"another sweep works in {out}; wait for it, or choose another {option('out')}"
        with held(out / ".lock", taken, f"cannot write into the folder {out}", f"choose another {option('out')}"):
            (out / STOP).unlink(missing_ok=True)
            standings = []
            for cell, request in requests:
                if (changed := begin(out / cell.name, request)) is not None:
                    note(f"{cell.name} was planned before {changed} changed, and is planned anew")
                at = out / cell.name
                standings.append(Standing(cell, at, is_finished(at), share_of(at)))
            yield standings


def _check_free(out: Path) -> None:
    """Raise OutputError where a file has the name of a result, in a folder without cells of a sweep."""
    for name in (TABLE, SHEET):
        if (out / name).exists() and not any(map(is_cell, out.glob("*"))):
            raise OutputError(f"{out / name} is of no sweep, and would be replaced; choose another {option('out')}")


def finish(
    standings: Sequence[Standing],
    out: Path,
    engine: Callable[[], Engine],
    retries: int,
    wanted: Callable[[], bool],
    note: Callable[[str], None],
) -> None:
    """Finish the cells that are not; once `wanted` returns False all stop, with their plans saved.

    engine: makes one, where there is anything to do.  retries: how often a cell that failed is tried again.
    wanted: called several times a second.
    """
    waiting = deque(each for each in standings if not each.finished)
    if not waiting:
        return
    running: dict[Standing, Job] = {}
    stopping, working = False, engine()
    try:
        while waiting or running:
            if not stopping and not wanted():
                stopping = True
                waiting.clear()
                _stop(out)
                taken_back = working.stop()
                running = {each: job for each, job in running.items() if job not in taken_back}
            if room := int(min(working.room - len(running), len(waiting))):
                begun = [waiting.popleft() for _ in range(room)]
                running.update(zip(begun, working.submit([each.folder for each in begun]), strict=True))
            time.sleep(max(_LOOK, _LOOK_EACH * len(running)))
            for each, job in list(running.items()):
                each.running = not job.done()
                if each.running:
                    each.share = share_of(each.folder, each.share)
                    continue
                del running[each]
                fault = _fault(job) or _UNSEEN
                each.finished = is_finished(each.folder)
                if not each.finished and not stopping and _is_tried_again(each, fault, retries, note):
                    waiting.append(each)
    finally:
        working.close()
        for each in standings:
            each.running = False
        (out / STOP).unlink(missing_ok=True)


def _is_tried_again(each: Standing, fault: str, retries: int, note: Callable[[str], None]) -> bool:
    each.failures, each.fault = each.failures + 1, fault
    again = each.failures <= retries
    note(f"{each.cell.name} failed: {fault}" + (f" (tried again, {each.failures} of {retries})" if again else ""))
    return again


def _fault(job: Job) -> str | None:
    try:
        return job.result()
    except Exception as error:  # each engine has its own
        return (str(error).strip() or type(error).__name__).splitlines()[0]


def _stop(out: Path) -> None:
    with as_output_error(out):
        (out / STOP).touch()
