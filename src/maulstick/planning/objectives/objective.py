"""Interfaces of the terms of the loss. Each sees the canvas and nothing else."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

from torch import Tensor


class Objective(ABC):
    """A term of the loss that is cheap enough to be evaluated at every step."""

    @property
    @abstractmethod
    def name(self) -> str:
        """Name of the term on the command line."""

    @abstractmethod
    def loss(self, canvas: Tensor, progress: float) -> Tensor:
        """Return a scalar, smaller for a better canvas (C, H, W); progress in [0, 1] is the share of planning done."""


class NetworkLoss(ABC):
    """A term of the loss that calls a network, and so is evaluated seldom.

    It has a fixed set of views of the canvas (perspectives and crops), and is evaluated through some of them at a
    time; the features that it compares with are computed once per view.
    """

    @property
    @abstractmethod
    def name(self) -> str:
        """Name of the term on the command line."""

    @property
    @abstractmethod
    def views(self) -> int:
        """Number of views to choose from."""

    @abstractmethod
    def losses(self, canvas: Tensor, which: Sequence[int]) -> Tensor:
        """Return one loss per view, (len(which),), smaller for a better canvas (C, H, W); differentiable.

        which: indices of the views.
        """
