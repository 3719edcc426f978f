"""``maulstick studio``: one web page from a hand to a painting."""

from pathlib import Path
from typing import Annotated

import typer

from maulstick.errors import InputError


def studio(
    folder: Annotated[Path, typer.Argument(help="Where drawings, plans and surveys are kept.")] = Path("studio"),
    port: Annotated[int, typer.Option(metavar="N", min=0, max=65535, help="0 for any that is free.")] = 8337,
    host: Annotated[
        str,
        typer.Option(metavar="ADDRESS", help="An address of this machine: lets others in, by a link with a token."),
    ] = "127.0.0.1",
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open a browser, too.")] = True,
) -> None:
    """Draw a hand, plan, mix and paint, on a page in a browser."""
    try:
        from maulstick.studio.server.server import serve  # loads NiceGUI
    except ModuleNotFoundError as error:
        raise InputError("the studio needs NiceGUI; run: pip install 'maulstick[studio]'") from error
    serve(folder, host, port, browser)
