"""Cell of a sweep: a folder that says what is asked for, and is finished by whoever comes to it."""

import time
import traceback
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, suppress
from pathlib import Path
from typing import Final

from pydantic import BaseModel, ConfigDict, JsonValue

from maulstick.errors import InputError, MaulstickError, OutputError, needs_torch
from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.region_descriptions import RegionDescription, read_descriptions
from maulstick.jobs.plan.request import PlanRequest, state_file, state_files, sum_of
from maulstick.jobs.sweep.grid import LIBRARIES
from maulstick.painting.brush import load_brushes
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import read_painting
from maulstick.storage.files import atomic_write, file_sum, file_to_read, held
from maulstick.storage.folders import as_output_error
from maulstick.storage.records import read_record, write_record
from maulstick.style.cards import style_path

STOP: Final = ".stop"
"""File in the sweep's folder that tells all cells to stop, wherever they are planned."""

_BRUSH, _STYLE = "the brush", "the style"  # names of their sums
_RECORD, _FAULT, _SHARE, _LOCK = "cell.json", "fault.txt", ".share", ".lock"
_RESULTS = ("painting.json", "painting.svg", "preview.png", "palette.png")
_PATIENCE = 10.0  # seconds: a process whose sweep was killed leaves sooner, between two steps
_EVERY = 0.5  # seconds between two looks at the file that stops, and between two notes of how far it is


class CellRecord(BaseModel):
    """What a cell is asked for, and what came of it.

    request: with the sums of its files.  seconds: spent planning, in runs that were not killed.
    notes: sentences for people, as ``maulstick plan`` prints them.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    request: dict[str, JsonValue]
    seconds: float = 0.0
    notes: tuple[str, ...] = ()


class _Stopped(Exception):  # noqa: N818  nothing is wrong
    """Signal that somebody wants the cell to stop, and that its plan is saved."""


def begin(folder: Path, request: PlanRequest) -> str | None:
    """Let a folder be that of a request with its sums; one that was asked for otherwise before begins anew.

    Returns the name of what has changed, or None.  Raises InputError where the cell is planned as it was asked for
    before, by a process that goes on, and OutputError where the folder holds something else, or cannot be written.
    """
    file = folder / _RECORD
    with as_output_error(folder):
        folder.mkdir(exist_ok=True)
        if not file.exists() and any(folder.iterdir()):
            raise OutputError(f"the folder {folder} is not empty, and no cell of a sweep; choose another folder")
    record, older, changed = CellRecord(request=request.as_json()), None, None
    if file.exists():
        try:
            older = read_cell(folder)
            changed = _difference(_request_of(older, file), request)
            record = older.model_copy(update={"request": record.request}) if changed is None else record
        except InputError:
            changed = _RECORD
    if changed is not None:
        with _held(folder), as_output_error(folder):  # else what a sweep that was killed left behind writes over this
            for old in (*(folder / name for name in _RESULTS), *state_files(folder)):
                old.unlink(missing_ok=True)
            write_record(record, file)
    elif record != older:
        write_record(record, file)
    return changed


def is_cell(folder: Path) -> bool:
    """Return whether a folder is that of a cell."""
    return (folder / _RECORD).is_file()


def is_finished(folder: Path) -> bool:
    """Return whether the plan in the folder of a cell was finished."""
    return all((folder / name).is_file() for name in _RESULTS) and not state_files(folder)


def read_cell(folder: Path) -> CellRecord:
    """Return the record of the cell in a folder. Raises InputError where there is none."""
    return read_record(CellRecord, folder / _RECORD, "cell of a sweep")


def share_of(folder: Path, before: float = 0.0) -> float:
    """Return the share of a cell that is planned, in [0, 1], as its process said last.

    before: what it is where nothing is said, as while that is written, or once all is.
    """
    with suppress(OSError, ValueError):
        return float((folder / _SHARE).read_text())
    return before


def needs_gpu(folder: Path) -> bool:
    """Return whether the cell in a folder asks for a GPU."""
    return _request(folder).options.device == "cuda"


def summed(
    request: PlanRequest,
    sum_file: Callable[[Path], str] = file_sum,
    read: Callable[[Path], Painting] = read_painting,
) -> PlanRequest:
    """Return a request with the sums of its files, its brush and its style, by which a change is noticed.

    read: reads the painting that is planned again, whose own brushes are found in it.

    Raises InputError where one of them is not there.
    """
    options = request.options
    if request.picture is not None:
        file_to_read(request.picture, "picture")
    regions = _said_in(options)
    styles = [options.style, *(said.style for said in regions if said.style is not None)]
    own = None if options.again is None else read(options.again).brushes
    brushes = [(options.brush, own), *((said.brush, None) for said in regions if said.brush is not None)]
    of_styles = ["" if name == "free" else sum_file(style_path(name)) for name in styles]
    of_brushes = [brush.model_dump(mode="json") for names in brushes for brush in load_brushes(*names)]
    return request.with_sums({_BRUSH: sum_of(of_brushes), _STYLE: "+".join(of_styles)}, sum_file)


def _said_in(options: PlanOptions) -> list[RegionDescription]:
    """Return what is said of each region, where that can be read; else the cells tell why."""
    try:
        return [] if options.say is None else list(read_descriptions(options.say).values())
    except InputError:
        return []


def plan_cell(folder: str, alive: Callable[[], bool] = lambda: True) -> str | None:
    """Finish the cell in a folder, as ``maulstick plan --resume`` would; returns why it is not finished, or None.

    alive: returns False once nobody waits for it any more.
    """
    where = Path(folder)
    fault = where / _FAULT
    try:
        with _held(where), needs_torch():
            if not is_finished(where):
                _finish(where, _may_go_on(where.parent / STOP, alive))
        fault.unlink(missing_ok=True)
        (where / _SHARE).unlink(missing_ok=True)
    except _Stopped:
        return "it was stopped"
    except Exception as error:  # a cell that fails must not take the others with it
        with suppress(MaulstickError):  # the folder may be what fails
            atomic_write(fault, traceback.format_exc().encode())
        return str(error) if isinstance(error, MaulstickError) else _first_line(error)
    return None


def _held(folder: Path) -> AbstractContextManager[None]:
    """Hold a cell, so that no other process plans it; one that is left of a sweep that was killed soon lets go."""
    taken = f"{folder} is planned by another process; wait for it, or end it"
    return held(folder / _LOCK, taken, f"cannot write into {folder}", "choose another folder", _PATIENCE)


def _finish(folder: Path, wanted: Callable[[], bool]) -> None:
    if not wanted():
        raise _Stopped
    from maulstick.jobs.plan.checkpoints import plan_with  # these load torch
    from maulstick.jobs.plan.prepare import prepare
    from maulstick.jobs.plan.results import notes_on, write_results
    from maulstick.planning.result import PlanProgress

    record, request = read_cell(folder), _request(folder)
    prepared = prepare(request)
    _check_files(request, prepared.request.sums)
    started, told, stopped = time.monotonic(), 0.0, False
    notes = [*prepared.notes, *_drop_unusable(folder, prepared.request)]

    def keep_record() -> None:
        seconds = record.seconds + time.monotonic() - started
        write_record(record.model_copy(update={"seconds": seconds, "notes": tuple(notes)}), folder / _RECORD)

    def watch(progress: PlanProgress) -> bool:
        nonlocal told, stopped
        if stopped:  # the step before saved the plan
            raise _Stopped
        if time.monotonic() - told > _EVERY:
            told = time.monotonic()
            with suppress(OSError):  # only looked at
                (folder / _SHARE).write_text(f"{progress.done:.4f}")
            stopped = not wanted()
        return not stopped

    try:
        painting = plan_with(prepared, folder, prepared.request, watch)
        if stopped:  # at the last step
            raise _Stopped
    except _Stopped:
        keep_record()
        raise
    write_results(painting, folder, None)
    notes += notes_on(painting)
    keep_record()
    for file in state_files(folder):
        file.unlink()


def _check_files(request: PlanRequest, sums: Mapping[str, str]) -> None:
    """Raise InputError where a file is no longer what it was when the sweep began, whose other cells have that.

    sums: of the files that the plan read, by their paths.
    """
    now = summed(request, lambda path: sums.get(str(path)) or file_sum(path)).sums
    if (changed := request.changed_in(now)) is not None:
        raise InputError(f"{changed} has changed since the sweep began; sweep again")


def _drop_unusable(folder: Path, request: PlanRequest) -> list[str]:
    """Remove a plan in the making that cannot be gone on with, and return the reason for people."""
    from maulstick.planning.state import read_state  # loads torch

    file = state_file(folder, request.options.seed)
    if not file.is_file():
        return []
    try:
        PlanRequest.from_json(read_state(file)[1], file).check_unchanged(request.sums)
    except InputError as error:
        file.unlink()
        return [f"planned anew, for {str(error).partition(';')[0]}"]
    return []


def _may_go_on(stop: Path, alive: Callable[[], bool]) -> Callable[[], bool]:
    return lambda: alive() and not stop.exists()


def _request(folder: Path) -> PlanRequest:
    return _request_of(read_cell(folder), folder / _RECORD)


def _request_of(record: CellRecord, file: Path) -> PlanRequest:
    return PlanRequest.from_json(record.request, file)


def _difference(was: PlanRequest, now: PlanRequest) -> str | None:
    """Return the name of the first thing that two requests differ in, or None; files may have moved."""
    older, newer = _asked(was), _asked(now)
    return next((name for name in newer if older[name] != newer[name]), None)


def _asked(request: PlanRequest) -> dict[str, object]:
    """Return all that a plan depends on by name, with the sums of files in place of their paths."""
    asked = {"picture": request.picture, **vars(request.options)}
    plain = {name: request.sums.get(str(value), value) for name, value in asked.items()}
    named = {name: Path(plain[name]).name for name in LIBRARIES}
    libraries = {name: request.sums.get(name) for name in (_BRUSH, _STYLE)}
    return {**plain, **named, **libraries, "journal": set(request.sums.values())}  # no option names that


def _first_line(error: Exception) -> str:
    return f"{type(error).__name__}: {str(error).strip() or 'no more is known'}".splitlines()[0]
