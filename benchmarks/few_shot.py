"""Few-shot likeness: what was learned from 20 strokes of a session, against the session's other strokes.

Descriptions (`style.compare.describe`) are standardised over all sessions of a kind.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from maulstick.strokes.strokes import Strokes
from maulstick.style.compare import describe, distance_to_nearest, energy_distance, nearest_neighbour_accuracy
from maulstick.style.hand import Hand
from maulstick.style.pooled import PooledHands, pool

Floats = NDArray[np.float64]

FEW, DRAWN = 20, 300
ENOUGH = 40
"""Strokes that a session must have."""


@dataclass(frozen=True)
class Likeness:
    """energy: unbiased energy distance to the session's other strokes.  one_nn: accuracy of a nearest neighbour.

    novelty: mean distance to the nearest of the 20, in units of other people's.
    """

    energy: float
    one_nn: float
    novelty: float


@dataclass(frozen=True)
class Session:
    """One of several sessions.

    strokes: all of them.  others: paths of each other session.  mean, spread: of descriptions, over all sessions.
    """

    name: str
    strokes: Strokes
    others: list[Floats]
    mean: Floats
    spread: Floats

    def few(self, seed: int) -> "Few":
        """Twenty strokes of it, drawn at random."""
        return Few(self, *split(self.strokes, seed, FEW), seed)

    def describe(self, paths: Floats) -> Floats:
        """Standardised descriptions (N, 24) of paths (N, 32, 2)."""
        return (describe(paths) - self.mean) / self.spread

    @cached_property
    def described_others(self) -> list[Floats]:
        """Descriptions of each other session."""
        return [self.describe(other) for other in self.others]


@dataclass(frozen=True)
class Few:
    """Twenty strokes of a session, and the rest of it."""

    session: Session
    strokes: Strokes
    rest: Strokes
    seed: int

    @property
    def paths(self) -> Floats:
        """Paths (20, 32, 2)."""
        return paths_of(self.strokes)

    @cached_property
    def _seen(self) -> Floats:
        return self.session.describe(self.paths)

    @cached_property
    def _unseen(self) -> Floats:
        return self.session.describe(paths_of(self.rest))

    @cached_property
    def _far(self) -> float:
        return float(np.mean([distance_to_nearest(other, self._seen) for other in self.session.described_others]))

    def compare(self, paths: Floats) -> Likeness:
        """Compare strokes (N, 32, 2) that were drawn after the twenty with the rest."""
        drawn = self.session.describe(paths)
        return self._likeness(drawn, drawn)

    @cached_property
    def floor(self) -> Likeness:
        """The twenty strokes themselves; novelty is that of the rest."""
        return self._likeness(self._seen, self._unseen)

    @cached_property
    def other_people(self) -> Likeness:
        """Every other session, on average."""
        each = [self._likeness(other, other) for other in self.session.described_others]
        return Likeness(*(float(np.mean([getattr(one, field) for one in each])) for field in FIELDS))

    def _likeness(self, drawn: Floats, novel: Floats) -> Likeness:
        return Likeness(
            energy_distance(drawn, self._unseen),
            nearest_neighbour_accuracy(drawn, self._unseen, np.random.default_rng(self.seed)),
            distance_to_nearest(novel, self._seen) / self._far,
        )


FIELDS = tuple(Likeness.__dataclass_fields__)


def sessions_of(hands: dict[str, Strokes]) -> list[Session]:
    """Sessions of these hands."""
    paths = {name: paths_of(strokes) for name, strokes in hands.items()}
    described = np.concatenate([describe(each) for each in paths.values()])
    return [
        Session(
            name,
            strokes,
            [other for key, other in paths.items() if key != name],
            described.mean(axis=0),
            described.std(axis=0),
        )
        for name, strokes in hands.items()
    ]


def pool_without(name: str, hands: dict[str, Strokes]) -> PooledHands:
    """What all other hands have in common."""
    return pool([Hand.of(strokes) for key, strokes in hands.items() if key != name])


def large(hands: dict[str, Strokes]) -> dict[str, Strokes]:
    """Those of at least 40 strokes."""
    return {name: strokes for name, strokes in hands.items() if len(strokes) >= ENOUGH}


def paths_of(strokes: Strokes) -> Floats:
    """Paths (N, 32, 2), metres."""
    return strokes.trajectories[..., :2]


def split(strokes: Strokes, seed: int, count: int) -> tuple[Strokes, Strokes]:
    """So many strokes at random, and the others."""
    rows = np.random.default_rng(seed).permutation(len(strokes))
    return strokes[rows[:count]], strokes[rows[count:]]
