"""Placing of a picture on a sheet: how the sheet is turned, and whether the picture fills it, as suits its shape."""

from dataclasses import dataclass
from typing import Final, Self

from maulstick.painting.raster import parse_margin, parse_size

AS_SUITS: Final = "auto"
"""Turn or fit that suits the picture's shape."""

_MOST_CUT = 0.18  # share of a picture that may be cut off unasked: 3:2 on 5:4 loses a sixth, a square a fifth
_NAMED = ("A", "LETTER")  # how sizes begin that have a name, and stand


@dataclass(frozen=True)
class Placing:
    """Sheet of a plan and the picture's place on it. size, fit, margin: as in `PlanOptions`."""

    size: str
    fit: str
    margin: str

    @classmethod
    def of(cls, size: str, turned: str, fit: str, margin: float, picture: tuple[int, int] | None) -> Self:
        """Return the placing of a picture of this shape (h, w), or of none.

        size: as for `parse_size`.  turned: ``standing``, ``lying`` or `AS_SUITS`.  fit: ``contain``, ``cover`` or
        `AS_SUITS`, which fills the sheet where that cuts off little.  margin: millimetres.
        Raises InputError for a size or a margin that cannot be.
        """
        sheet = parse_size(size)
        if turned == AS_SUITS and picture is not None and picture[0] != picture[1]:
            turned = "standing" if picture[0] > picture[1] else "lying"
        if turned != AS_SUITS:
            short, long = sorted(sheet)
            sheet = (long, short) if turned == "lying" else (short, long)
        bare = f"{margin:g}mm"
        inset = parse_margin(bare, sheet)
        if fit == AS_SUITS:
            free = (sheet[0] - 2 * inset, sheet[1] - 2 * inset)
            fit = "cover" if picture is not None and _cut(free, picture) < _MOST_CUT else "contain"
        return cls(_written(size, sheet), fit, bare)


def _cut(free: tuple[float, float], picture: tuple[int, int]) -> float:
    """Return the share of a picture (h, w) that is cut off where it fills a rectangle (width, height)."""
    stretch = free[0] / free[1] * picture[0] / picture[1]
    return 1 - min(stretch, 1 / stretch)


def _written(size: str, sheet: tuple[float, float]) -> str:
    """Return the size of a sheet, metres, as `parse_size` reads it: a name where it had one."""
    name = size.strip().upper().partition("-")[0]
    if name.startswith(_NAMED):
        return name if sheet[0] < sheet[1] else f"{name}-landscape"
    return "x".join(f"{1e3 * side:.6g}" for side in sheet) + "mm"
