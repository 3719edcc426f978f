"""Hands by region: one prior for a plan in which each region of the sheet has a hand of its own."""

import hashlib
from collections.abc import Callable, Sequence
from math import inf, isfinite
from typing import TYPE_CHECKING, NoReturn

import torch
from torch import Generator, Tensor

from maulstick.style.lengths import keep_lengths
from maulstick.style.style import Style

if TYPE_CHECKING:
    from maulstick.style.arrangement import Arrangement

_COST_SAMPLES = 256  # strokes of each hand whose mean cost counts as usual for it


class RegionalStyle(Style):
    """Hands of regions as one style. The first number of a code is its region; no gradient flows into it.

    hands: one per region.  Codes are as long as the longest of any hand; the rest of a shorter one is 0.
    A cost of 1 times `usual_cost` is as much as its hand allows; a hand without a bound keeps its own costs.
    """

    def __init__(self, hands: Sequence[Style]) -> None:
        self.hands = tuple(hands)
        self.name = "+".join(dict.fromkeys(hand.name for hand in hands))
        self._sizes = [hand.sample(1, Generator().manual_seed(0))[0].shape[1] for hand in self.hands]
        allowed = {
            region: hand.max_mean_cost * hand.usual_cost(_COST_SAMPLES, Generator().manual_seed(0))
            for region, hand in enumerate(self.hands)
            if isfinite(hand.max_mean_cost)
        }
        self._unit = sum(allowed.values()) / len(allowed) if allowed else 1.0
        self._units = [self._unit / allowed[region] if region in allowed else 1.0 for region in range(len(self.hands))]
        self._bounded = torch.tensor([region in allowed for region in range(len(self.hands))])
        self.max_mean_cost = 1.0 if allowed else inf
        self._known_lengths: dict[tuple[int, int], Tensor | None] = {}

    @property
    def hash(self) -> str:
        """Digest of the hands' own."""
        return hashlib.sha256("+".join(hand.hash for hand in self.hands).encode()).hexdigest()[:16]

    def regions_of(self, codes: Tensor) -> Tensor:
        """Return the region of each code, (N,)."""
        return codes[:, 0].detach().round().long()

    def own_codes(self, codes: Tensor, region: int) -> Tensor:
        """Return codes (N, K) of one region as the codes of its hand."""
        return codes[:, 1 : 1 + self._sizes[region]]

    def codes_in(self, region: int, codes: Tensor) -> Tensor:
        """Return codes (N, k) of a region's hand as codes (N, K) of that region."""
        padded = codes.new_zeros(len(codes), 1 + max(self._sizes))
        padded[:, 0] = region
        padded[:, 1 : 1 + codes.shape[1]] = codes
        return padded

    def encode_in(self, regions: Tensor, paths: Tensor) -> Tensor:
        """Return codes (N, K) of standardised paths (N, n, 2), metres, each as its region's hand draws it, (N,)."""
        return self._each(regions, lambda region, rows: self.codes_in(region, self.hands[region].encode(paths[rows])))

    def encode(self, paths: Tensor) -> Tensor:
        """Return codes of standardised paths (N, n, 2), metres, as the first hand draws them."""
        return self.encode_in(torch.zeros(len(paths), dtype=torch.long), paths)

    def decode(self, codes: Tensor) -> Tensor:
        """Return standardised paths (N, n, 2), metres, of codes (N, K). Pure and differentiable."""
        return self._each(
            self.regions_of(codes),
            lambda region, rows: self.hands[region].decode(self.own_codes(codes[rows], region)),
        )

    def sample(self, k: int, generator: Generator) -> tuple[Tensor, Tensor]:
        """Draw codes (k, K) and pressure knots (k, 4) in [0, 1] of the first hand."""
        codes, knots = self.hands[0].sample(k, generator)
        return self.codes_in(0, codes), knots

    def sample_for(self, lengths: Tensor, generator: Generator, rows: Tensor | None = None) -> tuple[Tensor, Tensor]:
        """Draw codes (k, K) and pressure knots (k, 4) of the first hand, given the room at each place, (k,) metres."""
        codes, knots = self.hands[0].sample_for(lengths, generator, rows)
        return self.codes_in(0, codes), knots

    def sample_around(self, rows: Tensor, generator: Generator) -> NoReturn:
        """Raise NotImplementedError: each hand is asked by itself."""
        raise NotImplementedError

    def nearest(self, paths: Tensor) -> NoReturn:
        """Raise NotImplementedError: each hand is asked by itself."""
        raise NotImplementedError

    @property
    def arrangement(self) -> "Arrangement | None":
        """None: each hand has an arrangement of its own."""
        return None

    def lengths(self, count: int) -> Tensor | None:
        """Return None, since each hand has lengths of its own, which `keep_lengths` keeps."""
        return None

    @torch.no_grad()
    def keep_lengths(self, codes: Tensor) -> None:
        """Give the strokes of these codes (N, K) the lengths of their region's hand, by their ranks, in place."""
        regions = self.regions_of(codes)
        for region, hand in enumerate(self.hands):
            rows = (regions == region).nonzero()[:, 0]
            if (lengths := self._lengths_of(region, len(rows))) is not None:
                own = self.own_codes(codes[rows], region)
                keep_lengths(own, hand, lengths)
                codes[rows] = self.codes_in(region, own)

    def _lengths_of(self, region: int, count: int) -> Tensor | None:
        if (region, count) not in self._known_lengths:
            self._known_lengths[region, count] = self.hands[region].lengths(count) if count else None
        return self._known_lengths[region, count]

    def resize(self, codes: Tensor, lengths: Tensor, own: Tensor) -> None:
        """Change codes (N, K) in place, so that their strokes have these lengths (N,), metres, and their shapes."""
        regions = self.regions_of(codes)
        for region, hand in enumerate(self.hands):
            rows = (regions == region).nonzero()[:, 0]
            theirs = self.own_codes(codes[rows], region)
            hand.resize(theirs, lengths[rows], own[rows])
            codes[rows] = self.codes_in(region, theirs)

    def scaled(self, times: float) -> "RegionalStyle":
        """Return the same hands that draw so many times as large; itself for 1."""
        return self if times == 1 else RegionalStyle([hand.scaled(times) for hand in self.hands])

    def cost(self, codes: Tensor, pressure_knots: Tensor) -> Tensor:
        """Negative log-likelihood of each stroke by its region's hand, (N,), in a unit that all bounded hands share."""

        def price(region: int, rows: Tensor) -> Tensor:
            costs = self.hands[region].cost(self.own_codes(codes[rows], region), pressure_knots[rows])
            return costs * self._units[region]

        return self._each(self.regions_of(codes), price)

    def is_bounded(self, codes: Tensor) -> Tensor:
        """Return whether the mean cost of strokes of each code's hand is bounded, (N,)."""
        return self._bounded[self.regions_of(codes)]

    def usual_cost(self, k: int, generator: Generator) -> float:
        """Return the cost that each hand allows its strokes, which is the unit of `cost`."""
        return self._unit

    def speeds(self, codes: Tensor) -> Tensor | None:
        """Return None, since only some hands may know their speeds; `hands` say them by region."""
        return None

    def _each(self, regions: Tensor, of: Callable[[int, Tensor], Tensor]) -> Tensor:
        """Return what `of` gives for a region and its rows, of all regions, by row."""
        rows = [(regions == region).nonzero()[:, 0] for region in range(len(self.hands))]
        parts = [of(region, own) for region, own in enumerate(rows) if len(own) or region == 0]
        return torch.cat(parts)[torch.cat(rows).argsort()]
