"""Pictures to render, and what a renderer makes of them."""

import os
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from torch import Tensor

from maulstick.rendering.kernels import cpu, reference


class Renderer(NamedTuple):
    """The two operations of one implementation."""

    darkness: Callable[..., Tensor]
    composite: Callable[..., Tensor]


REFERENCE = Renderer(reference.darkness, reference.composite)
# With MAULSTICK_BASELINE=1 the oldest alone: the others ran already.
_TRIED = cpu.INSTRUCTION_SETS[-1:] if os.environ.get("MAULSTICK_BASELINE") == "1" else cpu.INSTRUCTION_SETS
FAST = {
    name: Renderer(partial(cpu.darkness, instructions=name), partial(cpu.composite, instructions=name))
    for name in _TRIED
}

each_fast_renderer = pytest.mark.parametrize("fast", FAST.values(), ids=FAST)
each_renderer = pytest.mark.parametrize("renderer", [REFERENCE, *FAST.values()], ids=["reference", *FAST])


class Scene(NamedTuple):
    """Everything that `composite` takes, in its order."""

    canvas: Tensor
    points: Tensor
    thickness: Tensor
    colours: Tensor
    falloff: Tensor
    plateau: Tensor
    opacity: Tensor

    def to(self, dtype: torch.dtype) -> "Scene":
        return Scene(*(x.to(dtype) for x in self))


def random_scene(
    seed: int,
    *,
    strokes: int = 5,
    points: int = 6,
    channels: int = 3,
    height: int = 37,
    width: int = 70,
    shared: bool = False,
    thinnest: float = 0.5,
) -> Scene:
    """Strokes that wander over the canvas and beyond its edges; `shared`: one c, q, o for all of them."""
    generator = torch.Generator().manual_seed(seed)

    def uniform(low: float, high: float, *shape: int) -> Tensor:
        return low + (high - low) * torch.rand(*shape, generator=generator)

    size = torch.tensor([width, height])
    numbers = 1 if shared else strokes
    return Scene(
        canvas=uniform(0, 1, channels, height, width),
        points=uniform(-0.3, 1.3, strokes, 1, 2) * size + uniform(-6, 6, strokes, points, 2).cumsum(1),
        thickness=uniform(thinnest, 4, strokes, points),
        colours=uniform(0, 1, strokes, channels),
        falloff=uniform(0.15, 3, numbers),
        plateau=uniform(0, 0.9, numbers),
        opacity=uniform(0.3, 1, numbers),
    )


def one_stroke(
    points: list[list[float]], thickness: list[float], *, height: int = 20, width: int = 24, plateau: float = 0.0
) -> Scene:
    """A single black stroke with c = 1 and o = 1 on white paper."""
    return Scene(
        canvas=torch.ones(1, height, width),
        points=torch.tensor([points]),
        thickness=torch.tensor([thickness]),
        colours=torch.zeros(1, 1),
        falloff=torch.ones(1),
        plateau=torch.tensor([plateau]),
        opacity=torch.ones(1),
    )


def mean_over_pixel(
    darkness: Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]], x: int, y: int
) -> float:
    """The mean of darkness(x, y), none of it below 0 or above 1, over the pixel in this column and row."""
    steps = (np.arange(200) + 0.5) / 200
    across, down = np.meshgrid(x + steps, y + steps)
    return float(darkness(across, down).clip(0, 1).mean())


def weights_like(image: Tensor) -> Tensor:
    """The gradient that tests send back: of no symmetry, and the same for the same shape."""
    generator = torch.Generator().manual_seed(image.numel())
    return torch.randn(image.shape, generator=generator).to(image.dtype)


def composite_with_gradients(
    renderer: Renderer, scene: Scene, trainable: Tensor | None = None, weights: Tensor | None = None
) -> dict[str, Tensor]:
    """The painted canvas, as `value`, and the gradient of each argument under its name."""
    leaves = Scene(*(x.detach().clone().requires_grad_() for x in scene))
    return _with_gradients(renderer.composite(*leaves, trainable=trainable), leaves._asdict(), weights)


def darkness_with_gradients(renderer: Renderer, scene: Scene) -> dict[str, Tensor]:
    """The images, as `value`, and the gradient of each argument under its name."""
    _, height, width = scene.canvas.shape
    stroke = {name: x for name, x in scene._asdict().items() if name not in ("canvas", "colours")}
    leaves = {name: x.detach().clone().requires_grad_() for name, x in stroke.items()}
    return _with_gradients(renderer.darkness(**leaves, height=height, width=width), leaves, None)


def _with_gradients(value: Tensor, leaves: dict[str, Tensor], weights: Tensor | None) -> dict[str, Tensor]:
    weights = weights_like(value) if weights is None else weights
    gradients: list[Tensor | None] = [None] * len(leaves)
    if value.requires_grad:  # without strokes the reference has nothing to derive
        gradients = list(torch.autograd.grad(value, list(leaves.values()), weights, allow_unused=True))
    filled = [torch.zeros_like(x) if g is None else g for x, g in zip(leaves.values(), gradients, strict=True)]
    return {"value": value.detach(), **dict(zip(leaves, filled, strict=True))}


def assert_same(result: dict[str, Tensor], truth: dict[str, Tensor], *, value: float, gradient: float) -> None:
    """Compare every entry: values by their difference, gradients as a fraction of the largest true one."""
    assert result.keys() == truth.keys()
    for name, expected in truth.items():
        assert result[name].shape == expected.shape, name
        allowed = value if name == "value" else gradient * float(expected.abs().max() if expected.numel() else 0)
        error = (
            float((result[name].double() - expected.double()).abs().nan_to_num(torch.inf).max())
            if expected.numel()
            else 0
        )
        assert error <= allowed, f"{name}: {error:.3g} from the truth, {allowed:.3g} allowed"
