"""All words of the command line."""

from importlib.metadata import version
from typing import Annotated

import typer

from maulstick.cli.brush import brush
from maulstick.cli.calibrate import calibrate
from maulstick.cli.compare import compare
from maulstick.cli.export import export
from maulstick.cli.mix import mix
from maulstick.cli.paint import paint
from maulstick.cli.plan import plan
from maulstick.cli.record import record
from maulstick.cli.render import render
from maulstick.cli.show import show
from maulstick.cli.studio import studio
from maulstick.cli.style import style
from maulstick.cli.survey import survey

app = typer.Typer(
    rich_markup_mode="markdown", add_completion=True, no_args_is_help=True, pretty_exceptions_enable=False
)
app.command()(plan)
app.command()(paint)
app.command()(render)
app.command()(show)
app.command()(compare)
app.command()(mix)
app.command()(export)
app.command()(studio)
app.command()(survey)
app.add_typer(record, name="record")
app.add_typer(style, name="style")
app.add_typer(brush, name="brush")
app.add_typer(calibrate, name="calibrate")


def _print_version(wanted: bool) -> None:
    if wanted:
        print(f"maulstick {version('maulstick')}")
        raise typer.Exit


@app.callback(
    epilog="Exit codes: 0 done; 1 a result could not be written; 2 a file or an option cannot be used; "
    "3 a machine or a camera failed; 130 stopped with Ctrl-C (paint saves the plan so far)."
)
def maulstick(
    version: Annotated[
        bool,
        typer.Option(
            "--version", metavar="", callback=_print_version, is_eager=True, help="Print the version and exit."
        ),
    ] = False,
) -> None:
    """Plan paintings out of strokes that a pen plotter or a robot can paint."""
