"""Styles: priors over the strokes of a hand, which a planner optimises in."""

from maulstick.painting.raster import Canvas
from maulstick.style.cards import style_path
from maulstick.style.style import Style

__all__ = ["Style", "load_style"]


def load_style(name: str, canvas: Canvas) -> Style:
    """Return the style of this name, or whose JSON is at this path; the free style is sized for the canvas.

    Raises InputError where there is no such style, or its files cannot be used.
    """
    from maulstick.style.free import FreeStyle  # these load torch, which the studio's server does without
    from maulstick.style.store import read_style

    return FreeStyle.for_canvas(canvas) if name == "free" else read_style(style_path(name))
