"""A network that is small enough for finite differences, and counts the images that it was shown."""

from collections.abc import Callable, Sequence

import pytest
import torch
from torch import Generator, Tensor, nn

from maulstick.planning.features.network import ReadingNetwork
from tests.support.tolerances import FINITE_DIFFERENCE


class TinyNetwork(ReadingNetwork):
    def __init__(self) -> None:
        torch_rng = Generator().manual_seed(5)
        self._layers = nn.ModuleList([nn.Conv2d(3, 6, 3, stride=2), nn.Conv2d(6, 8, 3, stride=2)]).double()
        for parameter in self._layers.parameters():
            parameter.data = torch.randn(parameter.shape, generator=torch_rng, dtype=torch.float64) / 2
        self._layers.requires_grad_(False)
        self.shown = 0

    @property
    def name(self) -> str:
        return "tiny"

    @property
    def side(self) -> int:
        return 24

    def features(self, images: Tensor) -> tuple[list[Tensor], Tensor]:
        assert images.shape[1:] == (3, self.side, self.side)
        self.shown += len(images)
        maps = []
        for layer in self._layers.to(images).children():
            images = torch.tanh(layer(images))
            maps.append(images)
        return maps, images.mean(dim=(2, 3))

    def embed_text(self, texts: Sequence[str]) -> Tensor:
        seeds = [Generator().manual_seed(sum(text.encode())) for text in texts]
        return nn.functional.normalize(torch.stack([torch.randn(8, generator=seed) for seed in seeds]), dim=-1)


def noise(seed: int, *shape: int) -> Tensor:
    return torch.rand(*shape, generator=Generator().manual_seed(seed), dtype=torch.float64)


def check_gradient(loss: Callable[[Tensor], Tensor], canvas: Tensor, *, step: float = 1e-5) -> None:
    """Compare the gradient of a loss at a float64 canvas, along random directions, with finite differences."""
    canvas = canvas.detach().requires_grad_()
    (gradient,) = torch.autograd.grad(loss(canvas), canvas)
    for seed in range(4):
        direction = 2 * noise(seed, *canvas.shape) - 1
        with torch.no_grad():
            slope = (loss(canvas + step * direction) - loss(canvas - step * direction)) / (2 * step)
        scale = (gradient * direction).abs().sum().item()
        assert (gradient * direction).sum().item() == pytest.approx(slope.item(), abs=FINITE_DIFFERENCE * scale)
