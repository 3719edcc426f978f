"""Brushes and pens that forms offer for a machine, and their names for people."""

from contextlib import suppress

from maulstick.colour.names import colour_word
from maulstick.colour.palette import parse_colour
from maulstick.errors import InputError
from maulstick.jobs.plan.options import PlanOptions
from maulstick.painting.brush import BRUSHES, Brush, load_brush
from maulstick.painting.pens import PENS, PenModel, load_pen

USUAL_PEN = "micron-01"
"""Pen that a plotter is offered first: 0.25 mm, thin enough for a small sheet."""


def brushes_for(machine: str) -> dict[str, str]:
    """Return what a machine of a kind can draw with, by name, and in words how it does; "" is none yet.

    One that only lifts its pen gets the catalogue of pens first, the thinnest before all, and brushes that are held.
    """
    pressure = PlanOptions(robot=machine or None).held_pressure
    pens = {} if pressure is None else {name: pen_in_words(pen) for name, pen in _pens().items()}
    offered = {name: _in_words(name, pressure) for name in BRUSHES.paths()}
    return {**pens, **{name: words for name, words in offered.items() if words}}


def is_pen(name: str) -> bool:
    """Return whether a pen of the catalogue has that name, and no brush."""
    return name in PENS.paths() and name not in BRUSHES.paths()


def draws_one_width(name: str) -> bool:
    """Return whether a brush or a pen of that name draws one width, however hard it is pressed."""
    with suppress(InputError):
        return not load_brush(name).pressure_matters
    return False


def brush_in_words(name: str) -> str:
    """Return the name of a brush, or of a pen, for people: ``a pen of 0.25 mm`` for a pen of that width."""
    with suppress(InputError):
        if is_pen(name):
            return f"a pen of {1e3 * load_pen(name).width:g} mm"
    return name


def brushes_in_words(names: str) -> str:
    """Return the names of brushes with commas between them for people, the broadest first: ``wash and marker``."""
    each = names.split(",")
    with suppress(InputError):  # one that is there no more has no width
        each.sort(key=lambda name: -load_brush(name).widest)
    *others, last = map(brush_in_words, each)
    return f"{', '.join(others)} and {last}" if others else last


def pen_in_words(pen: PenModel) -> str:
    """Return a pen for people: its width, its colour, and what it is called in a shop."""
    return f"Pen: {1e3 * pen.width:g} mm {colour_word(parse_colour(pen.colour))}, {pen.label}"


def _pens() -> dict[str, PenModel]:
    """Return the pens of the catalogue by name, the thinnest first; without those whose file is none."""
    pens: dict[str, PenModel] = {}
    for name in filter(is_pen, PENS.paths()):
        with suppress(InputError):
            pens[name] = load_pen(name)
    return dict(sorted(pens.items(), key=lambda each: each[1].width))


def _in_words(name: str, pressure: float | None) -> str:
    """Return a brush with the widths that it draws; "" where it leaves no mark at the pressure at which it is held."""
    with suppress(InputError):
        brush = load_brush(name)
        if not brush.pressure_matters:
            return f"{name}, {_millimetres(brush.widest)} mm"
        if pressure is None:
            return f"{name}, {_range(brush)} mm"
        return f"{name}, held at one pressure: {_millimetres(brush.held_at(pressure).widest)} mm"
    return ""


def _range(brush: Brush) -> str:
    return f"{_millimetres(brush.thinnest)} to {_millimetres(brush.widest)}"


def _millimetres(half_width: float) -> str:
    return f"{2e3 * half_width:.2g}"
