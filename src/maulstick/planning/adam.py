"""Adam for plans, which starts at once: the optimisers of PyTorch load its compiler, as large as all else of it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from maulstick.planning.state import State

_EPSILON = 1e-8


@dataclass
class _Parameter:
    """A tensor, its rate, how many steps it took, and the averages of its gradients and of their squares."""

    tensor: Tensor
    rate: float
    steps: int
    exp_avg: Tensor
    exp_avg_sq: Tensor


class Adam:
    """Adam (Kingma and Ba, 2015), a rate per tensor: on a CPU the same to the bit as `torch.optim.Adam`."""

    def __init__(self, betas: tuple[float, float] = (0.9, 0.999)) -> None:
        self._betas = betas
        self._parameters: list[_Parameter] = []

    def add(self, tensor: Tensor, rate: float) -> None:
        """Adapt this tensor too."""
        empty = tensor.detach()
        self._parameters.append(_Parameter(tensor, rate, 0, torch.zeros_like(empty), torch.zeros_like(empty)))

    @torch.no_grad()
    def step(self, loss: Tensor, share: float = 1.0) -> None:
        """Take a step down the loss, at this share of all rates."""
        for parameter in self._parameters:
            parameter.tensor.grad = None
        loss.backward()
        first, second = self._betas
        for parameter in self._parameters:
            if (gradient := parameter.tensor.grad) is None:
                continue
            parameter.steps += 1
            parameter.exp_avg.lerp_(gradient, 1 - first)
            parameter.exp_avg_sq.mul_(second).addcmul_(gradient, gradient, value=1 - second)
            scale = (parameter.exp_avg_sq.sqrt() / (1 - second**parameter.steps) ** 0.5).add_(_EPSILON)
            rate = parameter.rate * share / (1 - first**parameter.steps)
            parameter.tensor.addcdiv_(parameter.exp_avg, scale, value=-rate)

    def forget(self, tensors: Sequence[Tensor], rows: Tensor) -> None:
        """Forget the gradients of some rows of these tensors, where they are adapted at all."""
        for parameter in self._parameters:
            if any(parameter.tensor is tensor for tensor in tensors):
                parameter.exp_avg[rows] = 0
                parameter.exp_avg_sq[rows] = 0

    def state(self) -> State:
        """Return all that the next step depends on, without the tensors themselves."""
        state: State = {}
        for i, parameter in enumerate(self._parameters):
            state[f"adam.{i}.steps"] = np.array(parameter.steps)
            state[f"adam.{i}.exp_avg"] = parameter.exp_avg.numpy()
            state[f"adam.{i}.exp_avg_sq"] = parameter.exp_avg_sq.numpy()
        return state

    def restore(self, state: State) -> None:
        """Put a state of the same tensors back."""
        for i, parameter in enumerate(self._parameters):
            parameter.steps = int(state[f"adam.{i}.steps"])
            parameter.exp_avg.copy_(torch.from_numpy(state[f"adam.{i}.exp_avg"]))
            parameter.exp_avg_sq.copy_(torch.from_numpy(state[f"adam.{i}.exp_avg_sq"]))
