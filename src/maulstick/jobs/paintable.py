"""What can be painted: a painting.json, or any SVG."""

from dataclasses import dataclass
from pathlib import Path

from maulstick.drawing.options import DrawingOptions
from maulstick.errors import InputError, Remedy
from maulstick.painting.painting import Painting, read_painting


@dataclass(frozen=True)
class Paintable:
    """Painting that was read; notes: sentences about what of the file is not painted as it says."""

    painting: Painting
    notes: tuple[str, ...] = ()


def read_paintable(path: str | Path, drawing: DrawingOptions | None = None) -> Paintable:
    """Read the painting in a painting.json, or an SVG as a painting.

    drawing: how an SVG is read.
    Raises InputError where the file is neither, or there are options for an SVG and it is none.
    """
    if is_svg(path):
        from maulstick.drawing.read import read_drawing

        read = read_drawing(path, drawing)
        return Paintable(read.painting, read.notes)
    if drawing is not None:
        raise InputError(f"{path} is no SVG, and a painting is painted as it was planned", Remedy.WITHOUT_DRAWING)
    return Paintable(read_painting(path))


def is_svg(path: str | Path) -> bool:
    """Return whether a file is an SVG by its name, compressed ones included."""
    return Path(path).suffix.lower() in (".svg", ".svgz")
