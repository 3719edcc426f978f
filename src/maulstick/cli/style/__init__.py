"""``maulstick style``: learns a style from strokes, and shows styles."""

import typer

from maulstick.cli.style.compare import compare
from maulstick.cli.style.fit import fit
from maulstick.cli.style.listing import list_styles
from maulstick.cli.style.show import show

style = typer.Typer(
    no_args_is_help=True, help="Learn a style from strokes of one hand, look at styles and compare them."
)
style.command()(fit)
style.command(name="list")(list_styles)
style.command()(show)
style.command()(compare)
