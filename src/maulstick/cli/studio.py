"""``maulstick studio``: a web page to draw, plan and paint."""

from pathlib import Path
from typing import Annotated

import typer

from maulstick.errors import InputError, how_to_add


def studio(
    folder: Annotated[Path, typer.Argument(help="Folder for drawings, plans and surveys.")] = Path("studio"),
    port: Annotated[
        int, typer.Option(metavar="N", help="Port of the page, to 65535; 0 takes any that is free.")
    ] = 8337,
    host: Annotated[
        str,
        typer.Option(
            metavar="ADDRESS", help="Address of this computer that others may open the page at, by a link with a token."
        ),
    ] = "127.0.0.1",
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the page in a browser.")] = True,
) -> None:
    """Draw strokes, learn styles, plan, mix and paint on a page in a browser, until Ctrl-C.

    Example: maulstick studio my-paintings --port 8400
    """
    if not 0 <= port <= 65535:
        raise InputError.of_range("the port", port, "from 0 to 65535")
    try:
        from maulstick.studio.server.server import serve  # loads NiceGUI
    except ModuleNotFoundError as error:
        raise InputError(f"the studio needs NiceGUI; {how_to_add('studio')}") from error
    serve(folder, host, port, browser)
