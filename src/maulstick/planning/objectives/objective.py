"""What a painting should look like. Whoever says so sees the canvas and nothing else."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

from torch import Tensor


class Objective(ABC):
    """A term of the loss that is cheap enough to be asked at every step."""

    @property
    @abstractmethod
    def name(self) -> str:
        """What the command line calls it."""

    @abstractmethod
    def loss(self, canvas: Tensor, progress: float) -> Tensor:
        """A scalar, smaller for a better canvas (C, H, W); progress in [0, 1] tells how far planning has come."""


class NetworkLoss(ABC):
    """A term of the loss that asks a network, and so is asked seldom.

    It has a number of views of the canvas (perspectives and crops, the same ones for good), and is asked through some
    of them at a time; what it compares with is worked out once a view.
    """

    @property
    @abstractmethod
    def name(self) -> str:
        """What the command line calls it."""

    @property
    @abstractmethod
    def views(self) -> int:
        """How many views there are to choose from."""

    @abstractmethod
    def losses(self, canvas: Tensor, which: Sequence[int]) -> Tensor:
        """A loss for each of these views, (len(which),), smaller for a better canvas (C, H, W); differentiable."""
