"""``maulstick record``: reads recordings of a person drawing, and writes ink."""

import typer

from maulstick.cli.record.ink import ink
from maulstick.cli.record.live import live
from maulstick.cli.record.motive import motive

record = typer.Typer(no_args_is_help=True, help="Read a recording of a person drawing, and write its ink.")
record.command()(ink)
record.command()(motive)
record.command()(live)
