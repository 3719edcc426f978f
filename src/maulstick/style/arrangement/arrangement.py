"""Arrangement: how a hand's strokes lie beside and after one another."""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
import shapely
import torch

from maulstick.storage.arrays import Floats, Ints
from maulstick.strokes.strokes import path_lengths, place
from maulstick.style.arrangement.neighbourhoods import Laid, Neighbourhoods

FEWEST = 30
"""Least number of strokes that an arrangement can be learned from."""

_MOST = 10  # strokes of a group: longer runs are parted, so that a plan has places for its parts
_LEAST_IN_COMPANY = 0.5  # share of strokes that have another in their group; below, a hand scatters its strokes


@dataclass(frozen=True)
class Arrangement:
    """Places of M strokes of one drawing, in the order drawn.

    paths: (M, n, 2), where they were drawn, metres.  angles: (M,), of the standardised paths there, radians.
    """

    paths: Floats
    angles: Floats

    @classmethod
    def of(cls, paths: Floats, poses: Floats) -> Self | None:
        """Return the arrangement of standardised paths (M, n, 2) with poses (M, 3), in the order drawn.

        None where they are too few, or too scattered.
        """
        arrangement = cls(place(paths, poses), poses[:, 2])
        if len(poses) < FEWEST:
            return None
        in_company = sum(len(group) for group in arrangement.groups if len(group) > 1)
        return arrangement if in_company >= _LEAST_IN_COMPANY * len(poses) else None

    @cached_property
    def neighbourhoods(self) -> Neighbourhoods:
        """How each stroke lies to those near it."""
        paths = torch.from_numpy(self.paths)
        return Neighbourhoods.of(Laid.of(paths, paths.mean(dim=1), paths.new_zeros(len(paths))))

    @cached_property
    def groups(self) -> tuple[Ints, ...]:
        """Rows of the strokes of each group: at most ten consecutive ones, each near the one before.

        Near is within the median length of a stroke.
        """
        lines = shapely.linestrings(self.paths)
        apart = shapely.distance(lines[1:], lines[:-1]) > np.median(path_lengths(self.paths))
        runs = np.split(np.arange(len(self.paths)), np.flatnonzero(apart) + 1)
        return tuple(run[first : first + _MOST] for run in runs for first in range(0, len(run), _MOST))
