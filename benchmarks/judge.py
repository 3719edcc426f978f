"""How far a drawing is arranged from the half of a hand's drawing that judges it.

The hand's strokes are described among all strokes of its drawing, and then parted into halves. Numbers are in units of
their spread over the strokes of all 42 drawings; distances are unbiased energy distances.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from copies import copied_share
from descriptors import JUDGING, ORDERLESS, describe, straightened
from drawings import Floats, halves, placed
from succession import Succession, travel

from maulstick.strokes.strokes import Strokes
from maulstick.style.compare import energy_distance

Measured = dict[str, float | str]

KEYS = ("energy", "energy_judging")
"""Distances by all numbers, and by those that are for judging only."""


@dataclass(frozen=True)
class Described:
    """Descriptions of whole drawings, each (N, 11), and their spread; `prepare` is done to strokes before."""

    of: dict[str, Floats]
    spread: Floats
    prepare: Callable[[Floats], Floats]

    @classmethod
    def all(cls, drawings: dict[str, Strokes], prepare: Callable[[Floats], Floats]) -> "Described":
        """Describe these drawings."""
        of = {name: describe(prepare(placed(strokes)))[:, :ORDERLESS] for name, strokes in drawings.items()}
        spread = np.concatenate(list(of.values())).std(axis=0)
        return cls({name: each / spread for name, each in of.items()}, spread, prepare)

    def half(self, name: str, split: int, judging: bool) -> Floats:
        """Return the descriptions of the strokes that are learned from, or of those that judge."""
        return self.of[name][halves(len(self.of[name]), split)[judging]]

    def new(self, paths: Floats) -> Floats:
        """Describe another drawing (N, n, 2) alike."""
        return describe(self.prepare(paths))[:, :ORDERLESS] / self.spread


@dataclass(frozen=True)
class Judge:
    """Judge by these drawings."""

    drawings: dict[str, Strokes]

    @cached_property
    def _shaped(self) -> Described:
        return Described.all(self.drawings, lambda paths: paths)

    @cached_property
    def _straight(self) -> Described:
        return Described.all(self.drawings, straightened)

    def people(self, hand: str, split: int) -> Measured:
        """The half that was learned from, which is the least that can be asked for, and the mean of all others'.

        Its groups and order are measured as those of the half that judges, which did not learn them.
        """
        known = {name: self._shaped.half(name, split, judging=False) for name in self.drawings}
        against = self._shaped.half(hand, split, judging=True)
        others = [each for name, each in known.items() if name != hand]
        learned, judging = self._halves(hand, split)
        return {
            **_distances(known[hand], against),
            **{f"others_{key}": float(np.mean([_distances(each, against)[key] for each in others])) for key in KEYS},
            "taken_for": self._nearest(self._straight.half(hand, split, judging=False), split),
            "copied_groups": copied_share(judging, learned),
            **_succession(learned, judging),
        }

    def measure(self, paths: Floats, hand: str, split: int) -> Measured:
        """A drawing (N, n, 2), in the order painted, in this hand; it was learned from the other half."""
        learned, judging = self._halves(hand, split)
        return {
            **_distances(self._shaped.new(paths), self._shaped.half(hand, split, judging=True)),
            "taken_for": self._nearest(self._straight.new(paths), split),
            "copied_groups": copied_share(paths, learned),
            **_succession(paths, judging),
        }

    def _halves(self, hand: str, split: int) -> tuple[Floats, Floats]:
        paths = placed(self.drawings[hand])
        learned, judging = halves(len(paths), split)
        return paths[learned], paths[judging]

    def _nearest(self, described: Floats, split: int) -> str:
        """The drawing whose judging half is nearest, strokes straightened."""
        each = {name: self._straight.half(name, split, judging=True) for name in self.drawings}
        return min(each, key=lambda name: energy_distance(described, each[name]))


def _distances(described: Floats, against: Floats) -> dict[str, float]:
    only = list(JUDGING)
    each = energy_distance(described, against), energy_distance(described[:, only], against[:, only])
    return dict(zip(KEYS, each, strict=True))


def _succession(paths: Floats, judging: Floats) -> dict[str, float]:
    return {"order_nats": Succession.of(judging).nats(paths), "travel": travel(paths)}
