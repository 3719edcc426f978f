"""Abstract style: decodes codes into strokes, samples codes, and says how likely a stroke is (docs/equations.md)."""

from abc import ABC, abstractmethod
from math import isfinite
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from torch import Generator, Tensor

    from maulstick.style.arrangement import Arrangement


class Style(ABC):
    """Prior over standardised strokes.

    Codes are scaled so that a change of 1 in any number is a large change of the stroke: a planner can take steps of
    the same size in the codes of any style.

    name: as in the painting file.
    max_mean_cost: bound of the mean cost of a plan's strokes, in multiples of the mean cost of the style's own
    samples; inf for no bound.
    """

    name: str
    max_mean_cost: float

    def __repr__(self) -> str:
        """Say of which kind it is, and its name; the arrays of a hand fill pages."""
        return f"<{type(self).__name__}: {self.name}>"

    @property
    @abstractmethod
    def hash(self) -> str:
        """Digest that changes whenever a code would decode to another stroke."""

    @abstractmethod
    def encode(self, paths: "Tensor") -> "Tensor":
        """Return codes (N, K) of the strokes in this style nearest to standardised paths (N, n, 2), metres."""

    @abstractmethod
    def decode(self, codes: "Tensor") -> "Tensor":
        """Return standardised paths (N, n, 2), metres, of codes (N, K). Pure and differentiable."""

    @abstractmethod
    def sample(self, k: int, generator: "Generator") -> "tuple[Tensor, Tensor]":
        """Draw codes (k, K) and pressure knots (k, 4) in [0, 1] with the generator."""

    @abstractmethod
    def sample_around(self, rows: "Tensor", generator: "Generator") -> "tuple[Tensor, Tensor]":
        """Draw codes (k, K) and pressure knots (k, 4) of one stroke around each of the hand's strokes `rows`, (k,)."""

    @abstractmethod
    def nearest(self, paths: "Tensor") -> "Tensor | None":
        """Return the rows (N,) of the hand's strokes most like standardised paths (N, n, 2), metres.

        None where there is no hand.
        """

    @property
    @abstractmethod
    def arrangement(self) -> "Arrangement | None":
        """How the hand arranges its strokes, whose `rows` its groups are of; None where that is unknown."""

    @abstractmethod
    def sample_for(
        self, lengths: "Tensor", generator: "Generator", rows: "Tensor | None" = None
    ) -> "tuple[Tensor, Tensor]":
        """Draw codes (k, K) and pressure knots (k, 4) of one stroke per place, given the room there, (k,) metres.

        The free style fills the room; a hand keeps its own lengths, and its longest stroke goes where there is most
        room.  rows: (k,), the hand's strokes that they are drawn around; any of them when left out.
        """

    @abstractmethod
    def lengths(self, count: int) -> "Tensor | None":
        """Return the lengths (count,), metres, ascending, that so many strokes are to have; None for any."""

    @abstractmethod
    def resize(self, codes: "Tensor", lengths: "Tensor", own: "Tensor") -> None:
        """Change codes (N, K) in place, so that their strokes have these lengths (N,), metres, and their shapes.

        own: (N,), metres, the lengths that they have.
        """

    @abstractmethod
    def scaled(self, times: float) -> Self:
        """Return the style of the same hand that draws so many times as large; itself for 1."""

    @abstractmethod
    def cost(self, codes: "Tensor", pressure_knots: "Tensor") -> "Tensor":
        """Negative log-likelihood of each stroke, (N,) nats, about 0 for the likeliest; differentiable."""

    def is_bounded(self, codes: "Tensor") -> "Tensor":
        """Return whether the mean cost of strokes of each code's hand is bounded, (N,)."""
        return codes.new_full((len(codes),), isfinite(self.max_mean_cost)).bool()

    @abstractmethod
    def usual_cost(self, k: int, generator: "Generator") -> float:
        """Mean cost, nats, of k strokes that the style draws, each by itself, not by their distribution."""

    @abstractmethod
    def speeds(self, codes: "Tensor") -> "Tensor | None":
        """Speeds at which the hand draws, (N, n), metres per second at each point; None where they are unknown."""
