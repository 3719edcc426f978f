"""What can be painted: a painting.json, or any SVG."""

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from maulstick.drawing.options import DrawingOptions
from maulstick.errors import InputError, Remedy, needs_torch
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import read_painting
from maulstick.painting.raster import Canvas
from maulstick.storage.files import file_sum

if TYPE_CHECKING:
    from maulstick.drawing.hand import HatchingHand

_STROKES = 1000  # of a hand, from which those that hatch are drawn: so many that nobody sees one again
_CANVAS: Final = Canvas(0.2, 0.2, 1000)  # by which the free style, which is nobody's hand, has its size


@dataclass(frozen=True)
class Paintable:
    """Painting that was read from a file.

    sha256: of that file, in hexadecimal digits.  notes: sentences about what of it is not painted as it says.
    """

    painting: Painting
    sha256: str
    notes: tuple[str, ...] = ()


def read_paintable(path: str | Path, drawing: DrawingOptions | None = None) -> Paintable:
    """Read the painting in a painting.json, or an SVG as a painting.

    drawing: how an SVG is read.
    Raises InputError where the file is neither, or there are options for an SVG and it is none.
    """
    sha256 = file_sum(path, "drawing" if is_svg(path) else "painting")  # before it is read: what comes later is another
    if is_svg(path):
        from maulstick.drawing.read import read_drawing

        named = None if drawing is None or drawing.hatch_hand is None else _hatching_hand(drawing.hatch_hand)
        read = read_drawing(path, drawing, named)
        return Paintable(read.painting, sha256, read.notes)
    if drawing is not None:
        raise InputError(f"{path} is no SVG, and a painting is painted as it was planned", Remedy.WITHOUT_DRAWING)
    return Paintable(read_painting(path), sha256)


def strokes_sum(painting: Painting) -> str:
    """Return the SHA-256 of a painting's strokes, as hexadecimal digits."""
    digest = hashlib.sha256()
    for stroke in painting.strokes:
        digest.update(f"{stroke.id} {stroke.paint} {len(stroke.trajectory)} ".encode())
        digest.update(np.array(stroke.trajectory).tobytes())
    return digest.hexdigest()


def is_svg(path: str | Path) -> bool:
    """Return whether a file is an SVG by its name, compressed ones included."""
    return Path(path).suffix.lower() in (".svg", ".svgz")


def _hatching_hand(name: str) -> "HatchingHand":
    """Return the strokes of the style of this name, or at this path. Raises InputError where there is none."""
    with needs_torch():
        import torch  # takes seconds, and only this needs it

    from maulstick.drawing.hand import HatchingHand
    from maulstick.style import load_style

    style = load_style(name, _CANVAS)
    codes, _ = style.sample(_STROKES, torch.Generator().manual_seed(0))
    arrangement = style.arrangement
    if arrangement is None:
        return HatchingHand(style.decode(codes).double().numpy(), None, np.zeros(1))
    turns = np.angle(arrangement.directions / arrangement.leaning) / 2
    return HatchingHand(style.decode(codes).double().numpy(), float(np.angle(arrangement.leaning)) / 2, turns)
