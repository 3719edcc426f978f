"""``maulstick record ink``: reads a drawing of another program, and writes its ink."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from maulstick.cli.lengths import with_unit
from maulstick.cli.record.writing import check_out, write_result
from maulstick.errors import InputError
from maulstick.painting.raster import parse_size
from maulstick.recording.files.page import parse_longest
from maulstick.storage.folders import made_folder


def ink(
    file: Annotated[
        Path, typer.Argument(help="The drawing: InkML, SVG, Wacom's UIM or WILL 2, or JSON of pointer events.")
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            show_default="FILE.ink.npz here",
            help="File to write: NAME.ink.npz, or NAME.strokes.npz for standardised strokes.",
        ),
    ] = None,
    size: Annotated[
        str | None, typer.Option(metavar="SIZE", help="Size of the sheet that the page fills: 150x150mm, A4.")
    ] = None,
    longest: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH",
            show_default="as the file says, else 150mm",
            help="Length of the drawing's longer side, as in 150mm.",
        ),
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", metavar="", help="Replace an earlier file.")] = False,
) -> None:
    """Read a drawing of a pen tablet, a web page or a drawing program, and write its ink.

    Example: maulstick record ink drawing.svg --size A4 --out me.ink.npz
    """
    out = out or Path(f"{file.stem}.ink.npz")
    check_out(out, overwrite)
    if size is not None and longest is not None:
        raise InputError("--size and --longest cannot both be kept; give one of them")
    sheet = None if size is None else parse_size(size)
    longer = None if longest is None else parse_longest(with_unit(longest))
    from maulstick.recording.files.ink_files import read_ink_file  # loads parsers

    with made_folder(out.parent):
        drawn, kind = read_ink_file(file, sheet, longer, _print_note, "; say it with --size or --longest")
        write_result(drawn, out, overwrite)
    print(f"{kind}: {drawn.summary()}")
    print(out, flush=True)


def _print_note(note: str) -> None:
    console = Console(stderr=True, markup=False, highlight=False)
    console.print(f"note: {note}", soft_wrap=True)
