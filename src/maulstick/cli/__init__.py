"""The command line. Every word is one small function; what it does lives elsewhere."""

import sys

import typer

from maulstick.cli.paint import paint
from maulstick.cli.render import render
from maulstick.errors import MaulstickError, OutputError

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Plan paintings out of strokes that a pen plotter or a robot can paint.",
    epilog="Exit codes: 0 done; 1 a result could not be written; 2 a file or an option cannot be used; "
    "130 stopped with Ctrl-C (paint saves the plan so far).",
)
app.command()(paint)
app.command()(render)


def main() -> None:
    """Run the command line; a user's mistake is one line."""
    try:
        app()
    except MaulstickError as error:
        print(f"maulstick: {error}", file=sys.stderr)
        sys.exit(1 if isinstance(error, OutputError) else 2)
