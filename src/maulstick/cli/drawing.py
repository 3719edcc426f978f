"""Options about how an SVG is read, which all commands that take one share."""

from functools import partial
from math import isfinite, radians
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from maulstick.cli.lengths import metres, with_unit
from maulstick.drawing.options import LONGEST, DrawingOptions
from maulstick.errors import InputError
from maulstick.jobs.paintable import read_paintable
from maulstick.painting.painting import Painting
from maulstick.painting.raster import parse_length, parse_size

_drawing = partial(typer.Option, rich_help_panel="An SVG")
_TURNS = ("0", "90", "180", "270")

Size = Annotated[
    str | None,
    _drawing(metavar="SIZE", show_default="the page's", help="Scale the page to a sheet: 200x160mm, A4-landscape."),
]
Margin = Annotated[
    str | None,
    _drawing(metavar="MM", show_default="the page's", help="Scale what is drawn to so far from the sheet's edges."),
]
Rotate = Annotated[str, _drawing(metavar="DEGREES", help="Turn the page clockwise: 90, 180 or 270.")]
Hatch = Annotated[
    str | None,
    _drawing(
        metavar="MM[@DEGREES]", show_default="empty", help="Fill filled shapes with parallel lines so far apart: 1@30."
    ),
]
HatchHand = Annotated[
    str | None,
    _drawing(
        metavar="STYLE", show_default="lines", help="Hatch with strokes of this hand, as densely as --hatch says."
    ),
]
NoRepeats = Annotated[bool, _drawing("--no-repeats", metavar="", help="Leave out paths that are there twice.")]
Join = Annotated[
    str | None,
    _drawing(metavar="MM", show_default="none", help="Draw paths whose ends are so near as one, the pen kept down."),
]
Shortest = Annotated[
    str | None, _drawing(metavar="MM", show_default="0", help="Leave out paths that are shorter than this.")
]
KeepOrder = Annotated[
    bool, _drawing("--keep-order", metavar="", help="Draw each pen's paths in the order of the file, not a quick one.")
]


def drawing_options(
    size: str | None,
    margin: str | None,
    rotate: str,
    hatch: str | None,
    hatch_hand: str | None,
    no_repeats: bool,
    join: str | None,
    shortest: str | None,
    keep_order: bool,
) -> DrawingOptions | None:
    """Return the options as they were typed, None where none was. Raises InputError where one cannot be used."""
    if rotate not in _TURNS:
        raise InputError.of_range("--rotate", rotate, "0, 90, 180 or 270")
    given: dict[str, Any] = {
        "size": None if size is None else parse_size(size, LONGEST),
        "margin": None if margin is None else metres(margin, "--margin"),
        "rotate": int(rotate) or None,
        **({} if hatch is None else _hatch(hatch)),
        "hatch_hand": hatch_hand,
        "no_repeats": no_repeats or None,
        "join": None if join is None else metres(join, "--join"),
        "shortest": None if shortest is None else metres(shortest, "--shortest"),
        "keep_order": keep_order or None,
    }
    given = {name: value for name, value in given.items() if value is not None}
    if not given:
        return None
    options = DrawingOptions.model_validate(given)
    options.check()
    return options


def read_plan(path: Path, drawing: DrawingOptions | None) -> Painting:
    """Read a painting.json, or an SVG, and print the notes about it on the terminal."""
    read = read_paintable(path, drawing)
    console = Console(stderr=True, markup=False, highlight=False)
    for note in read.notes:
        console.print(f"note: {note}", soft_wrap=True)
    return read.painting


def _hatch(text: str) -> dict[str, float]:
    """Return the fields for a spacing in millimetres and an angle, as in ``1.5`` and ``1@30``."""
    spacing, at, angle = text.partition("@")
    try:
        found = {"hatch": parse_length(with_unit(spacing))} | ({"hatch_angle": radians(float(angle))} if at else {})
    except ValueError:  # an InputError, too
        found = {}
    if not found or not all(map(isfinite, found.values())):
        raise InputError(f"--hatch is {text!r}; it must be millimetres between lines, as 1, or 1@30 with an angle")
    return found
