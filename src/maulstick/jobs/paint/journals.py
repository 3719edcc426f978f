"""Journals of a painting's sheets: a new one, and room for it."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path

from maulstick.errors import InputError, OutputError, Remedy
from maulstick.jobs.paint.options import PaintOptions
from maulstick.robot.journal import Journal, begun_with, journal_of, locked, was_begun
from maulstick.robot.machines import is_simulated

_AS_A_COPY = r"copy[0-9]+"  # end of the stem of a further copy's journal
_OF_A_COPY = rf"{_AS_A_COPY}\.log\.jsonl"  # end of its name
_OF_A_RUN = rf"(?:r[0-9]+\.(?:json|png)|{_OF_A_COPY}|eye\.npz)"  # ends of the names of what a run writes


def check_own(painting: Path) -> None:
    """Raise InputError where the journal beside a painting is that of another file, whose name ends differently."""
    path = journal_of(painting)
    if was_begun(path) and (file := begun_with(path)) not in (None, painting.name):
        raise InputError(f"{path} is the journal of {file}; name that one, or give {painting.name} another name")


def check_not_begun(painting: Path, options: PaintOptions, restart: bool) -> None:
    """Raise InputError where a painting was begun and is not to be restarted, and as `check_own` does.

    A real machine begins what was only rehearsed on the simulated easel: nothing of that is on paper.
    Raises InputError, too, where its journal would have the name of that of a further copy of another painting.
    """
    check_own(painting)
    if copied := re.fullmatch(rf"(.+)\.{_AS_A_COPY}", painting.stem):
        shared = f"a further copy of {copied[1]}{painting.suffix} would have the same journal as {painting.name}"
        raise InputError(f"{shared}; give {painting.name} another name")
    path = journal_of(painting)
    if was_begun(path) and not restart and (options.simulated or not _was_rehearsed(path)):
        raise InputError(f"{path} says that this painting was begun", Remedy.RESUME_OR_RESTART)


def check_free(painting: Path) -> None:
    """Raise InputError where another process paints it, OutputError where there can be no journal beside it."""
    with locked(journal_of(painting)):
        return


def _was_rehearsed(journal: Path) -> bool:
    return is_simulated(str(Journal.read(journal).options.get("robot", "")))


@contextmanager
def new_journal(painting: Path, sheet: int) -> Iterator[Journal]:
    """Open an empty journal of a sheet; those of an earlier run are moved away."""
    path = journal_of(painting, sheet)
    if was_begun(path) or (sheet == 1 and _has_copies(painting)):
        _make_room(path, painting.stem)
    with Journal.open(path) as journal:
        yield journal


def _has_copies(painting: Path) -> bool:
    """Return whether there are journals of further copies, which would count as those of a run that begins now."""
    of_a_copy = re.compile(rf"{re.escape(painting.stem)}\.{_OF_A_COPY}")
    return any(of_a_copy.fullmatch(each.name) for each in painting.parent.glob("*.log.jsonl"))


def _make_room(path: Path, stem: str) -> None:
    """Move the journal and the files beside it into a folder of their own, to make room for a new journal."""
    kept = next(folder for i in count(1) if not (folder := path.with_name(f"{stem}.run{i}")).exists())
    with locked(path):
        try:
            kept.mkdir()
            beside = re.compile(rf"{re.escape(stem)}\.{_OF_A_RUN}|{re.escape(path.name)}")
            for old in [each for each in path.parent.iterdir() if beside.fullmatch(each.name)]:
                old.rename(kept / old.name)
        except OSError as error:
            raise OutputError(f"cannot move {path} to {kept}: {error.strerror}; do, and run again") from error
