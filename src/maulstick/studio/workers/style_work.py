"""Tasks of the desk with styles: their sheets, their maps, and their differences."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from maulstick.storage.arrays import Floats, Ints
from maulstick.storage.files import atomic_write

_PX = 1024  # height of a sheet
_PROPORTION = 1.4  # width of a map over its height


@dataclass(frozen=True)
class Map:
    """Map of N strokes of the hands of some styles.

    names: of the styles.  whose: (N,), index of the style.
    places, glyphs: see `maulstick.plots.latent_map`; places are moved apart, so that each stroke can be pointed at.
    paths: (N, 32, 2), metres, standardised.  lengths: (N,), metres.  speeds: (N,), metres per second, the median along
    the stroke.  pressure: (N,), in [0, 1], the mean.  Speeds and pressure are NaN where they were not recorded.
    strokes: number of strokes of all hands together, of which the map may show a part.
    """

    names: tuple[str, ...]
    whose: Ints
    places: Floats
    glyphs: Floats
    paths: Floats
    lengths: Floats
    speeds: Floats
    pressure: Floats
    strokes: int


@dataclass(frozen=True)
class Difference:
    """Difference between the strokes of two styles' hands.

    distance: about 0 for two parts of one hand, 1 for two people on average.
    accuracy: share of the strokes that a classifier gives to the right hand, in [0, 1]; 0.5 by guessing.
    words: how the second hand's strokes differ from the first's.  shared: share of strokes that both have, in [0, 1].
    """

    first: str
    second: str
    distance: float
    accuracy: float
    words: str
    shared: float


_TWO_PEOPLE = 1.8
"""Energy distance between the strokes of two people on average, by which `Difference.distance` is scaled."""


def draw_sheet(style: Path, sheet: Path) -> None:
    """Draw the sheet of a style, given by its JSON file, unless it is drawn already."""
    from maulstick.plots.style import style_plot  # these load torch
    from maulstick.style.store import read_style

    if not sheet.exists():
        sheet.parent.mkdir(parents=True, exist_ok=True)
        atomic_write(sheet, style_plot(read_style(style), style.stem, _PX))


def is_arranged(style: Path) -> bool:
    """Return whether it is known how the hand of a style, given by its JSON file, arranges its strokes."""
    from maulstick.style.store import read_style  # loads torch

    return read_style(style).arrangement is not None


def map_of(styles: dict[str, Path]) -> Map:
    """Map the strokes of the styles' hands. styles: their JSON files by name."""
    from maulstick.plots.latent_map import places_of  # these load torch
    from maulstick.strokes.strokes import path_lengths
    from maulstick.studio.workers.spread import spread_apart
    from maulstick.style.store import read_style

    read = [read_style(path) for path in styles.values()]
    found = places_of(read)
    which = list(zip(found.whose, found.rows, strict=True))
    paths, pressure, speeds = (
        np.stack([getattr(read[style].hand, field)[row] for style, row in which])
        for field in ("paths", "pressure", "speeds")
    )
    return Map(
        tuple(styles),
        found.whose,
        spread_apart(found.places, _PROPORTION),
        found.glyphs,
        paths,
        path_lengths(paths),
        np.median(speeds, axis=1),
        pressure.mean(axis=1),
        sum(len(style.hand) for style in read),
    )


def differences_of(styles: dict[str, Path]) -> tuple[Difference, ...]:
    """Compare each pair of the styles. styles: their JSON files by name."""
    from maulstick.style.compare import Comparison  # these load torch
    from maulstick.style.store import read_style

    paths = {name: read_style(path).hand.paths for name, path in styles.items()}
    pairs = [(first, second) for number, first in enumerate(paths) for second in list(paths)[number + 1 :]]
    found = {pair: Comparison.of(paths[pair[0]], paths[pair[1]], np.random.default_rng(0)) for pair in pairs}
    return tuple(
        Difference(*pair, max(each.distance, 0.0) / _TWO_PEOPLE, each.accuracy, each.told, each.shared)
        for pair, each in found.items()
    )
