"""Whole drawings by people that arrangement is measured with, in halves: measured with only, but for the Wacom ones."""

from functools import cache

import numpy as np
from numpy.typing import NDArray
from recordings import human_drawings, mocap_hands, wacom_drawings

from maulstick.strokes.strokes import Strokes

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

HANDS = ("lia", "strokes", "elephant", "Koala04", "moscow", "giacometti", "house", "fruit")
"""Hands that plans are made in, chosen by how different their drawings look before any plan was made.

Two of mocap (scribbled hatching, scattered marks), two of Wacom (hatching along contours; contours, filled patches and
writing); short strokes over each other along contours, scribbles over a figure, architecture, loose ellipses.
"""
TUNE_NOTHING = ("house", "fruit")
QUICK = HANDS[:4]

ENOUGH = 80
"""Strokes that a drawing must have."""
SPLITS = (0.0, 0.5, 0.25, 0.75)
"""Where the half begins that is learned from, as a share of the strokes in the order drawn; behind the last comes the
first. The other half judges."""


@cache
def drawings() -> dict[str, Strokes]:
    """The strokes of 42 drawings in the order drawn, dots left out; the hands' names are among theirs."""
    mocap, wacom = mocap_hands(), wacom_drawings()
    large = {name: strokes for name, strokes in human_drawings().items() if len(strokes) >= ENOUGH}
    return {
        **large,
        **{name: mocap[name] for name in ("lia", "strokes")},
        **{name: wacom[name] for name in ("moscow", "animal", "elephant")},
    }


def halves(count: int, split: int) -> tuple[Ints, Ints]:
    """Which of so many strokes are learned from, and which judge; both in the order drawn."""
    rows = np.roll(np.arange(count), -int(SPLITS[split] * count))
    return rows[: count // 2], rows[count // 2 :]


def placed(strokes: Strokes) -> Floats:
    """Paths (N, 32, 2) where they were drawn, metres."""
    return strokes.placed()[..., :2]
