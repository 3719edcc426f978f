"""``maulstick doctor``: shows what is installed, what works, and what to install for the rest."""

from rich.console import Console
from rich.table import Table
from rich.text import Text


def doctor() -> None:
    """Show what is installed and connected, what works, and what to do for the rest; takes a few seconds.

    Planning needs PyTorch; all but Maulstick itself, Python and the native modules is optional otherwise.

    Example: maulstick doctor
    """
    from maulstick.jobs.doctor import State, findings

    console, error = Console(), Console(stderr=True)
    with error.status("looking …"):
        found = list(findings())
    table = Table()
    for column in ("what", "state", "version, or what to do"):
        table.add_column(column, overflow="fold")
    good = (State.WORKS, State.INSTALLED)
    for each in found:
        table.add_row(Text(each.name), Text(each.state, "green" if each.state in good else "yellow"), Text(each.note))
    console.print(table)
