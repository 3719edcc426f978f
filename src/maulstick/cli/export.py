"""``maulstick export``: writes a painting for machines that other programs drive."""

import re
from functools import partial
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console

from maulstick.cli.drawing import (
    Hatch,
    HatchHand,
    Join,
    KeepOrder,
    Margin,
    NoRepeats,
    Rotate,
    Shortest,
    Size,
    drawing_options,
    read_plan,
)
from maulstick.cli.folder import check_other, check_place
from maulstick.errors import InputError
from maulstick.jobs.export import DIALECTS, FORMATS, Export, ExportFile, ExportOptions, exported
from maulstick.robot.easel import Pen
from maulstick.robot.export.hpgl import CAROUSEL
from maulstick.storage.files import atomic_write

_writing = partial(typer.Option, rich_help_panel="What is written")
_machine = partial(typer.Option, rich_help_panel="The machine")


def export(
    painting: Annotated[Path, typer.Argument(help="The painting.json, or SVG, to export.")],
    format: Annotated[
        str,
        _writing(
            metavar="FORMAT",
            help="Format: gcode, hpgl, svg for AxiDraw's own software, or json with one motion per line.",
        ),
    ] = FORMATS[0],
    dialect: Annotated[
        str | None, _writing(metavar="|".join(DIALECTS), show_default=DIALECTS[0], help="Dialect of the G-code.")
    ] = None,
    carousel: Annotated[
        int | None,
        _writing(metavar="N", show_default=f"{CAROUSEL}", help="Pens that an HPGL plotter holds: a file per load."),
    ] = None,
    shrink: Annotated[
        bool, _writing("--shrink", metavar="", help="Draw all smaller where HPGL does not reach so far (819 mm).")
    ] = False,
    per_pen: Annotated[bool, _writing("--per-pen", metavar="", help="Write an SVG for each pen.")] = False,
    servo: Annotated[
        str | None,
        _machine(
            metavar="UP,DOWN",
            show_default="none, the height lifts the pen",
            help="Numbers of the servo that lifts and lowers the pen, in G-code.",
        ),
    ] = None,
    speed: Annotated[
        float | None, _machine(metavar="MM/S", show_default="50", help="Speed of drawing, at most.")
    ] = None,
    easel: Annotated[
        Path | None,
        _machine(
            metavar="FILE",
            show_default="lower left corner at the origin",
            help="Place of the sheet and limits of the machine, from `maulstick calibrate touch`.",
        ),
    ] = None,
    tray: Annotated[
        Path | None, _machine(metavar="FILE", help="Places of paint wells, water and cloth, for a dipped brush.")
    ] = None,
    out: Annotated[
        Path | None, _writing(metavar="FILE", show_default="beside the painting", help="File to write.")
    ] = None,
    overwrite: Annotated[bool, _writing("--overwrite", metavar="", help="Replace an earlier file.")] = False,
    size: Size = None,
    margin: Margin = None,
    rotate: Rotate = "0",
    hatch: Hatch = None,
    hatch_hand: HatchHand = None,
    no_repeats: NoRepeats = False,
    join: Join = None,
    shortest: Shortest = None,
    keep_order: KeepOrder = False,
) -> None:
    """Write a painting for a machine that another program drives, with its strokes in a quick order.

    Example: maulstick export cat/painting.json --format gcode --servo 30,90
    """
    options = ExportOptions(
        format=format,
        dialect=dialect,
        servo=None if servo is None else servo_of(servo),
        carousel=carousel,
        shrink=shrink,
        per_pen=per_pen,
        speed=None if speed is None else speed * 1e-3,
        easel=easel,
        tray=tray,
    )
    path = out or painting.parent / f"{painting.stem}.plot.{format}"
    in_parts = per_pen or format == "hpgl"  # perhaps: then nothing is written to this path itself
    _check(path, painting, overwrite or in_parts)
    drawing = drawing_options(size, margin, rotate, hatch, hatch_hand, no_repeats, join, shortest, keep_order)
    export = exported(read_plan(painting, drawing), options)
    files = _files_of(export, path)
    for file in files:
        _check(file, painting, overwrite)
    for note in export.notes:
        _say(f"note: {note}")
    for file, part in files.items():
        if part.pens:
            _say(f"{file}: {part.pens}")
    for file, part in files.items():
        atomic_write(file, part.text.encode())
        print(file, flush=True)
    if in_parts:
        for file in sorted(_of_parts(path) - set(files)):
            _say(f"note: {file} is not of this export; delete it if an earlier one, with other pens, left it")


def _files_of(export: Export, path: Path) -> dict[Path, ExportFile]:
    """Return the parts of an export by the files that they go to: the path itself, or numbered ones beside it."""
    if len(export.files) == 1:
        return {path: export.files[0]}
    return {
        path.with_name(f"{path.stem}-{number}{path.suffix}"): part for number, part in enumerate(export.files, start=1)
    }


def _check(file: Path, painting: Path, overwrite: bool) -> None:
    """Raise InputError where the file is the painting itself, and OutputError where it cannot be written."""
    check_other(file, "--out", {"the painting": painting})
    check_place(file, "--out", overwrite)


def _of_parts(path: Path) -> set[Path]:
    """Return the files that exist of exports to a path, in one part or several."""
    numbered = re.compile(re.escape(path.stem) + r"(-\d+)?" + re.escape(path.suffix))
    return {file for file in path.parent.iterdir() if numbered.fullmatch(file.name)}


def _say(sentence: str) -> None:
    Console(stderr=True, markup=False, highlight=False).print(sentence, soft_wrap=True)


def servo_of(text: str) -> Pen:
    """Return the servo whose two numbers, for up and down, are in the text. Raises InputError where they are not."""
    try:
        up, down = (float(number) for number in text.split(","))
        if not np.isfinite([up, down]).all() or up == down:
            raise ValueError
    except ValueError:
        allowed = "two numbers that differ, up and down, as in 30,90"
        raise InputError.of_range("--servo", repr(text), allowed) from None
    return Pen(up=up, down=down)
