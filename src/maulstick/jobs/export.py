"""Exports of a painting for machines that other programs drive: G-code, HPGL, SVG, or JSON with a motion per line."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from maulstick.errors import InputError, option
from maulstick.jobs.paint.options import PaintOptions
from maulstick.ordering.sequence import sequenced
from maulstick.painting.painting import OFF_SHEET, Painting
from maulstick.painting.svg import axidraw_svg, flattened_note
from maulstick.robot.easel import Easel, Pen, read_easel
from maulstick.robot.export.export import as_gcode, as_hpgl, as_json
from maulstick.robot.export.gcode import Dialect
from maulstick.robot.export.hpgl import CAROUSEL, CarouselLoad
from maulstick.robot.limits import Limits
from maulstick.robot.routine import routine
from maulstick.robot.tray import Tray, read_tray

FORMATS: Final = ("gcode", "hpgl", "svg", "json")
"""What an export can be, which is the end of its file's name, too."""

DIALECTS: Final[tuple[Dialect, ...]] = ("grbl", "marlin")
"""Dialects of G-code."""

_THIN, _CLEAR = 1e-6, 0.05  # metres below and above the paper that any machine reaches
_TILTED = 2  # times as high as the tip is lifted is more than high enough above paper that lies as tilted as it may
_NOTED = 1e-5  # metres beyond the sheet: less is rounding
_MOST_PENS = 99  # of a carousel: more than any plotter had
_SPEED = 0.05  # metres per second: slow enough for most pens and plotters


@dataclass(frozen=True, kw_only=True)
class ExportOptions:
    """Options of an export.

    dialect: of G-code, Grbl's where it is None.  servo: what lifts and lowers the pen, in G-code.
    carousel: pens that an HPGL plotter holds, 8 where it is None.
    shrink: draw all smaller where HPGL does not reach so far.  per_pen: an SVG for each pen.
    speed: of drawing at most, metres per second.  easel, tray: their files.

    Raises InputError for a value that is out of its range, and for options that do not fit the format.
    """

    format: str = FORMATS[0]
    dialect: str | None = None
    servo: Pen | None = None
    carousel: int | None = None
    shrink: bool = False
    per_pen: bool = False
    speed: float | None = None
    easel: Path | None = None
    tray: Path | None = None

    def __post_init__(self) -> None:
        if self.format not in FORMATS:
            raise InputError.of_choice("format", self.format, FORMATS)
        if self.dialect not in (None, *DIALECTS):
            raise InputError.of_choice("dialect", str(self.dialect), DIALECTS)
        only: dict[str, tuple[str, dict[str, object]]] = {
            "gcode": ("G-code", {"servo": self.servo, "dialect": self.dialect}),
            "hpgl": ("HPGL", {"carousel": self.carousel, "shrink": self.shrink or None}),
            "svg": ("SVG", {"per_pen": self.per_pen or None}),
        }
        for format, (name, values) in only.items():
            if self.format != format and any(value is not None for value in values.values()):
                listed = " and ".join(option(each) for each in values)
                verb, them = ("are", "them") if len(values) > 1 else ("is", "it")
                raise InputError(f"{listed} {verb} for {name}; leave {them} out")
        if self.carousel is not None and not 1 <= self.carousel <= _MOST_PENS:
            raise InputError.of_range(option("carousel"), self.carousel, f"1 to {_MOST_PENS}")
        if self.format == "svg" and (self.easel, self.tray, self.speed) != (None, None, None):
            of_machines = f"{option('easel')}, {option('tray')} and {option('speed')}"
            raise InputError(f"SVG is of the sheet alone; leave out {of_machines}")
        PaintOptions(speed=self.fastest).check()

    @property
    def fastest(self) -> float:
        """Speed of drawing at most, metres per second."""
        return _SPEED if self.speed is None else self.speed


@dataclass(frozen=True)
class ExportFile:
    """Content of one file. pens: which pens it is for, where there are several files; else ""."""

    text: str
    pens: str = ""


@dataclass(frozen=True)
class Export:
    """Files of an export, in the order in which a machine takes them, and sentences about what they do not say."""

    files: tuple[ExportFile, ...]
    notes: tuple[str, ...] = ()


def exported(painting: Painting, options: ExportOptions) -> Export:
    """Return the files of a painting with its strokes in a quick order.

    Raises InputError where the painting has no strokes, or the machine cannot do what a stroke needs.
    """
    plan = sequenced(painting, (0.0, 0.0))
    if not plan.strokes:
        raise InputError("the painting has no strokes; plan it again with more")
    export = _svgs(plan, options) if options.format == "svg" else _for_machine(plan, options)
    return replace(export, notes=(*export.notes, note)) if (note := _edge_note(plan)) else export


def _for_machine(plan: Painting, options: ExportOptions) -> Export:
    """Return the files of all formats but SVG. Raises InputError as `exported`."""
    place = read_easel(options.easel) if options.easel is not None else _at_the_origin(plan)
    if options.servo is not None:
        seconds = {} if place.pen is None else {"seconds": place.pen.seconds}
        place = place.model_copy(update={"pen": options.servo.model_copy(update=seconds)})
    wells = read_tray(options.tray) if options.tray is not None else None
    limits = place.limits or _around(plan, place, wells, options.fastest)
    if place.pen is not None or options.format == "hpgl":
        limits = limits.model_copy(update={"varies_pressure": False})
    actions = routine(plan, place, limits, wells, speed=options.fastest)
    if options.format == "hpgl":
        speed = None if options.speed is None else options.fastest
        return _loads(plan, as_hpgl(actions, limits, options.carousel or CAROUSEL, speed, options.shrink))
    if options.format == "json":
        return Export((ExportFile(as_json(actions)),))
    spoken = next(each for each in DIALECTS if each == (options.dialect or DIALECTS[0]))
    return Export((ExportFile(as_gcode(actions, limits, spoken, place.pen)),))


def _edge_note(plan: Painting) -> str:
    """Return a sentence that says how far strokes reach beyond the sheet, or ""."""
    if (beyond := _beyond(plan)) <= _NOTED:
        return ""
    return f"strokes reach up to {1e3 * beyond:.2g} mm beyond the sheet; let the machine have so much room around it"


def _beyond(plan: Painting) -> float:
    """Return how far strokes reach beyond the sheet, metres."""
    return max(float(plan.sheet.overhang(part.trajectories()[..., :2]).max()) for part in plan.parts())


def _svgs(plan: Painting, options: ExportOptions) -> Export:
    """Return one SVG, or one for each paint that draws anything, in the order in which they first do."""
    paints = list(dict.fromkeys(stroke.paint for stroke in plan.strokes))
    notes = []
    if options.per_pen:
        if (taken_up := 1 + plan.paint_changes()) > len(paints):
            notes.append(
                f"pens are taken up {taken_up} times in this painting, and here {len(paints)} times: "
                "where strokes of two pens overlap, the other one may come to lie on top"
            )
        in_turn = sorted(plan.strokes, key=lambda stroke: paints.index(stroke.paint))
        plan = plan.model_copy(update={"strokes": tuple(in_turn)})
    if note := flattened_note(plan):
        notes.append(note)
    if not options.per_pen or len(paints) == 1:
        return Export((ExportFile(axidraw_svg(plan)),), tuple(notes))
    files = []
    for paint in paints:
        alone = plan.model_copy(update={"strokes": tuple(s for s in plan.strokes if s.paint == paint)})
        files.append(ExportFile(axidraw_svg(alone), _pen(plan, paint)))
    return Export(tuple(files), tuple(notes))


def _loads(plan: Painting, loads: list[CarouselLoad]) -> Export:
    """Return a file per load, and say which pen is which: of a load that is alone, unless it has just the first pen."""
    used = {stroke.paint for stroke in plan.strokes}
    pens = [{n: _pen(plan, paint) for n, paint in enumerate(load.paints, start=1) if paint in used} for load in loads]
    told = [", ".join(f"pen {number} is {pen}" for number, pen in each.items()) for each in pens]
    if len(loads) == 1:
        return Export((ExportFile(loads[0].text),), () if [*pens[0]] == [1] else (told[0],))
    return Export(tuple(ExportFile(load.text, each) for load, each in zip(loads, told, strict=True)))


def _pen(plan: Painting, paint: int) -> str:
    return f"{plan.paints[paint].brush} {plan.paints[paint].label}"


def _at_the_origin(plan: Painting) -> Easel:
    """Return an easel with the sheet's lower left corner at the origin, and the deepest pressure of the brushes."""
    deepest = max((max(brush.depth) for brush in plan.brushes.values()), default=0.0)
    return Easel(corner=(0, plan.sheet.height, 0), right=(1, 0, 0), down=(0, -1, 0), deepest=deepest)


def _around(plan: Painting, easel: Easel, tray: Tray | None, speed: float) -> Limits:
    """Return limits for an unknown machine at that speed: where strokes may be, how deep, how high, and the tray."""
    around = max(OFF_SHEET, _beyond(plan))  # which rounding may take a little farther
    across, along = ((-around, side + around) for side in (plan.sheet.width, plan.sheet.height))
    lifted = max(easel.travel, 0.0 if tray is None else tray.clearance)
    heights = (-max(easel.deepest, _THIN), max(_CLEAR, _TILTED * lifted))
    ends = [[x, y, z] for x in across for y in along for z in heights]
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
