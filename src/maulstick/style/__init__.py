"""Styles: what a hand's strokes look like, as a prior that the planner optimises in."""

from maulstick.canvas import Canvas
from maulstick.errors import InputError
from maulstick.style.free import FreeStyle
from maulstick.style.style import Style

__all__ = ["FreeStyle", "Style", "load_style"]


def load_style(name: str, canvas: Canvas) -> Style:
    """The style of this name, with strokes of a size for the canvas. Raises InputError where there is none."""
    if name != "free":
        raise InputError.of_choice("style", name, ["free"])
    return FreeStyle.for_canvas(canvas)
