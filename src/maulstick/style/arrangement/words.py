"""An arrangement in words."""

import numpy as np
import shapely

from maulstick.strokes.strokes import path_lengths
from maulstick.style.arrangement.arrangement import LARGEST_GROUP, Arrangement
from maulstick.style.arrangement.laid import NEAREST, distance
from maulstick.style.arrangement.neighbourhoods import MEAN_GAP

_PARALLEL, _LOOSE = 0.6, 0.2  # mean of cos 2Δθ of strokes side by side, times their straightness; 0: any direction
_LEANING = 0.3  # resultant of the directions: below, strokes go all ways
_LEVEL = np.pi / 8  # radians off level or upright
_RARELY, _OFTEN = 0.5, 2.0  # others that a stroke crosses
_LAP = 0.15  # of a stroke's length, of the median one for gaps: less is neither a lap nor a gap
_IN_ORDER = 1.4  # median length of the first half of a drawing over that of the last, or the reverse


def told(arrangement: Arrangement, recordings: int = 1) -> str:
    """Return how the strokes are arranged, in a sentence: groups, direction, spacing, crossings, joints, order.

    recordings: so many are laid side by side. Nothing is told of the order in several, as nobody drew them in one go.
    """
    size = np.median([len(rows) for rows in arrangement.groups for _ in rows])
    near = arrangement.neighbourhoods
    parallel = float(near.numbers[:, NEAREST : 2 * NEAREST].mean())
    way = "parallel" if parallel >= _PARALLEL else "roughly parallel" if parallel >= _LOOSE else "in all directions"
    more = " or more" if size >= LARGEST_GROUP else ""
    company = f"groups of {size:.0f}{more}" if size > 1 else "single strokes"
    apart = 1e3 * near.unit * float(distance(near.numbers[:, MEAN_GAP].median()))
    parts = [f"{company}, {way}{_leaning(arrangement)}, {_millimetres(apart)} apart", _crossing(arrangement)]
    return "; ".join([*parts, *_joints(arrangement), *(_order(arrangement) if recordings == 1 else [])])


def _millimetres(apart: float) -> str:
    return f"{apart:.1f} mm" if apart >= 0.1 else f"{round(apart, 3):.1g} mm"


def _leaning(arrangement: Arrangement) -> str:
    """Return which way most strokes lie, seen on a sheet whose y goes down; nothing where they lie all ways."""
    if abs(arrangement.leaning) < _LEANING:
        return ""
    angle = float(np.angle(arrangement.leaning)) / 2 % np.pi
    if min(angle, np.pi - angle) < _LEVEL:
        return ", level"
    if abs(angle - np.pi / 2) < _LEVEL:
        return ", upright"
    return ", leaning left" if angle < np.pi / 2 else ", leaning right"


def _crossing(arrangement: Arrangement) -> str:
    lines = shapely.linestrings(arrangement.paths)
    each = shapely.STRtree(lines).query(lines, predicate="crosses").shape[1] / len(lines)
    return "cross rarely" if each < _RARELY else "cross often" if each > _OFTEN else "cross now and then"


def _joints(arrangement: Arrangement) -> list[str]:
    """Return how strokes of one line lie to each other; nothing where few lines have several."""
    laps = arrangement.laps
    if not len(laps):
        return []
    if np.mean(np.abs(laps) < _LAP) > 0.5:
        return ["meet along a line"]
    lap = float(np.median(laps))
    way = "lap" if lap > _LAP else "leave gaps" if lap < -_LAP else "lap here and leave gaps there"
    return [f"{way} along a line"]


def _order(arrangement: Arrangement) -> list[str]:
    lengths = path_lengths(arrangement.paths)
    first, last = (np.median(half) for half in np.array_split(lengths, 2))
    if max(first, last) < _IN_ORDER * min(first, last):
        return []
    return ["long strokes first" if first > last else "short strokes first"]
