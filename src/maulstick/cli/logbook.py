"""The logbook of machines as a table."""

from rich.console import Console
from rich.table import Table
from rich.text import Text

from maulstick.robot.logbook import logbook_path, read_logbook, totals
from maulstick.robot.machines import SIMULATED_SPECS, check_spec
from maulstick.storage.text import counted


def print_logbook(machine: str | None) -> None:
    """Print what each pen has drawn, on a machine or on all where it is None.

    Raises InputError for one that there is not, and of which there is no line.
    """
    runs = [run for run in read_logbook() if machine in (None, run.machine)]
    if not runs:
        if machine is not None and machine not in SIMULATED_SPECS:
            check_spec(machine)
        nothing = "no real machine has painted" if machine is None else f"nothing was painted on {machine}"
        print(f"{nothing} so far (the simulated easel is not counted)")
        return
    table = Table(title=counted(len(runs), "run"), caption=str(logbook_path()))
    for column in ("pen", "metres", "minutes", "strokes", "runs", "last"):
        table.add_column(column, justify="left" if column in ("pen", "last") else "right", overflow="fold")
    for name, total in totals(runs).items():
        use = total.use
        numbers = f"{use.metres:.2f}", f"{use.seconds / 60:.1f}", f"{use.strokes}", f"{total.runs}"
        table.add_row(Text(name), *numbers, f"{total.last.astimezone():%Y-%m-%d}")
    Console().print(table)
