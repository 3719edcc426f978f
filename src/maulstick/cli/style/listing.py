"""``maulstick style list``: lists all styles."""

from rich.console import Console
from rich.table import Table
from rich.text import Text

from maulstick.cli.wording import COMMAND_LINE
from maulstick.errors import InputError
from maulstick.style.cards import STYLES, read_card


def list_styles() -> None:
    """List the styles that come with Maulstick, and your own.

    Example: maulstick style list
    """
    table = Table()
    for column in ("name", "kind", "strokes", "from"):
        table.add_column(column, justify="right" if column == "strokes" else "left", overflow="fold")
    table.add_row("free", "", "", "nobody: any smooth stroke")
    for name, path in STYLES.paths().items():
        try:
            card = read_card(path)
        except InputError as error:
            table.add_row(name, "", "", Text(f"cannot be used: {COMMAND_LINE.say(error)}"))
            continue
        whose = "comes with Maulstick" if STYLES.is_built_in(path) else "your own"
        table.add_row(name, card.settings.kind, str(card.strokes), Text(f"{whose}: {card.source}"))
    Console().print(table)
