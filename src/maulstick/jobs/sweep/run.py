"""One call that makes a sweep, for the command line and Python."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from maulstick.errors import OutputError
from maulstick.jobs.sweep.engines import check_engine, make_engine
from maulstick.jobs.sweep.grid import Grid
from maulstick.jobs.sweep.sweep import Standing, check_retries, finish, opened
from maulstick.jobs.sweep.table import Row, rows_of, write_table
from maulstick.storage.text import counted

RETRIES = 2
"""How often a cell that failed is tried again, unless it is said."""


@dataclass(frozen=True)
class SweepRequest:
    """A grid whose paths are relative to a folder, where to plan it, and into which folder.

    on: the name of an engine.  at_once: most cells at a time.  retries: how often a cell that failed is tried again.
    Raises InputError for a value that is out of its range.
    """

    grid: Grid
    folder: Path
    out: Path
    on: str = "local"
    at_once: int | None = None
    retries: int = RETRIES

    def __post_init__(self) -> None:
        check_engine(self.on, self.at_once)
        check_retries(self.retries)


def sweep(
    request: SweepRequest, show: Callable[[Sequence[Standing]], bool], note: Callable[[str], None]
) -> tuple[list[Row], list[str]]:
    """Finish the cells that are not, and write the table and the contact sheet; returns their rows, and their names.

    show: is called with all cells several times a second; returns whether to go on. Once it returns False all stop,
    with their plans saved.  note: is told sentences for people.
    Raises InputError for a grid that cannot be planned, and OutputError where results cannot be written.
    """
    grid, out = request.grid, request.out
    with opened(grid, request.folder, out, note) as standings:
        finish(
            standings,
            out,
            lambda: make_engine(request.on, request.at_once, out, grid.slurm),
            request.retries,
            lambda: show(standings),
            note,
        )
        show(standings)
        rows = rows_of(standings)
        return rows, write_table(standings, rows, grid.columns(), out)


def check_finished(rows: Sequence[Row]) -> None:
    """Raise OutputError where a cell failed."""
    failed = [str(row["cell"]) for row in rows if row["fault"]]
    if failed:
        named = ", ".join(failed[:3]) + (f" and {len(failed) - 3:,} more" if len(failed) > 3 else "")
        raise OutputError(
            f"{len(failed):,} of {counted(len(rows), 'cell')} failed: {named}; sweep.csv says why; mend it, "
            "and sweep again: "
            "what is finished stays"
        )
