"""The abstract style (design §3): decodes a code into a trajectory, samples codes, says how likely one is."""

from abc import ABC, abstractmethod

from torch import Generator, Tensor

KNOTS = 4
"""Press knots of a stroke, equally spaced along it; the paper optimises its heights as parameters of their own."""


class Style(ABC):
    """A prior over standardised strokes.

    Codes are scaled so that a change of 1 in any of their numbers is a large change of the stroke: a planner can
    take steps of one size in the codes of any style.
    """

    @property
    @abstractmethod
    def name(self) -> str:
        """What the painting file calls it."""

    @property
    @abstractmethod
    def hash(self) -> str:
        """Changes whenever the same code would decode to another stroke."""

    @abstractmethod
    def encode(self, paths: Tensor) -> Tensor:
        """Codes (N, K) of the standardised paths (N, n, 2), metres, nearest to them that the style can draw."""

    @abstractmethod
    def decode(self, codes: Tensor) -> Tensor:
        """Standardised paths (N, n, 2), metres, of codes (N, K). Pure and differentiable."""

    @abstractmethod
    def sample(self, k: int, generator: Generator) -> tuple[Tensor, Tensor]:
        """Codes (k, K) and press knots (k, 4) in [0, 1]; all chance comes from the generator."""

    @abstractmethod
    def cost(self, codes: Tensor, press_knots: Tensor) -> Tensor:
        """How far from the style each stroke is, (N,), 0 at its likeliest; differentiable."""
