"""``maulstick sweep``: plans every combination of some options, each in a folder of its own."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Self

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn
from rich.text import Text

from maulstick.cli.exit_codes import STOPPED
from maulstick.storage.text import counted

if TYPE_CHECKING:
    from maulstick.jobs.sweep.sweep import Standing

_SHOWN = 16  # cells with a bar of their own


def sweep(
    grid: Annotated[Path, typer.Argument(metavar="GRID", help="The grid: a TOML file of options with their values.")],
    out: Annotated[Path, typer.Option(metavar="FOLDER", help="Folder for the cells and the table.")] = Path("sweep"),
    on: Annotated[
        str,
        typer.Option(
            metavar="WHERE", help="Plan in processes here (local), on a Ray cluster (ray, ray:ADDRESS), or on slurm."
        ),
    ] = "local",
    at_once: Annotated[
        int | None,
        typer.Option(metavar="N", show_default="cores; on clusters, all", help="Number of plans at a time, at most."),
    ] = None,
    retries: Annotated[
        int, typer.Option(metavar="N", help="Number of times that a plan that failed is tried again.")
    ] = 2,
) -> None:
    """Plan every combination of some options, each in a folder of its own.

    The grid has a table [axes] with a list of values per option, as in seed = [0, 1, 2], and may have [options] that
    all plans share; options have the names of maulstick plan, with _ for -, and picture. Writes a table, sweep.csv, and
    a contact sheet, sweep.png. Ctrl-C stops, and saves all plans; the same command then finishes what is missing.

    Example: maulstick sweep grid.toml --out wall
    """
    from maulstick.cli.progress import stop_on_interrupt
    from maulstick.jobs.sweep.grid import read_grid
    from maulstick.jobs.sweep.run import SweepRequest, check_finished
    from maulstick.jobs.sweep.run import sweep as run

    console = Console(stderr=True, markup=False, highlight=False)
    request = SweepRequest(read_grid(grid), grid.parent, out, on, at_once, retries)
    with stop_on_interrupt(console, "stopping: saving all plans (Ctrl-C again leaves without)") as wanted:
        with _Bars(console) as bars:

            def show(standings: "Sequence[Standing]") -> bool:
                bars.update(standings)
                return wanted()

            rows, written = run(request, show, lambda said: console.print(f"note: {said}", soft_wrap=True))
        stopped = not wanted()
    finished = sum(not row["fault"] for row in rows)
    Console().print(
        Text(f"{finished:,} of {counted(len(rows), 'cell')} finished in {out}: {', '.join(written)}"), soft_wrap=True
    )
    if stopped and finished < len(rows):
        console.print("the same command goes on from where it was stopped", soft_wrap=True)
        raise typer.Exit(STOPPED)
    check_finished(rows)


class _Bars:
    """A bar for all cells, and one for each of those that are under way; none before there is anything to show."""

    def __init__(self, console: Console) -> None:
        columns = TextColumn("{task.description}", markup=False), BarColumn(), TextColumn("{task.fields[told]}")
        self._bars = Progress(*columns, TimeElapsedColumn(), console=console)
        self._all = self._bars.add_task("all cells", total=1.0, told="")
        self._own: dict[str, TaskID] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._bars.live.is_started:  # else it would print an empty line
            self._bars.stop()

    def update(self, standings: "Sequence[Standing]") -> None:
        self._bars.start()
        done = sum(each.finished for each in standings)
        share = sum(1.0 if each.finished else each.share for each in standings) / len(standings)
        self._bars.update(self._all, completed=share, told=f"{done} of {len(standings)} finished")
        under_way = [each for each in standings if each.running]
        crowded = len(under_way) > _SHOWN  # on a cluster, most of them wait
        running = {each.cell.name: each for each in under_way if each.share or not crowded}
        for name in [name for name in self._own if name not in running]:
            self._bars.remove_task(self._own.pop(name))
        for name, each in running.items():
            if name not in self._own and len(self._own) < _SHOWN:
                self._own[name] = self._bars.add_task(name, total=1.0, told="")
            if name in self._own:
                self._bars.update(self._own[name], completed=each.share, told=f"{each.share:4.0%}")
