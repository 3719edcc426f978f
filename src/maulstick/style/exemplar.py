"""A hand by its examples: its own strokes, and a smooth density around them. Fitted in a fraction of a second."""

import hashlib
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
import torch
from torch import Generator, Tensor
from torch.nn.functional import normalize

from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import POINTS
from maulstick.style import shape
from maulstick.style.compare import CURVINESS, describe
from maulstick.style.density import Density, kernel
from maulstick.style.hand import Hand, by_length
from maulstick.style.shape import GIST
from maulstick.style.style import Style

_LENGTH, _SHAPE = 0, slice(1, GIST)
_ROUGHNESS = GIST
_BANDWIDTH_FREE, _BANDWIDTH_BOUND = 0.95, 0.8
_BANDWIDTH_OF_COST = 0.4
_BANDWIDTHS_TOGETHER = torch.tensor([0.08] + [0.25] * GIST, dtype=torch.float64)  # length would pay most
_BANDWIDTH_OF_LENGTH = 0.4
_BANDWIDTH_OF_ROUGHNESS = 0.2
_LEAST_RESIDUAL = 1e-4
_OTHERS = 0.6
_LEAST_BEND, _MOST_BEND = 0.05, 1.5
_FREEDOMS = (1.0, 0.67, 0.33, 0.0)
_TRIALS = 300
_SURE = 2.0


@dataclass(frozen=True)
class PooledHands:
    """What many hands have in common (of strokes that may ship; see NOTICE).

    covariance: (17, 17), within a hand, of a stroke's gist and of how large its residual is (`gist_and_roughness`).
    residual: (47,) usual size of the residual's numbers.
    """

    covariance: Floats
    residual: Floats

    @property
    def units(self) -> Floats:
        """(63,): what is a large change of a stroke's numbers (`shape.encode`)."""
        return np.concatenate([np.sqrt(np.diag(self.covariance)[:GIST]), self.residual])


@dataclass(frozen=True)
class Exemplar(Style):
    """A code is a stroke's gist and residual (`style.shape`), in units of what is usual among hands.

    Its likelihood is that of its gist and of how large its residual is; the residual's direction is free.

    name: what the painting file calls it.  hand: whose strokes.  hands: what others have in common.
    max_mean_cost: as in `Style`.
    freedom: in [0, 1], how far samples may leave the hand's strokes. At 0 a straight stroke stays straight and keeps
    its residual; at 1 all strokes are bent alike, and most of the residual comes from the hand's others.
    """

    name: str
    hand: Hand
    hands: PooledHands
    freedom: float
    max_mean_cost: float = 1.5

    @classmethod
    def fit(cls, name: str, hand: Hand, hands: PooledHands) -> Self:
        """With the most freedom that leaves samples as bent, as rough and as wavy as the hand's strokes on average."""
        seen = describe(hand.paths)[:, CURVINESS]
        allowed = _SURE * seen.std(axis=0, ddof=1) / np.sqrt(len(seen)) + 1e-9
        style = cls(name, hand, hands, _FREEDOMS[-1])
        for freedom in _FREEDOMS[:-1]:
            freer = replace(style, freedom=freedom)
            codes, _ = freer.sample(_TRIALS, torch.Generator().manual_seed(0))
            drawn = describe(freer.decode(codes).double().numpy())[:, CURVINESS]
            if (np.abs(drawn.mean(axis=0) - seen.mean(axis=0)) <= allowed).all():
                return freer
        return style

    @cached_property
    def hash(self) -> str:
        """Of all that decoding depends on."""
        return hashlib.sha256(b"exemplar" + self.hands.units.tobytes()).hexdigest()[:16]

    @cached_property
    def _units(self) -> Tensor:
        return torch.from_numpy(self.hands.units)

    @cached_property
    def _numbers(self) -> Tensor:
        return shape.encode(torch.from_numpy(self.hand.paths))

    @cached_property
    def _centres(self) -> Tensor:
        return gist_and_roughness(self._numbers)

    @cached_property
    def _covariance(self) -> Tensor:
        return torch.from_numpy(kernel(self._centres.numpy(), self.hands.covariance))

    @cached_property
    def _sampled(self) -> Density:
        bandwidth = self.freedom * _BANDWIDTH_FREE + (1 - self.freedom) * _BANDWIDTH_BOUND
        return self._around(bandwidth, 1 - self.freedom)

    @cached_property
    def _priced(self) -> Density:
        return self._around(_BANDWIDTH_OF_COST, 1)

    def _around(self, bandwidth: float, power: float) -> Density:
        usual = np.sqrt(np.diag(self.hands.covariance))
        bends = np.linalg.norm((self._centres.numpy() - _straight())[:, _SHAPE] / usual[_SHAPE], axis=1)
        bends = np.clip((bends / np.sqrt(np.square(bends).mean())) ** power, _LEAST_BEND, _MOST_BEND)
        scales = np.full(self._centres.shape, bandwidth)
        scales[:, _SHAPE] *= bends[:, None]
        scales[:, _LENGTH] = min(bandwidth, _BANDWIDTH_OF_LENGTH)
        scales[:, _ROUGHNESS] = _BANDWIDTH_OF_ROUGHNESS
        return Density(self._centres, torch.from_numpy(scales), self._covariance)

    def encode(self, paths: Tensor) -> Tensor:
        """Codes (N, 63) of standardised paths (N, 32, 2), which decode to the same paths again."""
        return shape.encode(paths) / self._units.to(paths)

    def decode(self, codes: Tensor) -> Tensor:
        """Paths (N, 32, 2) of codes (N, 63), standardised but for their residual.

        No gradient flows into the residual: how a hand trembles is not for a planner to draw with.
        """
        return shape.decode(self._numbers_of(codes))

    def _numbers_of(self, codes: Tensor) -> Tensor:
        return torch.cat([codes[:, :GIST], codes[:, GIST:].detach()], dim=1) * self._units.to(codes)

    def sample(self, k: int, generator: Generator) -> tuple[Tensor, Tensor]:
        """Strokes near the hand's own, with residuals like theirs, pressed as they were."""
        drawn, around = self._sampled.sample(k, generator)
        directions = normalize(self._numbers[:, GIST:], dim=1)
        shares = torch.randn(k, len(directions), generator=generator).to(directions) / len(directions) ** 0.5
        others = self.freedom * _OTHERS
        mixed = others * shares @ directions + (1 - others) * directions[around]
        residuals = normalize(mixed, dim=1) * drawn[:, GIST:].exp()
        codes = torch.cat([drawn[:, :GIST], residuals], dim=1) / self._units
        return codes.float(), self.hand.sample_pressure(around, generator)

    def sample_for(self, lengths: Tensor, generator: Generator) -> tuple[Tensor, Tensor]:
        """As many strokes as there are places, the longest where there is most room."""
        codes, pressure_knots = self.sample(len(lengths), generator)
        chosen = by_length(codes[:, 0], lengths)
        return codes[chosen], pressure_knots[chosen]

    def cost(self, codes: Tensor, pressure_knots: Tensor) -> Tensor:
        """That of the strokes' numbers; no gradient flows into the residual."""
        return self.price(self._numbers_of(codes), pressure_knots)

    def price(self, numbers: Tensor, pressure_knots: Tensor) -> Tensor:
        """How far each stroke is from the nearest of the hand's, and all of them together from how the hand's vary.

        numbers: (N, 63), of strokes (`style.shape`).  pressure_knots: (N, 4).

        The first is of the gist, of how large the residual is, and of how pressure rises and falls. The second keeps
        the strokes of a plan from becoming long, or flat, one by one: in each number of the gist they are to be spread
        as the hand's are (squared distance of sorted values, Wasserstein's in one dimension).
        """
        points = gist_and_roughness(numbers).double()
        nearest = self._priced.nearest(points.detach())
        alone = self._priced.cost(points)
        together = (points - self._as_spread(points.detach())) / (
            _BANDWIDTHS_TOGETHER * self._covariance.diagonal().sqrt()
        )
        return (alone + together.square().sum(1) / 2).to(numbers) + self.hand.pressure_cost(pressure_knots, nearest)

    def _as_spread(self, points: Tensor) -> Tensor:
        """Points (N, 17) in the same order in each of their numbers, and spread as the hand's."""
        ranks = points.argsort(dim=0, stable=True).argsort(dim=0)
        quantiles = (torch.arange(len(points), dtype=torch.float64) + 0.5) / len(points)
        return torch.quantile(self._centres, quantiles, dim=0).gather(0, ranks)

    def speeds(self, codes: Tensor) -> Tensor | None:
        """As fast as the hand's stroke that is most like it."""
        return self.hand.speeds_of(self._priced.nearest(gist_and_roughness(self._numbers_of(codes))))


def gist_and_roughness(numbers: Tensor) -> Tensor:
    """What a stroke is likely by, (N, 17): its gist, and the logarithm of how large its residual is."""
    residual = numbers[:, GIST:].square().sum(1, keepdim=True)
    return torch.cat([numbers[:, :GIST], (residual + _LEAST_RESIDUAL**2).log() / 2], dim=1)


def pool(hands: list[Hand]) -> PooledHands:
    """What these hands have in common; each counts by its strokes, but no more than by sixty."""
    numbers = [shape.encode(torch.from_numpy(hand.paths)) for hand in hands]
    weights = np.array([min(len(hand), 60) for hand in hands], dtype=np.float64)
    spreads = [np.cov(gist_and_roughness(each).numpy(), rowvar=False) for each in numbers]
    residuals = [each[:, GIST:].square().mean(0).numpy() for each in numbers]
    covariance = np.average(spreads, axis=0, weights=weights)
    return PooledHands(covariance, np.sqrt(np.average(residuals, axis=0, weights=weights)))


def _straight() -> Floats:
    along = torch.linspace(0, 1, POINTS, dtype=torch.float64)
    line = torch.stack([along, torch.zeros_like(along)], dim=-1)[None]
    straight: Floats = gist_and_roughness(shape.encode(line)).numpy()
    return straight
