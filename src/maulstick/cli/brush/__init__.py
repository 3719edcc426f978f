"""``maulstick brush``: fits a brush to photographs of its strokes, and shows brushes and pens."""

import typer

from maulstick.cli.brush.fit import fit
from maulstick.cli.brush.listing import list_brushes, list_pens
from maulstick.cli.brush.show import show

brush = typer.Typer(no_args_is_help=True, help="Fit a brush to photographs of its strokes, and look at brushes.")
brush.command()(fit)
brush.command(name="list")(list_brushes)
brush.command(name="pens")(list_pens)
brush.command()(show)
