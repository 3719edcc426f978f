"""Hands: the strokes that a style is learned from, with their pressure and speed."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
import torch
from torch import Generator, Tensor

from maulstick.errors import InputError
from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import POINTS, Strokes
from maulstick.style.arrangement import Arrangement
from maulstick.style.cards import FEWEST
from maulstick.style.pressure import KNOTS, fit_knots
from maulstick.style.traits import path_length, quantiles

LONGEST = 100.0
"""Longest stroke, and farthest place of one, metres: as large as a sheet may be."""

_MOST = 20_000  # strokes: 16,000 took 19 s and 3.2 GB, which grow by the square
_SHORTEST = 1e-3  # metres; anything shorter is a dot
_SLOWEST, _QUICKEST = 1e-3, 2.0  # metres per second: bounds against pauses and errors in the recorded times
_PRESSURE_VARIES = 0.15  # standard deviation of a knot's pressure about that of the hand's stroke, in `pressure_cost`
_PRESSURE_UNKNOWN = 0.3  # the same where pressure was not recorded, so wider


@dataclass(frozen=True)
class Hand:
    """Strokes of one hand, M of them.

    paths: (M, 32, 2), standardised, metres.  pressure: (M, 4) knots in [0, 1], NaN where a stroke's was not recorded.
    speeds: (M, 32), metres per second at each point, NaN where a stroke's times were not recorded.
    poses: (M, 3), which put strokes of one drawing back where they were drawn, in the order drawn; None where that is
    unknown.
    """

    paths: Floats
    pressure: Floats
    speeds: Floats
    poses: Floats | None = None

    @classmethod
    def of(cls, strokes: Strokes) -> Self:
        """Return the hand of all strokes that are at least a millimetre long.

        Raises InputError for fewer than five or over 20,000, and where one is longer or lies farther than `LONGEST`.
        """
        strokes = strokes[strokes.lengths >= _SHORTEST]
        if len(strokes) < FEWEST:
            allowed = f"at least {FEWEST}, and 20 make a good style; draw more"
            raise InputError.of_range("the number of strokes of a millimetre or more", len(strokes), allowed)
        if len(strokes) > _MOST:
            raise InputError.of_range("the number of strokes", len(strokes), f"at most {_MOST}; learn from fewer files")
        if strokes.trajectories.shape[1] != POINTS:
            raise InputError.of_range("the points of a stroke", strokes.trajectories.shape[1], f"{POINTS}")
        if (longest := float(strokes.lengths.max())) > LONGEST:
            allowed = f"at most {LONGEST:g} m; check the recording's unit"
            raise InputError.of_range("the longest stroke", f"{longest:.4g} m", allowed)
        if (farthest := float(np.abs(strokes.poses[:, :2]).max())) > LONGEST:
            allowed = f"at most {LONGEST:g} m, recordings side by side; learn from fewer or smaller ones"
            raise InputError.of_range("how far strokes lie", f"{farthest:.4g} m", allowed)
        paths = strokes.trajectories[..., :2]
        return cls(paths, fit_knots(strokes.trajectories[..., 2]), _speeds(paths, strokes.times), strokes.poses)

    def __len__(self) -> int:
        return len(self.paths)

    def scaled(self, times: float) -> Self:
        """Return the hand that draws so many times as large, in the same time (isochrony: Viviani and McCollum)."""
        poses = None if self.poses is None else self.poses * [times, times, 1]
        return replace(self, paths=self.paths * times, speeds=self.speeds * times, poses=poses)

    @cached_property
    def arrangement(self) -> Arrangement | None:
        """How the strokes are arranged; None where it is unknown, or they are too few or too scattered."""
        return None if self.poses is None else Arrangement.of(self.paths, self.poses)

    def lengths(self, count: int) -> Tensor:
        """Lengths (count,), metres, ascending, of so many strokes of the hand: the quantiles of those it drew."""
        return torch.quantile(path_length(torch.from_numpy(self.paths)), quantiles(count))

    def choose(self, k: int, generator: Generator) -> Tensor:
        """Draw the rows of k strokes of the hand, (k,)."""
        return torch.randint(len(self), (k,), generator=generator)

    def sample_pressure(self, rows: Tensor, generator: Generator) -> Tensor:
        """Pressure knots (k, 4) of the strokes `rows` (k,); constant and random where pressure was not recorded."""
        even = torch.rand(len(rows), 1, generator=generator).expand(-1, KNOTS)
        seen = torch.from_numpy(self.pressure).to(even)[rows]
        return torch.where(seen.isfinite(), seen, even).clone()

    def pressure_cost(self, pressure_knots: Tensor, rows: Tensor) -> Tensor:
        """Cost (N,), nats, of pressure knots (N, 4) that rise and fall differently from the strokes `rows` (N,).

        Their mean is free, because it makes a mark as wide as the picture needs.
        """
        usual, spread = (numbers.to(pressure_knots).index_select(0, rows) for numbers in self._usual_pressure)
        return ((_centred(pressure_knots) - usual) / spread).square().sum(1) / 2

    @cached_property
    def _usual_pressure(self) -> tuple[Tensor, Tensor]:
        """Knots (M, 4) about the mean of each stroke's, and their spread, as a plan holds them: float32."""
        seen = torch.from_numpy(self.pressure)
        spread = torch.where(seen.isfinite(), _PRESSURE_VARIES, _PRESSURE_UNKNOWN)
        return _centred(seen.float().nan_to_num()), spread.float()

    def speeds_of(self, rows: Tensor) -> Tensor | None:
        """Speeds (N, 32) of the strokes `rows` (N,), metres per second; None where no stroke has any.

        A stroke without times gets the hand's average speeds.
        """
        known = np.isfinite(self.speeds[:, 0])
        if not known.any():
            return None
        usual = np.exp(np.log(self.speeds[known]).mean(axis=0))
        return torch.from_numpy(np.where(known[:, None], self.speeds, usual))[rows]


def by_length(lengths: Tensor, rooms: Tensor) -> Tensor:
    """Return the index of the stroke for each place, (k,): the longest of `lengths` (k,) for the largest of `rooms`."""
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
