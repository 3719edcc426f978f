"""Options of how an SVG is read."""

from math import isfinite
from typing import Annotated, Final, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict

from maulstick.errors import InputError, option
from maulstick.painting.raster import SMALLEST, parse_length, parse_size

LONGEST: Final = 20.0
"""Most metres of a side of a drawing's sheet: beyond, the unit is probably wrong."""

_SPACINGS = (5e-5, 0.1)  # metres between hatching lines: a pen's line is wider than the least

_Size = Annotated[
    tuple[float, float], BeforeValidator(lambda size: parse_size(size, LONGEST) if isinstance(size, str) else size)
]
_Length = Annotated[float, BeforeValidator(lambda said: parse_length(said) if isinstance(said, str) else said)]


class DrawingOptions(BaseModel):
    """Options of how an SVG is read; lengths in metres, or as in ``A4`` and ``10mm``; angles in radians.

    size: width and height of the sheet, to which the page is scaled; its own size by default.
    margin: what is drawn is scaled to reach just so far from the sheet's edges; left out, the page keeps its margins.
    rotate: degrees, clockwise.
    hatch: distance of the parallel lines that fill filled shapes; None leaves them empty.  hatch_angle: of those lines,
    from the x axis, clockwise as seen.  hatch_hand: name of the style whose strokes hatch, instead of lines.
    no_repeats: whether a path that was there already is left out.  join: distance of ends, up to which paths of one pen
    are drawn as one; 0 joins none.  shortest: paths that are shorter are left out.
    keep_order: whether the paths of a pen are drawn in the order of the file, and not in a quick one.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    size: _Size | None = None
    margin: _Length | None = None
    rotate: Literal[0, 90, 180, 270] = 0
    hatch: _Length | None = None
    hatch_angle: float | None = None
    hatch_hand: str | None = None
    no_repeats: bool = False
    join: _Length = 0.0
    shortest: _Length = 0.0
    keep_order: bool = False

    def check(self) -> None:
        """Raise InputError for an option that is out of its range."""
        for side in self.size or ():
            if not SMALLEST <= side <= LONGEST:
                allowed = f"between {1e3 * SMALLEST:g} mm and {LONGEST:g} m"
                raise InputError.of_range(option("size"), f"{1e3 * side:g} mm on a side", allowed)
        self._check_within_a_sheet("margin", 0.0 if self.margin is None else self.margin)
        if self.hatch is not None and not _SPACINGS[0] <= self.hatch <= _SPACINGS[1]:
            raise InputError.of_range(option("hatch"), f"{1e3 * self.hatch:g} mm", "from 0.05 to 100 mm between lines")
        if self.hatch_hand is not None and self.hatch is None:
            raise InputError(f"{option('hatch_hand')} hatches as densely as {option('hatch')} says; give both")
        if self.hatch_angle is not None and not isfinite(self.hatch_angle):
            raise InputError.of_range(option("hatch_angle"), self.hatch_angle, "a finite number")
        self._check_within_a_sheet("join", self.join)
        self._check_within_a_sheet("shortest", self.shortest)

    def _check_within_a_sheet(self, name: str, length: float) -> None:
        if not 0 <= length <= LONGEST:
            raise InputError.of_range(option(name), f"{1e3 * length:g} mm", f"from 0 to {1e3 * LONGEST:g} mm")
