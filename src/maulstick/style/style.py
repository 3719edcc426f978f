"""The abstract style (docs/equations.md): decodes a code into a trajectory, samples codes, says how likely one is."""

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from torch import Generator, Tensor


class Style(ABC):
    """A prior over standardised strokes.

    Codes are scaled so that a change of 1 in any of their numbers is a large change of the stroke: a planner can
    take steps of one size in the codes of any style.

    name: what the painting file calls it.
    max_mean_cost: the mean cost of a plan's strokes, at most, in multiples of the mean cost of the style's own samples;
    inf for no bound.
    """

    name: str
    max_mean_cost: float

    @property
    @abstractmethod
    def hash(self) -> str:
        """Changes whenever the same code would decode to another stroke."""

    @abstractmethod
    def encode(self, paths: "Tensor") -> "Tensor":
        """Codes (N, K) of the standardised paths (N, n, 2), metres, nearest to them that the style can draw."""

    @abstractmethod
    def decode(self, codes: "Tensor") -> "Tensor":
        """Standardised paths (N, n, 2), metres, of codes (N, K). Pure and differentiable."""

    @abstractmethod
    def sample(self, k: int, generator: "Generator") -> "tuple[Tensor, Tensor]":
        """Codes (k, K) and pressure knots (k, 4) in [0, 1]; all chance comes from the generator."""

    @abstractmethod
    def sample_for(self, lengths: "Tensor", generator: "Generator") -> "tuple[Tensor, Tensor]":
        """As `sample`, a stroke for each of the places (k,) that have room for these lengths, metres.

        A style that belongs to nobody fills the room; a hand keeps its own lengths, and its longest stroke goes where
        there is most room.
        """

    @abstractmethod
    def cost(self, codes: "Tensor", pressure_knots: "Tensor") -> "Tensor":
        """How unlikely each stroke is, (N,), in nats above about the style's likeliest; differentiable."""

    @abstractmethod
    def speeds(self, codes: "Tensor") -> "Tensor | None":
        """How fast the hand draws, metres a second at each of the points, (N, n); None where nobody knows."""
