"""``maulstick brush list`` and ``pens``: list all brushes, and the catalogue of pens."""

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from rich.console import Console
from rich.table import Table
from rich.text import Text

from maulstick.cli.wording import COMMAND_LINE
from maulstick.errors import InputError
from maulstick.painting.brush import BRUSHES, Brush, load_brush, load_pen_brush
from maulstick.painting.pens import PENS, load_pen


def list_brushes() -> None:
    """List the brushes that come with Maulstick, and your own.

    Example: maulstick brush list
    """
    table = Table()
    for column in ("name", "width", "from"):
        table.add_column(column, justify="right" if column == "width" else "left", overflow="fold")
    for name, path in BRUSHES.paths().items():
        try:
            brush = load_brush(name)
        except InputError as error:
            table.add_row(name, "", Text(f"cannot be used: {COMMAND_LINE.say(error)}"))
            continue
        thinnest, widest = (f"{2e3 * half_width:.3g}" for half_width in (brush.thinnest, brush.widest))
        width = f"{thinnest} to {widest} mm" if brush.pressure_matters else f"{widest} mm"
        whose = "comes with Maulstick" if BRUSHES.is_built_in(path) else "your own"
        table.add_row(name, width, Text(f"{whose}: {brush.source}"))
    Console().print(table)


def list_pens() -> None:
    """List the pens of the catalogue, with the widths that their makers state, and your own.

    Your own brushes of constant width are pens as well.

    Example: maulstick brush pens
    """
    table, brushes = Table(), BRUSHES.paths()
    for column in ("name", "width", "colour", "kind", "from"):
        table.add_column(column, justify="right" if column == "width" else "left", overflow="fold")
    for name, path in PENS.paths().items():
        try:
            pen, (brush, _) = load_pen(name), load_pen_brush(name)
        except InputError as error:
            table.add_row(name, "", "", "", Text(f"cannot be used: {COMMAND_LINE.say(error)}"))
            continue
        if name in brushes:
            whose = "a brush that comes with Maulstick" if BRUSHES.is_built_in(brushes[name]) else "your own brush"
            width, told = f"{2e3 * brush.widest:.3g} mm", f"{whose}: {brush.source}"
        else:
            width, told = f"{1e3 * pen.width:g} mm", f"{'' if PENS.is_built_in(path) else 'your own: '}{pen.label}"
        table.add_row(name, width, pen.colour, Text(pen.kind), Text(told))
    for name, brush in _own_of_one_width(brushes).items():
        table.add_row(name, f"{2e3 * brush.widest:.3g} mm", "", "", Text(f"your own brush: {brush.source}"))
    Console().print(table)


def _own_of_one_width(brushes: Mapping[str, Path]) -> dict[str, Brush]:
    """Return the user's brushes whose width is constant, by name; without those that have a pen's name."""
    found: dict[str, Brush] = {}
    for name, path in brushes.items():
        if name in PENS.paths() or BRUSHES.is_built_in(path):
            continue
        with suppress(InputError):  # `brush list` tells what is wrong with its file
            found[name] = load_brush(name)
    return {name: brush for name, brush in found.items() if not brush.pressure_matters}
