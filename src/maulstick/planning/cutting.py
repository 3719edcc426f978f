"""Strokes that run off the sheet, because they are longer than it: each is cut where it leaves the sheet."""

import numpy as np

from maulstick.painting.painting import Sheet
from maulstick.storage.arrays import Floats

_SAMPLES = 64  # per segment of a trajectory: a stroke ends within 1/64 of a segment of the edge, and before it
_ROUNDING = 1e-6  # metres beyond the edge that float32 makes of a stroke that lies just on the sheet


def cut_at_edges(trajectories: Floats, sheet: Sheet) -> Floats:
    """Return trajectories (N, n, k) of x, y in metres and more, cut to their longest piece on the sheet, of n points.

    Those that lie on the sheet stay as they are; those of which no piece does shrink to a dot at its nearest place.
    """
    cut = trajectories.copy()
    for row in np.flatnonzero(sheet.overhang(trajectories[..., :2]) > _ROUNDING):
        cut[row] = _longest_piece(trajectories[row], sheet)
    return cut


def _longest_piece(trajectory: Floats, sheet: Sheet) -> Floats:
    """Return the longest piece of a trajectory (n, k) that lies on the sheet, as n points."""
    n, size = len(trajectory), (sheet.width, sheet.height)

    def at(places: Floats) -> Floats:
        return np.stack([np.interp(places, np.arange(n), column) for column in trajectory.T], axis=1)

    places = np.linspace(0, n - 1, _SAMPLES * (n - 1) + 1)
    xy = at(places)[:, :2]
    inside = ((xy >= 0) & (xy <= size)).all(axis=1)
    changes = np.flatnonzero(np.diff(inside, prepend=False, append=False))  # pieces begin and end in turn
    if not len(changes):
        dot = at(places[np.maximum(-xy, xy - size).max(axis=1).argmin(keepdims=True)])
        return np.repeat(np.concatenate([dot[:, :2].clip(0, size), dot[:, 2:]], axis=1), n, axis=0)
    starts, ends = changes[::2], changes[1::2]
    longest = np.argmax(ends - starts)
    return at(np.linspace(places[starts[longest]], places[ends[longest] - 1], n))
