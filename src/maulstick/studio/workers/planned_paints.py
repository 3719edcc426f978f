"""Paints of a plan or a drawing, read at the desk since a painting may be large."""

from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from maulstick.colour.names import colour_word
from maulstick.jobs.paintable import read_paintable
from maulstick.painting.brush import BRUSHES
from maulstick.painting.painting import Paint, hex_colour
from maulstick.painting.pens import PENS, load_pen
from maulstick.robot.tray import read_tray
from maulstick.studio.workers.svg_work import options_of


@dataclass(frozen=True)
class PlannedPaint:
    """Paint as a plan uses it.

    number: in the plan's palette, from 1.  display_name: its name for people.
    metres: length of all its strokes.  strokes: their number.
    place: among the paints in the order of their first use, from 1; 0 where no stroke has it.
    times: number of times that it is taken up.  is_pen: whether a pen draws it, which the machine asks for and nobody
    mixes; so is a paint that is alone, most likely.  well: its place in the tray (x, y), metres, or None.
    """

    number: int
    label: str
    display_name: str
    colour: tuple[float, float, float]
    is_named: bool
    metres: float
    strokes: int
    place: int
    times: int
    is_pen: bool
    well: tuple[float, float] | None

    @property
    def hex(self) -> str:
        """Colour as ``#rrggbb``."""
        return hex_colour(self.colour)


def display_name(paint: Paint, index: int) -> str:
    """Name of a paint for people: its own, or its number in the palette, from 1, and a word for its colour."""
    return paint.name if paint.name is not None else f"paint {index + 1} ({colour_word(paint.colour)})"


def asked_in_words(message: str, paint: Paint, index: int) -> str:
    """Return what a machine asks a person for: a paint by its name for people, a pen as it is called in a shop."""
    message = message.replace(f"the paint {paint.label}", display_name(paint, index))
    if paint.brush in BRUSHES.paths() or paint.brush not in PENS.paths():
        return message
    return message.replace(f"put in the {paint.brush}", f"put in the pen {load_pen(paint.brush).label}")


def planned_paints(path: Path, tray_path: Path | None) -> tuple[PlannedPaint, ...]:
    """Read the paints of the painting or the drawing at `path`, with their wells in the tray.

    tray_path: of the tray's file, if there is a tray. Raises InputError where one of the files cannot be read.
    """
    painting = read_paintable(path, options_of(path)).painting
    wells = {} if tray_path is None else read_tray(tray_path).paints
    taken = [paint for paint, _ in groupby(stroke.paint for stroke in painting.strokes)]
    places = {paint: place for place, paint in enumerate(dict.fromkeys(taken), start=1)}
    are_pens = len(painting.paints) == 1 or painting.provenance.options.get("ink") is not None
    used = [stroke.paint for stroke in painting.strokes]
    found = []
    for index, (paint, metres) in enumerate(zip(painting.paints, painting.metres_of_paints(), strict=True)):
        well = wells.get(paint.hex) or wells.get(paint.name or "")
        found.append(
            PlannedPaint(
                number=index + 1,
                label=paint.label,
                display_name=display_name(paint, index),
                colour=paint.colour,
                is_named=paint.name is not None,
                metres=float(metres),
                strokes=used.count(index),
                place=places.get(index, 0),
                times=taken.count(index),
                is_pen=are_pens,
                well=None if well is None else (well.x, well.y),
            )
        )
    return tuple(found)
