"""Sweeps from Python: many plans, each in a folder of its own."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from maulstick.api.warning import warn
from maulstick.jobs.sweep.grid import grid_of, read_grid
from maulstick.jobs.sweep.run import RETRIES, SweepRequest
from maulstick.jobs.sweep.run import sweep as run
from maulstick.jobs.sweep.sweep import Standing
from maulstick.jobs.sweep.table import columns_of
from maulstick.kinds import checked

if TYPE_CHECKING:
    import pandas as pd


@checked
def sweep(
    grid: str | Path | Mapping[str, object],
    out: str | Path = "sweep",
    *,
    on: str = "local",
    at_once: int | None = None,
    retries: int = RETRIES,
    progress: Callable[[Mapping[str, float]], bool | None] | None = None,
) -> "pd.DataFrame":
    """Plan every combination of some options, each in a folder of its own within `out`, and return a table of them.

    grid: a TOML file, or the same as a mapping: `axes` with lists of values by option, and `options` of all cells;
    values as fields of `PlanOptions` have them, and a picture's path. Paths in it are relative to the file, or to the
    current folder.  on: ``local``, ``ray``, ``ray:ADDRESS`` or ``slurm``.
    at_once: most plans at a time.  retries: how often a plan that failed is tried again.
    progress: called several times a second with the share done in [0, 1] by cell; once it returns False all stop, with
    their plans saved. The same call finishes what is missing, and plans nothing twice.

    The table has a row per cell: its axes, its painting's metrics, and `fault`, empty where it is finished; failures
    are warnings too. It is kept as sweep.csv, beside the contact sheet sweep.png.
    Raises InputError for a grid that cannot be planned, and OutputError where results cannot be written.

        >>> options = {"picture": demo_picture, "steps": 2, "px": 16}
        >>> table = sweep({"axes": {"strokes": [5]}, "options": options}, folder / "sweep")
        >>> list(table.strokes_drawn)
        [5]
    """
    import pandas as pd  # takes half a second to load

    def show(standings: Sequence[Standing]) -> bool:
        shares = {each.cell.name: 1.0 if each.finished else each.share for each in standings}
        return progress is None or progress(shares) is not False

    if isinstance(grid, Mapping):
        read, folder = grid_of(grid, "the mapping"), Path()
    else:
        read, folder = read_grid(grid), Path(grid).parent
    rows, _ = run(SweepRequest(read, folder, Path(out), on, at_once, retries), show, warn)
    return pd.DataFrame(rows, columns=columns_of(rows))
