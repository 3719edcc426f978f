"""Windows of a large sheet, each of which is drawn without the others."""

from dataclasses import dataclass
from functools import cached_property
from math import ceil
from typing import Self

import numpy as np
from PIL import Image as Pillow

from maulstick.errors import InputError
from maulstick.painting.fit import FITS, area_of, frame_of, lay_out, place_of
from maulstick.painting.painting import Sheet
from maulstick.painting.picture import decode_png, scaled
from maulstick.painting.raster import Canvas
from maulstick.planning.layout import Layout
from maulstick.planning.room import Room, room_of
from maulstick.storage.arrays import Floats, Image, Ints

Box = tuple[int, int, int, int]
"""A rectangle (left, top, right, bottom), pixels of the canvas."""

_MOST_LACKED = 0.5 - 1e-6  # pixels that a canvas may lack of its last one: half a pixel could be rounded either way
_FILTER = 3  # pixels of the coarser grid: half the width of the Lanczos filter that scales pictures


@dataclass(frozen=True)
class Mural:
    """A picture (h, w, 3) on a sheet, as `lay_out` lays it out, but never all of it at full resolution.

    canvas: the sheet's, at the resolution to plan in.  fit: ``contain`` or ``cover``. Raises InputError for another.
    margin: metres at each edge of the sheet; with one, no ink may leave the picture's area.
    """

    picture: Image
    sheet: Sheet
    canvas: Canvas
    fit: str = "contain"
    margin: float = 0.0

    def __post_init__(self) -> None:
        if self.fit not in FITS:
            raise InputError.of_choice("fit", self.fit, FITS)

    def overview(self, longest_px: int) -> Layout:
        """Return the layout of all of the sheet, at most so many pixels long."""
        width, height = self.sheet.width, self.sheet.height
        canvas = Canvas(width, height, min(longest_px / max(width, height), self.canvas.pixels_per_metre))
        under = self.sheet.image(canvas)
        target, area = lay_out(self.picture, canvas, self.fit, under, self.margin)
        return Layout(canvas, self.sheet, under, target, area, self._room(canvas, (0, 0)))

    def part(self, box: Box) -> Canvas:
        """Return the canvas of the box alone, which ends where the sheet does."""
        width, height = self._length(box[0], box[2], self.sheet.width), self._length(box[1], box[3], self.sheet.height)
        return Canvas(width, height, self.canvas.pixels_per_metre)

    def _length(self, first: int, last: int, side: float) -> float:
        """Return how much of a side of the sheet, metres, lies between two edges of pixels."""
        resolution = self.canvas.pixels_per_metre
        within = min(last / resolution, side) - first / resolution
        return max(within, (last - first - _MOST_LACKED) / resolution)

    def under(self, box: Box) -> Image:
        """Return the sheet as it is within the box, (H, W, 3)."""
        left, top, right, bottom = box
        if self._photograph is None:
            return np.full((bottom - top, right - left, 3), self.sheet.paper, dtype=np.float32)
        return _drawn(self._photograph, (0, 0, self.canvas.width_px, self.canvas.height_px), box)

    def target(self, box: Box) -> Image:
        """Return the sheet as it should be within the box, (H, W, 3)."""
        target = self.under(box)
        left, top, right, bottom = (round(edge) for edge in self._place)
        free = frame_of(self.canvas, self.margin)
        shown = (
            *(max(left, free[0], box[0]), max(top, free[1], box[1])),
            *(min(right, free[2], box[2]), min(bottom, free[3], box[3])),
        )
        if shown[0] < shown[2] and shown[1] < shown[3]:
            rows, columns = slice(shown[1] - box[1], shown[3] - box[1]), slice(shown[0] - box[0], shown[2] - box[0])
            target[rows, columns] = _drawn(self.picture, self._place, shown)
        return target

    def window(self, box: Box) -> Layout:
        """Return the layout of the box alone, all of which counts as picture."""
        canvas = self.part(box)
        area = (0.0, 0.0, canvas.width, canvas.height)
        return Layout(canvas, self.sheet, self.under(box), self.target(box), area, self._room(self.canvas, box[:2]))

    def _room(self, canvas: Canvas, corner: tuple[int, int]) -> Room | None:
        """Return the room of the sheet on a canvas, from a corner of that in pixels; None without a margin."""
        if not self.margin:
            return None
        x, y, width, height = area_of(self.picture.shape[:2], canvas, self.fit, self.margin)
        return room_of(
            (x - corner[0] / canvas.pixels_per_metre, y - corner[1] / canvas.pixels_per_metre, width, height)
        )

    @cached_property
    def _photograph(self) -> Image | None:
        return None if self.sheet.picture is None else decode_png(self.sheet.picture)

    @property
    def _place(self) -> tuple[float, float, float, float]:
        return place_of(self.picture.shape[:2], self.canvas, self.fit, self.margin)


@dataclass(frozen=True)
class Windows:
    """Cores that tile a canvas, row by row, each with a margin around it that ends where the canvas does.

    columns, rows: edges of the cores, ascending, pixels.  margin: pixels.
    """

    columns: Ints
    rows: Ints
    margin: int

    @classmethod
    def of(cls, canvas: Canvas, core_px: int, margin: int) -> Self:
        """Return the fewest windows whose cores have at most `core_px` per side, all as even as possible."""
        return cls(_edges(canvas.width_px, core_px), _edges(canvas.height_px, core_px), margin)

    def __len__(self) -> int:
        return (len(self.columns) - 1) * (len(self.rows) - 1)

    def box(self, index: int) -> Box:
        """Return a core with its margin."""
        row, column = divmod(index, len(self.columns) - 1)
        return (
            max(int(self.columns[column]) - self.margin, 0),
            max(int(self.rows[row]) - self.margin, 0),
            min(int(self.columns[column + 1]) + self.margin, int(self.columns[-1])),
            min(int(self.rows[row + 1]) + self.margin, int(self.rows[-1])),
        )

    @property
    def largest(self) -> int:
        """Pixels of the largest box."""
        boxes = [self.box(index) for index in range(len(self))]
        return max((right - left) * (bottom - top) for left, top, right, bottom in boxes)

    def rounds(self) -> list[list[int]]:
        """Return the windows in rounds that follow one another; between any two boxes of a round lies a pixel or more.

        Usually there are four rounds, by even and odd rows and columns.
        """
        across, down = len(self.columns) - 1, len(self.rows) - 1
        by_column, by_row = _stride(self.columns, self.margin), _stride(self.rows, self.margin)
        return [
            [row * across + column for row in range(top, down, by_row) for column in range(left, across, by_column)]
            for top in range(by_row)
            for left in range(by_column)
        ]

    def owner(self, x: Floats, y: Floats) -> Ints:
        """Return the index of the core in which each place lies, (N,); x and y, (N,), in pixels."""
        column = np.searchsorted(self.columns[1:-1], x, side="right")
        row = np.searchsorted(self.rows[1:-1], y, side="right")
        owner: Ints = row * (len(self.columns) - 1) + column
        return owner


def enlarged(field: Floats | Image, canvas: Canvas, box: Box) -> Image:
    """Return a field (h, w) that covers the canvas, interpolated at the pixels of the box, (H, W)."""
    across, down = field.shape[1] / canvas.width_px, field.shape[0] / canvas.height_px
    source = (box[0] * across, box[1] * down, box[2] * across, box[3] * down)
    size = (box[2] - box[0], box[3] - box[1])
    return np.array(Pillow.fromarray(field.astype(np.float32)).resize(size, Pillow.Resampling.BILINEAR, box=source))


def _drawn(picture: Image, place: tuple[float, float, float, float], box: Box) -> Image:
    """Return what a picture (h, w, 3) whose edges lie at `place` shows at the pixels of the box, (H, W, 3)."""
    columns, left, right = _reached((box[0], box[2]), (place[0], place[2]), picture.shape[1])
    rows, top, bottom = _reached((box[1], box[3]), (place[1], place[3]), picture.shape[0])
    return scaled(picture[rows, columns], (box[2] - box[0], box[3] - box[1]), (left, top, right, bottom))


def _reached(box: tuple[int, int], place: tuple[float, float], length: int) -> tuple[slice, float, float]:
    """Return the slice of a picture's `length` pixels that a box needs, and where the box begins and ends in it.

    Scaling copies all that it is given, so it is given no more.
    """
    step = length / (place[1] - place[0])
    first, last = (max(0.0, min((end - place[0]) * step, length)) for end in box)
    reach = ceil(_FILTER * max(step, 1.0))
    start = max(int(first) - reach, 0)
    return slice(start, ceil(last) + reach), first - start, last - start


def _edges(length: int, core_px: int) -> Ints:
    return np.linspace(0, length, ceil(length / core_px) + 1).round().astype(np.int64)


def _stride(edges: Ints, margin: int) -> int:
    """Return the least stride at which parts between edges lie apart, each with a margin on both sides, pixels."""
    return next(step for step in range(1, len(edges)) if (edges[step:-1] - edges[1:-step] > 2 * margin).all())
