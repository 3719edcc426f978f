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
    KeepOrder,
    Margin,
    NoRepeats,
    Rotate,
    Shortest,
    Size,
    drawing_options,
    read_plan,
)
from maulstick.cli.folder import check_absent
from maulstick.errors import InputError
from maulstick.jobs.paint.options import PaintOptions
from maulstick.ordering.sequence import sequenced
from maulstick.painting.painting import Painting
from maulstick.painting.svg import axidraw_svg, flattened_note
from maulstick.robot.easel import Easel, Pen, read_easel
from maulstick.robot.export.export import as_gcode, as_hpgl, as_json
from maulstick.robot.export.gcode import Dialect
from maulstick.robot.export.hpgl import CAROUSEL, CarouselLoad
from maulstick.robot.limits import Limits
from maulstick.robot.routine import routine
from maulstick.robot.tray import Tray, read_tray
from maulstick.storage.files import atomic_write

_THIN, _CLEAR = 1e-6, 0.05  # metres below and above the paper that any machine reaches
_FORMATS = ("gcode", "hpgl", "svg", "json")
_DIALECTS: tuple[Dialect, ...] = ("grbl", "marlin")
_MOST_PENS = 99  # of a carousel: more than any plotter had
_SPEED = 0.05  # metres per second: slow enough for most pens and plotters

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
    ] = "gcode",
    dialect: Annotated[
        str | None, _writing(metavar="grbl|marlin", show_default="grbl", help="Dialect of the G-code.")
    ] = None,
    carousel: Annotated[
        int | None,
        _writing(metavar="N", show_default=f"{CAROUSEL}", help="Pens that an HPGL plotter holds: a file per load."),
    ] = None,
    shrink: Annotated[
        bool, _writing("--shrink", metavar="", help="Draw all smaller where HPGL does not reach so far (819 mm).")
    ] = False,
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
    shortest: Shortest = None,
    keep_order: KeepOrder = False,
) -> None:
    """Write a painting for a machine that another program drives, with its strokes in a quick order.

    Example: maulstick export cat/painting.json --format gcode --servo 30,90
    """
    spoken = next((each for each in _DIALECTS if each == (dialect or "grbl")), None)
    if format not in _FORMATS:
        raise InputError.of_choice("format", format, _FORMATS)
    if spoken is None:
        raise InputError.of_choice("dialect", dialect, _DIALECTS)
    if format != "gcode" and (servo, dialect) != (None, None):
        raise InputError("--servo and --dialect are for G-code; leave them out")
    if format != "hpgl" and (carousel is not None or shrink):
        raise InputError("--carousel and --shrink are for HPGL; leave them out")
    if carousel is not None and not 1 <= carousel <= _MOST_PENS:
        raise InputError.of_range("--carousel", carousel, f"1 to {_MOST_PENS}")
    if format == "svg" and (easel, tray, speed) != (None, None, None):
        raise InputError("SVG is of the sheet alone; leave out --easel, --tray and --speed")
    fastest = _SPEED if speed is None else speed * 1e-3
    PaintOptions(speed=fastest).check()
    path = out or painting.with_suffix(f".plot.{format}")
    check_absent(path, "--out", overwrite)
    drawing = drawing_options(size, margin, rotate, hatch, hatch_hand, no_repeats, shortest, keep_order)
    plan = sequenced(read_plan(painting, drawing), (0.0, 0.0))
    if not plan.strokes:
        raise InputError(f"{painting} has no strokes; plan it again with more")
    if format == "svg":
        if note := flattened_note(plan):
            _say(f"note: {note}")
        _write({path: axidraw_svg(plan)})
        return
    place = read_easel(easel) if easel is not None else _at_the_origin(plan)
    if servo is not None:
        place = place.model_copy(update={"pen": servo_of(servo)})
    wells = read_tray(tray) if tray is not None else None
    limits = place.limits or _around(plan, place, wells, fastest)
    if place.pen is not None or format == "hpgl":
        limits = limits.model_copy(update={"varies_pressure": False})
    actions = routine(plan, place, limits, wells, speed=fastest)
    if format == "hpgl":
        loads = as_hpgl(actions, limits, carousel or CAROUSEL, None if speed is None else fastest, shrink)
        files = _files_of(loads, plan, path, overwrite)
        _write(files)
        for file in sorted(_of_loads(path) - set(files)):
            _say(f"note: {file} is of an earlier export, with other pens; delete it")
    else:
        _write({path: as_gcode(actions, limits, spoken, place.pen) if format == "gcode" else as_json(actions)})


def _files_of(loads: list[CarouselLoad], plan: Painting, path: Path, overwrite: bool) -> dict[Path, str]:
    """Return a file for each load of pens, and say which pens are in it where there are several."""
    if len(loads) == 1:
        return {path: loads[0].text}
    files = {}
    for number, load in enumerate(loads, start=1):
        file = path.with_name(f"{path.stem}-{number}{path.suffix}")
        check_absent(file, "--out", overwrite)
        files[file] = load.text
        paints = [plan.paints[paint] for paint in load.paints]
        _say(f"{file}: " + ", ".join(f"pen {n} is {p.brush} {p.label}" for n, p in enumerate(paints, start=1)))
    return files


def _of_loads(path: Path) -> set[Path]:
    """Return the files that exist of exports to a path, in one load or several."""
    numbered = re.compile(re.escape(path.stem) + r"(-\d+)?" + re.escape(path.suffix))
    return {file for file in path.parent.iterdir() if numbered.fullmatch(file.name)}


def _write(files: dict[Path, str]) -> None:
    for path, text in files.items():
        atomic_write(path, text.encode())
        print(path, flush=True)


def _say(sentence: str) -> None:
    Console(stderr=True, markup=False, highlight=False).print(sentence, soft_wrap=True)


def servo_of(text: str) -> Pen:
    """Return the servo whose two numbers, for up and down, are in the text. Raises InputError where they are not."""
    try:
        up, down = (float(number) for number in text.split(","))
        if not np.isfinite([up, down]).all():
            raise ValueError
    except ValueError:
        raise InputError(f"--servo is {text!r}; it must be two numbers, for up and down, as in 30,90") from None
    return Pen(up=up, down=down)


def _at_the_origin(plan: Painting) -> Easel:
    """Return an easel with the sheet's lower left corner at the origin, and the deepest pressure of the brushes."""
    deepest = max((max(brush.depth) for brush in plan.brushes.values()), default=0.0)
    return Easel(corner=(0, plan.sheet.height, 0), right=(1, 0, 0), down=(0, -1, 0), deepest=deepest)


def _around(plan: Painting, easel: Easel, tray: Tray | None, speed: float) -> Limits:
    """Return limits for an unknown machine: the sheet, as deep as the easel allows, and the tray, at that speed."""
    width, height = plan.sheet.width, plan.sheet.height
    ends = [[x, y, z] for x in (0, width) for y in (0, height) for z in (-max(easel.deepest, _THIN), _CLEAR)]
    places = [np.array(ends)]
    if tray is not None:
        for well in (*tray.paints.values(), tray.water, tray.cloth):
            path = well.path()
            places += [path, np.insert(path[:, :2], 2, tray.clearance, axis=1)]
    corners = easel.canvas_to_machine(np.concatenate(places))
    return Limits(
        lower=tuple(corners.min(axis=0).tolist()),
        upper=tuple(corners.max(axis=0).tolist()),
        speed=speed,
        climb=speed,
        acceleration=1.0,
        varies_pressure=True,
    )
