"""Arrangement: how a hand's strokes lie beside and after one another."""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
import shapely
import torch

from maulstick.painting.succession import Succession
from maulstick.storage.arrays import Complexes, Floats, Ints
from maulstick.strokes.strokes import path_lengths, place
from maulstick.style.arrangement.joints import laps_of
from maulstick.style.arrangement.laid import Laid
from maulstick.style.arrangement.neighbourhoods import LEAST_GAP, Neighbourhoods
from maulstick.style.arrangement.order import succession_of

FEWEST = 30
"""Least number of strokes that an arrangement can be learned from."""

LARGEST_GROUP = 10
"""Most strokes of a group: longer runs are parted, so that a plan has places for their parts."""

_LEAST_IN_COMPANY = 0.5  # share of strokes that have another within a median length; below, a hand scatters them


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
        if len(poses) < FEWEST:
            return None
        arrangement = cls(place(paths, poses), poses[:, 2])
        near = arrangement.neighbourhoods.numbers[:, LEAST_GAP] < 0  # log of median lengths
        return arrangement if near.double().mean() >= _LEAST_IN_COMPANY else None

    @cached_property
    def laid(self) -> Laid:
        """The strokes as far as their neighbourhoods depend on them."""
        paths = torch.from_numpy(self.paths)
        return Laid.of(paths, paths.mean(dim=1), paths.new_zeros(len(paths)))

    @cached_property
    def directions(self) -> Complexes:
        """Which way each stroke lies, (M,): exp(2i angle) of its principal axis, times its length and straightness."""
        laid = self.laid
        found: Complexes = (laid.lengths * laid.straightness * (2j * laid.axes).exp()).numpy()
        return found

    @cached_property
    def leaning(self) -> complex:
        """Which way the hand leans: its strokes' mean direction, from 0 to 1 in size, 1 where all lie alike."""
        return complex(self.directions.sum() / float(self.laid.lengths.sum()))

    @cached_property
    def alignments(self) -> Floats:
        """How far each stroke lies along its group, (M,): cos 2Δθ from the group's direction, times straightness."""
        main = np.zeros(len(self.paths))
        for rows in self.groups:
            main[rows] = np.angle(self.directions[rows].sum())
        found: Floats = (self.directions * np.exp(-1j * main)).real / self.laid.lengths.numpy()
        return found

    @cached_property
    def neighbourhoods(self) -> Neighbourhoods:
        """How each stroke lies to those near it."""
        return Neighbourhoods.of(self.laid)

    @cached_property
    def groups(self) -> tuple[Ints, ...]:
        """Rows of the strokes of each group: at most ten consecutive ones, each near the one before.

        Near is within the median length of a stroke.
        """
        lines = shapely.linestrings(self.paths)
        apart = shapely.distance(lines[1:], lines[:-1]) > np.median(path_lengths(self.paths))
        runs = np.split(np.arange(len(self.paths)), np.flatnonzero(apart) + 1)
        return tuple(run[first : first + LARGEST_GROUP] for run in runs for first in range(0, len(run), LARGEST_GROUP))

    @cached_property
    def laps(self) -> Floats:
        """How far strokes go on beside the one that takes up their line, (J,), as `laps_of` returns it."""
        return laps_of(self.paths)

    @cached_property
    def succession(self) -> Succession:
        """Which stroke comes after which."""
        return succession_of(self.paths)

    def size_for(self, strokes: int, area: float) -> float:
        """Return times how large the hand draws, at most 1, so that so many strokes lie no denser than its own.

        area: where they lie, square metres.
        """
        own = self.neighbourhoods
        return float(min(1.0, np.sqrt(own.density * area / strokes) / own.unit))
