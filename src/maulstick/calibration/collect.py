"""Collection of trials for a brush (paper: Traj2Stroke Model): strokes drawn apart, and photographs cut out."""

from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import final

import numpy as np

from maulstick.brush_fit.trials import Trials
from maulstick.errors import InputError
from maulstick.painting.painting import Painting
from maulstick.painting.picture import encode_png, read_picture
from maulstick.painting.refined import refined
from maulstick.robot.room import check_accepted
from maulstick.robot.routine import ways_of
from maulstick.robot.workplace import Workplace, home_of
from maulstick.storage.arrays import Floats, Image
from maulstick.storage.files import atomic_write

_SHEET, _DIGITS = "sheet-", 4  # names of the photographs: sheet-0012.png
_IN_MEMORY = 2  # photographs, before and after a stroke: those of 1000 strokes on A4 would be 19 GB
_SMALLEST = 0.25  # least scale of strokes; smaller ones would say little about the brush
_SIZES = np.geomspace(1.0, _SMALLEST, 12)  # scales that are tried, until all strokes fit


def spread_apart(paths: Floats, sheet: tuple[float, float], room: float) -> Floats:
    """Move paths (N, n, 3), metres and pressure, so that each keeps a distance to all others and to the sheet's edges.

    sheet: width and height, metres.  room: metres that each path needs on every side.
    Where they do not fit, all are scaled down alike, to a quarter at least.
    Raises InputError where that is not enough, with the number that would fit.
    """
    for size in _SIZES:
        scaled = paths * (size, size, 1.0)
        corners = _in_rows(np.ptp(scaled[..., :2], axis=1) + 2 * room, sheet)
        if len(corners) == len(paths):
            low = scaled[..., :2].min(axis=1)
            scaled[..., :2] += (corners + room - low)[:, None]
            return scaled
    raise InputError(
        f"{len(corners)} of {len(paths)} strokes fit on a sheet of {1e3 * sheet[0]:g} x {1e3 * sheet[1]:g} mm with "
        f"{2e3 * room:.0f} mm between them; draw fewer, or take a larger sheet"
    )


def _in_rows(sizes: Floats, sheet: tuple[float, float]) -> Floats:
    """Return the upper left corners (k, 2) of boxes (N, 2) in rows, the highest first; k < N where no more fit."""
    corners = np.zeros((len(sizes), 2))
    x = y = high = 0.0
    for placed, box in enumerate(np.argsort(-sizes[:, 1], kind="stable")):
        if x + sizes[box, 0] > sheet[0]:
            x, y, high = 0.0, y + high, 0.0
        if x + sizes[box, 0] > sheet[0] or y + sizes[box, 1] > sheet[1]:
            return corners[:placed]
        corners[box] = x, y
        x, high = x + sizes[box, 0], max(high, sizes[box, 1])
    return corners


@final
class Photographs(Mapping[int, Image]):
    """Photographs of a flat sheet, (h, w, 3), by the number of strokes on it: PNGs in a folder, read when used."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._read = lru_cache(_IN_MEMORY)(read_picture)

    def keep(self, number: int, photograph: Image) -> None:
        """Write the photograph of the sheet with so many strokes. Raises OutputError where that fails."""
        atomic_write(self._path(number), encode_png(photograph))

    def __getitem__(self, number: int) -> Image:
        if number not in self:
            raise KeyError(number)
        return self._read(self._path(number))

    def __contains__(self, number: object) -> bool:
        return isinstance(number, int) and self._path(number).exists()

    def __iter__(self) -> Iterator[int]:
        names = self._folder.glob(f"{_SHEET}{'[0-9]' * _DIGITS}.png")
        return iter(sorted(int(path.stem.removeprefix(_SHEET)) for path in names))

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def _path(self, number: int) -> Path:
        return self._folder / f"{_SHEET}{number:0{_DIGITS}}.png"


def collect(
    painting: Painting, workplace: Workplace, look: Callable[[], Image], folder: Path, *, each: bool
) -> Photographs:
    """Draw the strokes of a painting that are left; returns photographs by the number of strokes on the sheet.

    look: takes a photograph of the flat sheet, (h, w, 3).  each: take one after each stroke, not only before the first
    and after the last. Photographs are kept in the folder, and none is taken twice. Raises as `execute` and `look` do.
    """
    photographs = Photographs(folder)
    home = home_of(workplace.robot, workplace.journal)
    check_accepted(ways_of(workplace.left_of(painting)), workplace.easel, workplace.robot)
    while True:
        actions = workplace.left_of(painting)
        number = len(workplace.journal.painted)
        if number not in photographs and (each or number in (0, len(painting.strokes))):
            workplace.step_aside(home)
            photographs.keep(number, look())
        if not actions:
            return photographs
        workplace.do(actions, enough=lambda painted: each)


def trials_of(
    painting: Painting,
    photographs: Mapping[int, Image],
    folder: Path,
    *,
    pixels_per_metre: float,
    medium: str,
    depth: tuple[float, float],
    room: float,
) -> Trials:
    """Write the strokes of a painting, drawn apart in its order, as trials into a new folder.

    photographs: of the flat sheet (h, w, 3), by the number of strokes on it; at least with none and with all of them.
    pixels_per_metre: of the photographs; the last pixel of a side may lie only half on the sheet, so their size does
    not tell it.
    depth: metres below first touch at pressure 0 and at pressure 1.  room: metres around each stroke that are cut out.
    Raises InputError where a photograph is missing, OutputError where the folder cannot be written.
    """
    strokes = refined(painting).strokes
    for number in (0, len(strokes)):
        if number not in photographs:
            raise InputError(f"there is no photograph of the sheet with {number} strokes on it; take one")
    taken = np.array(sorted(photographs))
    height, width = photographs[0].shape[:2]
    trials = Trials.make(folder, medium=medium, pixels_per_metre=pixels_per_metre, depth=depth)
    for number, stroke in enumerate(strokes):
        path = np.array(stroke.trajectory)
        before = photographs[int(taken[taken <= number][-1])]
        after = photographs[int(taken[taken > number][0])]
        low = np.floor((path[:, :2].min(axis=0) - room) * pixels_per_metre).astype(int).clip(min=0)
        high = np.ceil((path[:, :2].max(axis=0) + room) * pixels_per_metre).astype(int).clip(max=(width, height))
        cut = slice(low[1], high[1]), slice(low[0], high[0])
        trials.begin(before[cut])
        trials.append(path - [*(low / pixels_per_metre), 0.0], after[cut])
    return trials
