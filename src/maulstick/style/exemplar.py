"""Exemplar style: a hand's own strokes and a kernel density around them."""

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
from maulstick.style.arrangement import Arrangement
from maulstick.style.compare import CURVINESS, describe, kolmogorov_smirnov
from maulstick.style.density import Density, kernel
from maulstick.style.hand import Hand, by_length
from maulstick.style.lengths import keep_lengths
from maulstick.style.neighbours import Neighbours
from maulstick.style.pooled import PooledHands
from maulstick.style.shape import GIST
from maulstick.style.style import Style
from maulstick.style.trait_costs import gist_and_roughness, roughness, trait_costs, traits
from maulstick.style.traits import quantiles

_LENGTH, _SHAPE = 0, slice(1, GIST)  # columns of `gist_and_roughness`
_ROUGHNESS = GIST  # its last column
# Chosen by benchmarks/style_choices.py on Wacom documents and human drawings alone.
_BANDWIDTH = 0.3  # of samples (`Neighbours`): less copies strokes, more blurs kinds
_BANDWIDTH_LENGTH = 0.9  # of samples: lengths mix freely
_BANDWIDTH_ROUGHNESS = 0.1  # of samples: roughness is to stay the hand's
_FREEDOMS = (1.0, 0.67, 0.33, 0.0)  # that `fit` tries in this order
_TRIALS = 1000  # samples that `fit` compares with the hand
_APART = 0.05  # by so much may freedom take samples further from the hand, in `Exemplar.fit`
_OF_COST, _OF_COST_ROUGHNESS = 0.4, 0.2  # bandwidths of the density that `cost` is based on, in the hand's spreads
# Narrow for length, which pays most, and for what the eye sees first; unlike the others chosen on the mocap sessions.
_TOGETHER = torch.tensor([0.08] + [0.25] * GIST + [0.08, 0.08], dtype=torch.float64)
_LEAST_SPREAD = 0.05  # of a chord's log odds, and of turning in radians: where all strokes of a hand are alike
_LEAST_BEND, _MOST_BEND = 0.05, 1.5  # bounds of a kernel's scale in `cost`, which grows with the bend of its stroke


@dataclass(frozen=True)
class _Stays:
    """What follows from the residuals of codes, (N, 47): roughness (N, 1), and strays (N, 2, 32) off the spline."""

    codes: Tensor
    roughness: Tensor
    strays: Tensor


@dataclass(frozen=True, repr=False)
class Exemplar(Style):
    """Style of a hand by its examples: a code is a stroke's gist and residual (`style.shape`) in `PooledHands.units`.

    The likelihood of a stroke is that of its gist and of its residual's size; the residual's direction is free.

    name: as in the painting file.  hand: the strokes.  hands: statistics of many hands.
    max_mean_cost: as in `Style`.
    freedom: in [0, 1], how far the residual is tremor of the hand: at 0 a sample keeps the residual of the stroke that
    it was drawn around, at 1 it is mixed from those of all.
    """

    name: str
    hand: Hand
    hands: PooledHands
    freedom: float
    max_mean_cost: float = 1.0

    @classmethod
    def fit(cls, name: str, hand: Hand, hands: PooledHands) -> Self:
        """Return the style with the most freedom whose samples vary as the hand does in bends, roughness and waves."""
        bound = cls(name, hand, hands, _FREEDOMS[-1])
        own = describe(hand.paths)[:, CURVINESS]
        allowed = bound._apart(own, bound.freedom) + _APART
        for freedom in _FREEDOMS[:-1]:
            if (bound._apart(own, freedom) <= allowed).all():
                return replace(bound, freedom=freedom)
        return bound

    def _apart(self, own: Floats, freedom: float) -> Floats:
        """Kolmogorov-Smirnov distance of samples from the hand's own (M, 3), in how bent, rough and wavy, (3,)."""
        generator = torch.Generator().manual_seed(0)
        codes = self._codes_around(self.hand.choose(_TRIALS, generator), generator, freedom)
        drawn = describe(self.decode(codes).double().numpy())[:, CURVINESS]
        return np.array([kolmogorov_smirnov(*columns) for columns in zip(drawn.T, own.T, strict=True)])

    @cached_property
    def hash(self) -> str:
        """Hash of the units, which is all that decoding depends on."""
        return hashlib.sha256(b"exemplar" + self.hands.units.tobytes()).hexdigest()[:16]

    @property
    def arrangement(self) -> Arrangement | None:
        """How the hand arranges its strokes."""
        return self.hand.arrangement

    @cached_property
    def _units(self) -> Tensor:
        return torch.from_numpy(self.hands.units)

    @cached_property
    def _gist_units(self) -> Tensor:
        return self._units[:GIST].float()

    @cached_property
    def _numbers(self) -> Tensor:
        return shape.encode(torch.from_numpy(self.hand.paths))

    @cached_property
    def _centres(self) -> Tensor:
        return gist_and_roughness(*shape.parts(self._numbers))

    @cached_property
    def _covariance(self) -> Tensor:
        return torch.from_numpy(kernel(self._centres.numpy(), self.hands.covariance))

    @cached_property
    def _usual(self) -> Tensor:
        return torch.from_numpy(np.sqrt(np.diag(self.hands.covariance)))

    @cached_property
    def _neighbours(self) -> Neighbours:
        bandwidths = torch.full_like(self._usual, _BANDWIDTH)
        bandwidths[_LENGTH], bandwidths[_ROUGHNESS] = _BANDWIDTH_LENGTH, _BANDWIDTH_ROUGHNESS
        kept = torch.ones_like(bandwidths)
        kept[_LENGTH] = (1 - _BANDWIDTH_LENGTH**2) ** 0.5
        return Neighbours(self._centres / self._usual, bandwidths, kept)

    @cached_property
    def _priced(self) -> Density:
        bends = ((self._centres - _straight()) / self._usual)[:, _SHAPE].norm(dim=1)
        bends = (bends / bends.square().mean().sqrt()).clamp(_LEAST_BEND, _MOST_BEND)
        scales = torch.full_like(self._centres, _OF_COST)
        scales[:, _SHAPE] *= bends[:, None]
        scales[:, _ROUGHNESS] = _OF_COST_ROUGHNESS
        return Density(self._centres, scales, self._covariance)

    def encode(self, paths: Tensor) -> Tensor:
        """Return codes (N, 63) of standardised paths (N, 32, 2), metres, which decode to the same paths again."""
        return shape.encode(paths) / self._units.to(paths)

    def decode(self, codes: Tensor) -> Tensor:
        """Return paths (N, 32, 2), metres, of codes (N, 63), standardised but for their residual.

        No gradient flows into the residual, so that a planner does not draw with a hand's tremor.
        """
        return shape.drawn(self._gist_of(codes), self._stays_of(codes).strays)

    def _gist_of(self, codes: Tensor) -> Tensor:
        units = self._gist_units if codes.dtype == torch.float32 else self._units[:GIST].to(codes)
        return codes[:, :GIST] * units.to(codes.device)

    def _stays_of(self, codes: Tensor) -> "_Stays":
        """What follows from residuals, which descent leaves as they are: kept until they change."""
        own = codes[:, GIST:].detach()
        known = self._known_stays.get("last")
        alike = known is not None and (known.codes.dtype, known.codes.device) == (own.dtype, own.device)
        if known is None or not alike or not torch.equal(known.codes, own):
            residual = own * self._units[GIST:].to(own)
            known = _Stays(own.clone(), roughness(residual), shape.strays(residual))
            self._known_stays["last"] = known
        return known

    @cached_property
    def _known_stays(self) -> "dict[str, _Stays]":
        return {}

    def _seen(self, codes: Tensor) -> Tensor:
        """What the cost of each code depends on, (N, 17)."""
        return torch.cat([self._gist_of(codes), self._stays_of(codes).roughness], dim=1)

    def sample(self, k: int, generator: Generator) -> tuple[Tensor, Tensor]:
        """Draw codes (k, 63) of strokes between the hand's own (`Neighbours`), with their pressure knots (k, 4)."""
        return self.sample_around(self.hand.choose(k, generator), generator)

    def sample_around(self, rows: Tensor, generator: Generator) -> tuple[Tensor, Tensor]:
        """Draw a stroke around each of the hand's strokes `rows` (k,), codes (k, 63) and pressure knots (k, 4)."""
        return self._codes_around(rows, generator, self.freedom), self.hand.sample_pressure(rows, generator)

    def _codes_around(self, rows: Tensor, generator: Generator, freedom: float) -> Tensor:
        drawn = self._neighbours.sample(rows, generator) * self._usual
        for logarithm in (_LENGTH, _ROUGHNESS):  # else a few strokes would be many times as long or as rough
            drawn[:, logarithm].clamp_(*self._centres[:, logarithm].aminmax())
        directions = normalize(self._numbers[:, GIST:], dim=1)
        shares = torch.randn(len(rows), len(directions), generator=generator).to(directions) / len(directions) ** 0.5
        mixed = freedom * shares @ directions + (1 - freedom) * directions[rows]
        residuals = normalize(mixed, dim=1) * drawn[:, GIST:].exp()
        return (torch.cat([drawn[:, :GIST], residuals], dim=1) / self._units).float()

    def sample_for(self, lengths: Tensor, generator: Generator, rows: Tensor | None = None) -> tuple[Tensor, Tensor]:
        """Draw one stroke per place, (k, 63) and (k, 4); the longest gets the place with most room."""
        rows = self.hand.choose(len(lengths), generator) if rows is None else rows
        codes, pressure_knots = self.sample_around(rows, generator)
        chosen = by_length(codes[:, 0], lengths)
        return codes[chosen], pressure_knots[chosen]

    def nearest(self, paths: Tensor) -> Tensor:
        """Rows (N,) of the hand's strokes most like standardised paths (N, 32, 2), metres."""
        seen = gist_and_roughness(*shape.parts(shape.encode(paths.double())))
        return self._neighbours.nearest(seen / self._usual)

    def scaled(self, times: float) -> Self:
        """Return the style of the hand that draws so many times as large, itself for 1; codes mean what they meant."""
        return self if times == 1 else replace(self, hand=self.hand.scaled(times))

    def cost(self, codes: Tensor, pressure_knots: Tensor) -> Tensor:
        """Cost (N,) of the strokes of these codes, see `price`; no gradient flows into the residual."""
        return self._price(self._seen(codes), self._stays_of(codes).strays, pressure_knots)

    def price(self, numbers: Tensor, pressure_knots: Tensor) -> Tensor:
        """Cost (N,), nats: distance of each stroke to the hand's nearest, and of them all to the hand's distribution.

        numbers: (N, 63), of strokes (`style.shape`).  pressure_knots: (N, 4).

        The first term compares the gist, the residual's size and the changes of pressure. The second keeps a plan's
        strokes from all becoming long, flat or curly: each of their traits must be distributed as in the hand
        (`trait_costs`).
        """
        gist, residual = shape.parts(numbers)
        return self._price(gist_and_roughness(gist, residual), shape.strays(residual), pressure_knots)

    def _price(self, seen: Tensor, strays: Tensor, pressure_knots: Tensor) -> Tensor:
        if len(seen) not in self._known_traits:
            self._known_traits[len(seen)] = self._traits_of(len(seen))
        together = trait_costs(seen, strays, self._known_traits[len(seen)], _TOGETHER * self._spreads)
        return self._price_alone(seen, pressure_knots) + together

    def _price_alone(self, seen: Tensor, pressure_knots: Tensor) -> Tensor:
        costs, nearest = self._priced.cost(seen)
        return costs.to(seen) + self.hand.pressure_cost(pressure_knots, nearest)

    def usual_cost(self, k: int, generator: Generator) -> float:
        """Mean cost of k samples of the hand's lengths, each by itself."""
        codes, pressure_knots = self.sample(k, generator)
        keep_lengths(codes, self, self.lengths(k))
        return float(self._price_alone(self._seen(codes), pressure_knots).mean())

    @cached_property
    def _traits(self) -> Tensor:
        return traits(self._centres, shape.strays(shape.parts(self._numbers)[1]))

    @cached_property
    def _sorted_traits(self) -> Tensor:
        return self._traits.sort(dim=0).values

    @cached_property
    def _known_traits(self) -> dict[int, Tensor]:
        """What `_traits_of` returned for so many strokes."""
        return {}

    def _traits_of(self, count: int) -> Tensor:
        """Quantiles (count, 19) of the hand's traits, ascending in each column, linear between its strokes."""
        at = quantiles(count) * (len(self._sorted_traits) - 1)
        below = at.long()
        above = (below + 1).clamp(max=len(self._sorted_traits) - 1)
        return self._sorted_traits[below].lerp(self._sorted_traits[above], (at - below)[:, None])

    @cached_property
    def _spreads(self) -> Tensor:
        own = self._traits.std(dim=0)[GIST + 1 :].clamp(min=_LEAST_SPREAD)
        return torch.cat([self._covariance.diagonal().sqrt(), own])

    def lengths(self, count: int) -> Tensor:
        """Lengths (count,), metres, ascending: the quantiles of the hand's."""
        return self.hand.lengths(count)

    def resize(self, codes: Tensor, lengths: Tensor, own: Tensor) -> None:
        """Change codes (N, 63) in place, so that their strokes have these lengths (N,), metres, and the same shapes."""
        codes[:, _LENGTH] += ((lengths / own).log() / self._units[_LENGTH]).to(codes)

    def speeds(self, codes: Tensor) -> Tensor | None:
        """Speeds (N, 32), metres per second, of the hand's stroke most like each; None where none are known."""
        return self.hand.speeds_of(self._priced.nearest(self._seen(codes)))


def _straight() -> Tensor:
    along = torch.linspace(0, 1, POINTS, dtype=torch.float64)
    return gist_and_roughness(*shape.parts(shape.encode(torch.stack([along, torch.zeros_like(along)], dim=-1)[None])))
