"""Which groups of strokes are copies: the same strokes beside one another, moved and turned as a whole.

Points of the plane are complex numbers here, which makes a motion z → turn · z + shift.
"""

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from maulstick.strokes.strokes import path_lengths

Floats = NDArray[np.float64]
Complex = NDArray[np.complex128]

MOST, FEWEST = 10, 3
"""Strokes of a group, and of one that may be called a copy."""
_ALIKE = 0.1  # RMS distance of a copy's points, in the size of the group: their RMS distance from its centre


def groups(paths: Floats) -> list[Floats]:
    """Runs of at most ten consecutive strokes of (N, n, 2), each within one median length of the one before."""
    lines = shapely.linestrings(paths)
    apart = shapely.distance(lines[1:], lines[:-1]) > np.median(path_lengths(paths))
    runs = np.split(paths, np.flatnonzero(apart) + 1)
    return [run[first : first + MOST] for run in runs for first in range(0, len(run), MOST)]


def copied_share(paths: Floats, learned: Floats) -> float:
    """Share of a drawing's groups of three strokes and more that are copies; strokes (N, n, 2), learned (M, n, 2)."""
    theirs = as_complex(learned)
    found = [is_copy(as_complex(group), theirs) for group in groups(paths) if len(group) >= FEWEST]
    return float(np.mean(found)) if found else 0.0


def is_copy(group: Complex, learned: Complex) -> bool:
    """Whether the strokes (k, n) lie to one another as k of the learned (M, n) do, in any order, drawn either way.

    The longest stroke is laid on each learned one, drawn either way, where that alone does not make them too different;
    the others go to the learned strokes with the nearest centres, and then all together are laid on those.
    """
    if len(group) > len(learned):
        return False
    allowed = _ALIKE**2 * np.mean(np.abs(group - group.mean()) ** 2) * group.size
    longest = group[np.argmax(np.abs(np.diff(group)).sum(axis=1))]
    for laid_on in (learned, learned[:, ::-1]):
        turns, errors = _best_turns(longest, laid_on)
        for at in np.flatnonzero(errors <= allowed):
            moved = turns[at] * (group - longest.mean()) + laid_on[at].mean()
            far = np.abs(moved.mean(axis=1)[:, None] - learned.mean(axis=1))
            chosen = learned[linear_sum_assignment(far**2)[1]]
            backwards = _squares(moved - chosen[:, ::-1]) < _squares(moved - chosen)
            target = np.where(backwards[:, None], chosen[:, ::-1], chosen)
            if _best_turns(group.ravel(), target.reshape(1, -1))[1][0] <= allowed:
                return True
    return False


def _best_turns(points: Complex, onto: Complex) -> tuple[Complex, Floats]:
    """Turns (M,) about their centres that lay points (n,) best on each of (M, n), and the squared errors left (M,)."""
    ours, theirs = points - points.mean(), onto - onto.mean(axis=1, keepdims=True)
    product = theirs @ ours.conj()
    size = np.abs(product)
    turns = np.where(size > 0, product, 1) / np.where(size > 0, size, 1)
    return turns, _squares(ours) + _squares(theirs) - 2 * size


def _squares(points: Complex) -> Floats:
    return np.square(np.abs(points)).sum(axis=-1)


def as_complex(paths: Floats) -> Complex:
    """Points (..., 2) as complex numbers."""
    return paths[..., 0] + 1j * paths[..., 1]
