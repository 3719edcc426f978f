"""``maulstick record``: from a recording to ink."""

import typer

record = typer.Typer(no_args_is_help=True, help="Read a recording of a person drawing, and write its ink.")
