"""A network loss without a network, for tests of when network losses are called."""

from collections.abc import Sequence

import torch
from torch import Tensor

from maulstick.planning.objectives import NetworkLoss


class Shifted(NetworkLoss):
    """Difference from the target, which each view moves a little further to the right. It records its calls."""

    def __init__(self, target: Tensor, views: int = 6) -> None:
        self._target, self._views = target, views
        self.calls: list[tuple[int, ...]] = []

    @property
    def name(self) -> str:
        return "shifted"

    @property
    def views(self) -> int:
        return self._views

    def losses(self, canvas: Tensor, which: Sequence[int]) -> Tensor:
        self.calls.append(tuple(which))
        return torch.stack([(canvas - self._target.roll(view, dims=2)).square().mean() for view in which])
