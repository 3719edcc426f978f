"""What is kept of a hand: the strokes that a style was learned from, and how they were pressed and how fast."""

from dataclasses import dataclass
from typing import Self

import numpy as np
import torch
from torch import Generator, Tensor

from maulstick.errors import InputError
from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import POINTS, Strokes
from maulstick.style.cards import FEWEST
from maulstick.style.pressure import KNOTS, fit_knots

_SHORTEST = 1e-3  # metres; what is shorter is a dot
_SLOWEST, _QUICKEST = 1e-3, 2.0  # metres a second
_PRESS_VARIES = 0.15
_PRESS_UNKNOWN = 0.3


@dataclass(frozen=True)
class Hand:
    """M strokes of one hand.

    paths: (M, 32, 2), standardised, metres.  pressure: (M, 4) knots in [0, 1], NaN where a stroke's was not recorded.
    speeds: (M, 32), metres a second at each point, NaN where a stroke's times were not recorded.
    """

    paths: Floats
    pressure: Floats
    speeds: Floats

    @classmethod
    def of(cls, strokes: Strokes) -> Self:
        """The strokes that are long enough to have a shape: at least a millimetre. Raises InputError below five."""
        strokes = strokes[strokes.lengths >= _SHORTEST]
        if len(strokes) < FEWEST:
            allowed = f"at least {FEWEST}, and 20 make a good style; draw more"
            raise InputError.of_range("the number of strokes of a millimetre or more", len(strokes), allowed)
        if strokes.trajectories.shape[1] != POINTS:
            raise InputError.of_range("the points of a stroke", strokes.trajectories.shape[1], f"{POINTS}")
        paths = strokes.trajectories[..., :2]
        return cls(paths, fit_knots(strokes.trajectories[..., 2]), _speeds(paths, strokes.times))

    def __len__(self) -> int:
        return len(self.paths)

    def sample_pressure(self, rows: Tensor, generator: Generator) -> Tensor:
        """Press knots (k, 4) as in the strokes `rows` (k,); even ones of any depth where pressure was not recorded."""
        even = torch.rand(len(rows), 1, generator=generator).expand(-1, KNOTS)
        seen = torch.from_numpy(self.pressure).to(even)[rows]
        return torch.where(seen.isfinite(), seen, even).clone()

    def pressure_cost(self, pressure_knots: Tensor, rows: Tensor) -> Tensor:
        """How unlike the strokes `rows` (N,) the pressure knots (N, 4) rise and fall, (N,), nats.

        Their mean is left free: it makes a mark as wide as a picture needs it.
        """
        seen = torch.from_numpy(self.pressure).to(pressure_knots)[rows]
        spread = torch.where(seen.isfinite(), _PRESS_VARIES, _PRESS_UNKNOWN)
        differs = _centred(pressure_knots) - _centred(seen.nan_to_num())
        return (differs / spread).square().sum(1) / 2

    def speeds_of(self, rows: Tensor) -> Tensor | None:
        """Speeds (N, 32) of the strokes `rows`, (N,), metres a second.

        A stroke without times takes those of the hand on average; None where no stroke has any.
        """
        known = np.isfinite(self.speeds[:, 0])
        if not known.any():
            return None
        usual = np.exp(np.log(self.speeds[known]).mean(axis=0))
        return torch.from_numpy(np.where(known[:, None], self.speeds, usual))[rows]


def by_length(lengths: Tensor, rooms: Tensor) -> Tensor:
    """Which of the strokes with these lengths (k,) goes to each place with this room, (k,): the longest to the most."""
    chosen = torch.empty(len(rooms), dtype=torch.long)
    chosen[rooms.argsort(stable=True)] = lengths.argsort(stable=True)
    return chosen


def _centred(knots: Tensor) -> Tensor:
    return knots - knots.mean(dim=1, keepdim=True)


def _speeds(paths: Floats, times: Floats) -> Floats:
    steps = np.linalg.norm(np.diff(paths, axis=1), axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        between = steps / np.diff(times, axis=1)
    between = np.where(np.isnan(times[:, :-1]), np.nan, np.nan_to_num(between, nan=0.0).clip(_SLOWEST, _QUICKEST))
    return np.concatenate([between[:, :1], (between[:, 1:] + between[:, :-1]) / 2, between[:, -1:]], axis=1)
