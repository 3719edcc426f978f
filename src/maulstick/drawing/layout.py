"""Layout of a drawing: where its page lies on the sheet."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from maulstick.drawing.document import Page
from maulstick.drawing.options import DrawingOptions
from maulstick.errors import InputError, option
from maulstick.recording.files.markup import METRES
from maulstick.storage.arrays import Floats

_QUARTER = np.array([[0.0, 1.0], [-1.0, 0.0]])  # of a turn, clockwise as y is down; points stand in rows


@dataclass(frozen=True)
class Layout:
    """Place of the page on the sheet: metres = pixels @ turn + shift.

    turn: (2, 2).  shift: (2,).  sheet: width and height (2,), metres.
    """

    turn: Floats
    shift: Floats
    sheet: Floats

    @classmethod
    def of(cls, page: Page, options: DrawingOptions) -> Self:
        """Return the page turned as asked for, at its own size, or scaled and centred on a sheet of another."""
        turn = METRES["px"] * np.linalg.matrix_power(_QUARTER, options.rotate // 90)
        corners = np.array([[0.0, 0.0], [page.width, page.height]]) @ turn
        least, size = corners.min(axis=0), np.ptp(corners, axis=0)
        sheet = size if options.size is None else np.array(options.size)
        scale = float((sheet / size).min())
        return cls(scale * turn, (sheet - scale * size) / 2 - scale * least, sheet)

    @property
    def scale(self) -> float:
        """Metres per pixel of the page."""
        return float(abs(np.linalg.det(self.turn)) ** 0.5)

    def fitted(self, lines: Sequence[Floats], margin: float) -> Self:
        """Return the layout in which lines (k, 2), metres in this one, are centred, and reach to a margin, metres.

        Raises InputError where the margins leave no room.
        """
        room = self.sheet - 2 * margin
        if not (room > 0).all():
            least = f"below {1e3 * self.sheet.min() / 2:g} mm, half of the sheet's shorter side"
            raise InputError.of_range(option("margin"), f"{1e3 * margin:g} mm", least)
        points = np.concatenate(lines)
        least, span = points.min(axis=0), np.ptp(points, axis=0)
        scale = float(min((room[i] / span[i] for i in (0, 1) if span[i] > 0), default=1.0))
        shift = scale * (self.shift - least - span / 2) + self.sheet / 2
        return type(self)(scale * self.turn, shift, self.sheet)
