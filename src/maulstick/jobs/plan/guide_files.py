"""Files of guides: an SVG of lines over the picture, along which strokes lie; some are painted as they are."""

from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Final

import numpy as np
import shapely

from maulstick.colour.palette import nearest_paint
from maulstick.errors import InputError
from maulstick.jobs.plan.request import sum_of
from maulstick.painting.brush import Brush
from maulstick.painting.fit import place_of
from maulstick.painting.painting import Paint, Painting, Provenance, Stroke, hex_colour
from maulstick.painting.raster import Canvas
from maulstick.planning.bare_paper import BarePaper
from maulstick.planning.layout import Layout
from maulstick.planning.problem import Colour
from maulstick.storage.arrays import Floats

PAINTED: Final = "paint"
"""Name of the layer, or the group, whose lines are painted as they are."""


_DECIMALS = 3  # of lines that are to be known again: processors round differently beyond
_PRESSURE = 0.5  # of a line that is painted: an SVG says none


class GuideFile:
    """Guides of an SVG. Raises InputError where it cannot be read, or has no line.

    painted_sum: SHA-256 of those lines, by which they are known when a painting is planned again; None for none.
    """

    def __init__(self, path: Path) -> None:
        from maulstick.drawing.read import read_lines  # loads parsers

        shapes, self._page = read_lines(path)
        self._lines = [line for _, _, line in shapes]
        self._painted = [(colour, line) for group, colour, line in shapes if (group or "").strip().lower() == PAINTED]
        if not self._painted and not any(np.ptp(line, axis=0).any() for line in self._lines):
            raise InputError(f"{path} has no line to follow; draw some, with a stroke and no fill")
        known = [[colour, line.round(_DECIMALS).tolist()] for colour, line in self._painted]
        self.painted_sum = sum_of([self._page, known]) if known else None

    def lines_on(self, canvas: Canvas, shape: tuple[int, ...], fit: str, margin: float) -> list[Floats]:
        """Return the lines to follow, (k, 2) metres on a canvas, for a picture of this shape (h, w) laid out so."""
        return [self._placed(line, canvas, shape, fit, margin) for line in self._lines]

    def pieces(
        self,
        layout: Layout,
        shape: tuple[int, ...],
        fit: str,
        margin: float,
        brush: Brush,
        bare: BarePaper | None,
    ) -> list[tuple[Colour, Floats]]:
        """Return the lines that are painted by this brush, (n, 3) each, with their colours, sRGB in [0, 1].

        They are cut at the picture's edge and at bare paper.
        """
        from maulstick.drawing.lines import cut

        x, y, width, height = layout.area
        area, found = shapely.box(x, y, x + width, y + height), []
        for colour, line in self._painted:
            placed = self._placed(line, layout.canvas, shape, fit, margin)
            for piece in cut([placed], area)[0]:
                drawn = np.column_stack([piece, np.full(len(piece), _PRESSURE)])
                parts = [drawn] if bare is None else bare.parts_off(drawn, brush)
                found += [(colour, part) for part in parts]
        return found

    def _placed(self, line: Floats, canvas: Canvas, shape: tuple[int, ...], fit: str, margin: float) -> Floats:
        """Return a line of the page, which is stretched over the picture, on the canvas, metres."""
        left, top, right, bottom = place_of(shape[:2], canvas, fit, margin)
        corner, size = np.array([left, top]), np.array([right - left, bottom - top])
        placed: Floats = (corner + line / np.array(self._page) * size) / canvas.pixels_per_metre
        return placed


def painted_guides(
    pieces: Sequence[tuple[Colour, Floats]],
    layout: Layout,
    brush: Brush,
    paints: Sequence[Colour],
    names: Mapping[str, str],
) -> Painting | None:
    """Return pieces of guides as locked strokes of this brush, each in the nearest of the paints; None for none.

    names: of paints, by their colours as ``#rrggbb``; without them guides would have paints of their own.
    """
    if not pieces:
        return None
    colours = list(dict.fromkeys(colour for colour, _ in pieces))
    nearest = nearest_paint(np.array(colours).reshape(-1, 3), np.array(paints))
    numbers = dict(zip(colours, nearest.tolist(), strict=True))
    found = [(numbers[colour], part) for colour, part in pieces]
    used = sorted({number for number, _ in found})
    strokes = [
        Stroke(
            id=row,
            paint=used.index(number),
            trajectory=tuple((x, y, pressure) for x, y, pressure in line.tolist()),
            locked=True,
            origin="guide",
        )
        for row, (number, line) in enumerate(sorted(found, key=lambda each: each[0]))
    ]
    return Painting(
        sheet=layout.sheet,
        provenance=Provenance(version=version("maulstick")),
        brushes={brush.name: brush},
        paints=tuple(
            Paint(colour=paints[number], brush=brush.name, name=names.get(hex_colour(paints[number])))
            for number in used
        ),
        strokes=tuple(strokes),
    )
