"""What the desk does for the styles: their sheets, their maps, and how they differ."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from maulstick.storage.arrays import Floats
from maulstick.storage.files import atomic_write

_PX = 1024


@dataclass(frozen=True)
class Map:
    """N strokes of the hands of some styles, and where they lie.

    names: of the styles.  whose: (N,), the number of its style.  places, glyphs: see `maulstick.plots.latent_map`.
    paths: (N, 32, 2), metres, standardised.  lengths: (N,), metres.  speeds: (N,), metres a second, the median along
    the stroke.  pressure: (N,), in [0, 1], the mean.  Speeds and pressure are NaN where nobody knows.
    strokes: of all hands     together, of which those on the map are some.
    """

    names: tuple[str, ...]
    whose: NDArray[np.int64]
    places: Floats
    glyphs: Floats
    paths: Floats
    lengths: Floats
    speeds: Floats
    pressure: Floats
    strokes: int


@dataclass(frozen=True)
class Difference:
    """Between the strokes of two styles' hands.

    distance: 0 for two parts of one hand, 1 as two people differ on average.
    accuracy: how many of the strokes give away whose they are, in [0, 1]; half of them would by chance.
    words: what the second hand's do beside the first's.  shared: how many strokes are both hands', in [0, 1].
    """

    first: str
    second: str
    distance: float
    accuracy: float
    words: str
    shared: float


_TWO_PEOPLE = 1.8
"""The energy distance of two people's strokes on average, as it was measured (design §5)."""


def draw_sheet(style: Path, sheet: Path) -> None:
    """Draw the sheet of the style whose JSON that is, unless it is there already."""
    from maulstick.plots.style import style_plot  # these load torch
    from maulstick.style.store import read_style

    if not sheet.exists():
        sheet.parent.mkdir(parents=True, exist_ok=True)
        atomic_write(sheet, style_plot(read_style(style), style.stem, _PX))


def map_of(styles: dict[str, Path]) -> Map:
    """Where the strokes of the styles' hands lie. styles: by name, their JSON."""
    from maulstick.plots.latent_map import places_of  # these load torch
    from maulstick.strokes.strokes import path_lengths
    from maulstick.style.store import read_style

    read = [read_style(path) for path in styles.values()]
    at = places_of(read)
    which = list(zip(at.whose, at.rows, strict=True))
    paths, pressure, speeds = (
        np.stack([getattr(read[style].hand, field)[row] for style, row in which])
        for field in ("paths", "pressure", "speeds")
    )
    return Map(
        tuple(styles),
        at.whose,
        at.places,
        at.glyphs,
        paths,
        path_lengths(paths),
        np.median(speeds, axis=1),
        pressure.mean(axis=1),
        sum(len(style.hand) for style in read),
    )


def differences_of(styles: dict[str, Path]) -> tuple[Difference, ...]:
    """Of each pair of the styles. styles: by name, their JSON."""
    from maulstick.style.compare import Comparison  # these load torch
    from maulstick.style.store import read_style

    paths = {name: read_style(path).hand.paths for name, path in styles.items()}
    pairs = [(first, second) for number, first in enumerate(paths) for second in list(paths)[number + 1 :]]
    found = {pair: Comparison.of(paths[pair[0]], paths[pair[1]], np.random.default_rng(0)) for pair in pairs}
    return tuple(
        Difference(*pair, max(each.distance, 0.0) / _TWO_PEOPLE, each.accuracy, each.told, each.shared)
        for pair, each in found.items()
    )
