"""How the rivals of the stroke model are trained: one loss, one schedule and one budget for all of them."""

import math
import time
from copy import deepcopy
from dataclasses import dataclass

import torch
from torch import Tensor, nn
from torch.nn.functional import binary_cross_entropy
from torch.optim import Adam

BATCH = 16
COVERED = 0.1
COVERED_EXTRA = 1.0
"""How much more a covered pixel counts than a blank one at first, since most of an image is blank; it falls to nothing,
so that all end with the plain L1 they are compared by."""
RISE = 0.1
PATIENCE = 0.6
"""The share of the time without a better `valid` after which to stop; long, since the loss turns plain late."""
_AT_ONCE = 64


@dataclass(frozen=True)
class Examples:
    """Strokes alone on images of one size.

    paths: (N, 32, 3) x, y in pixels from the image's upper left corner, whose first pixel has its centre at (0.5, 0.5),
    and pressure in [0, 1].  darkness: (N, H, W) in [0, 1], 1 = full ink.  weights: (N, H, W) in [0, 1], 0 where a pixel
    must not count.
    """

    paths: Tensor
    darkness: Tensor
    weights: Tensor

    def __len__(self) -> int:
        return len(self.paths)

    def pick(self, which: Tensor) -> "Examples":
        """Those of these indices (M,)."""
        return Examples(self.paths[which], self.darkness[which], self.weights[which])


@dataclass(frozen=True)
class Model:
    """A trained network, from paths (N, 32, 3) to darkness (N, H, W) in [0, 1], and how long it was trained."""

    network: nn.Module
    seconds: float

    @property
    def parameters(self) -> int:
        """How many numbers were trained."""
        return sum(p.numel() for p in self.network.parameters())

    def __call__(self, paths: Tensor) -> Tensor:
        """Darkness (N, H, W) of paths (N, 32, 3)."""
        return predict(self.network, paths)


@torch.no_grad()
def predict(network: nn.Module, paths: Tensor) -> Tensor:
    """What a network draws, (N, H, W), a few at a time."""
    network.eval()
    return torch.cat([network(some) for some in paths.split(_AT_ONCE)]).clamp(0, 1)


def plain_l1(darkness: Tensor, truth: Examples) -> float:
    """The mean of weight times error over all pixels: what rivals are compared by."""
    return float((truth.weights * (darkness - truth.darkness).abs()).mean())


def fit(
    network: nn.Module,
    train: Examples,
    valid: Examples,
    *,
    rates: dict[str, float],
    seconds: float,
    warm_up: float = 0.0,
    shift: int = 0,
) -> float:
    """Train in place, keep the numbers that were best on `valid`, return the seconds it took.

    rates: the highest learning rate of each trained part of the network; other parts stay as they are.
    warm_up: the share of the time for which the loss is cross-entropy, which leaves blank paper where L1 stays on it.
    shift: how many pixels a stroke and its image are moved at most, at random each time they are shown.
    """
    start = time.perf_counter()
    parts = [network.get_submodule(name) for name in rates]
    optimiser = Adam([{"params": part.parameters()} for part in parts])
    network.requires_grad_(False)
    for part in parts:
        part.requires_grad_(True)
    best, best_at, kept = plain_l1(predict(network, valid.paths), valid), 0.0, deepcopy(network.state_dict())
    spent = 0.0
    while spent < 1 and spent - max(best_at, warm_up) < PATIENCE:
        network.eval()
        for part in parts:
            part.train()
        for which in torch.randperm(len(train)).split(BATCH):
            spent = (time.perf_counter() - start) / seconds
            if spent >= 1:
                break
            for group, rate in zip(optimiser.param_groups, rates.values(), strict=True):
                group["lr"] = rate * _schedule(spent)
            optimiser.zero_grad()
            _loss(network, _moved(train.pick(which), shift), spent, warm=spent < warm_up).backward()
            optimiser.step()
        error = plain_l1(predict(network, valid.paths), valid)
        if error < best:
            best, best_at, kept = error, spent, deepcopy(network.state_dict())
    network.load_state_dict(kept)
    return time.perf_counter() - start


def _schedule(spent: float) -> float:
    """One cycle: a straight rise, then half a cosine down to nothing."""
    return spent / RISE if spent < RISE else (1 + math.cos(math.pi * (spent - RISE) / (1 - RISE))) / 2


def _loss(network: nn.Module, batch: Examples, spent: float, *, warm: bool) -> Tensor:
    darkness = network(batch.paths)
    weights = batch.weights * (1 + COVERED_EXTRA * (1 - spent**2) * (batch.darkness > COVERED))
    if warm:
        return binary_cross_entropy(darkness, batch.darkness, weights)
    return (weights * (darkness - batch.darkness).abs()).mean()


def _moved(batch: Examples, shift: int) -> Examples:
    """Each path with its image moved by whole pixels; what comes in from beyond an image's edge does not count."""
    if shift == 0:
        return batch
    count, height, width = batch.darkness.shape
    by = torch.randint(-shift, shift + 1, (count, 2))
    rows, columns = torch.arange(height) - by[:, 1:], torch.arange(width) - by[:, :1]
    inside = _within(rows, height)[:, :, None] & _within(columns, width)[:, None, :]
    at = (
        torch.arange(count)[:, None, None],
        rows.clamp(0, height - 1)[:, :, None],
        columns.clamp(0, width - 1)[:, None, :],
    )
    paths = batch.paths + torch.cat([by, torch.zeros(count, 1)], dim=1)[:, None]
    return Examples(paths, batch.darkness[at], batch.weights[at] * inside)


def _within(index: Tensor, size: int) -> Tensor:
    return (index >= 0) & (index < size)
