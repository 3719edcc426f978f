"""Styles: what a hand's strokes look like, as a prior that the planner optimises in."""

from maulstick.painting.raster import Canvas
from maulstick.style.cards import style_path
from maulstick.style.style import Style

__all__ = ["Style", "load_style"]


def load_style(name: str, canvas: Canvas) -> Style:
    """The style of this name, or whose JSON is at this path; the free one with strokes of a size for the canvas.

    Raises InputError where there is none, or its files cannot be used.
    """
    from maulstick.style.free import FreeStyle  # these load torch, which the studio's server does without
    from maulstick.style.store import read_style

    return FreeStyle.for_canvas(canvas) if name == "free" else read_style(style_path(name))
