"""Agreement of a GPU's kernels with the CPU's, on a small scene: what a GPU has to show before it plans a painting."""

from types import ModuleType

import torch
from torch import Tensor

from maulstick.rendering.kernels import cpu

_STROKES, _POINTS, _HEIGHT, _WIDTH = 8, 4, 24, 40  # of the scene: several tiles, strokes one upon another
_VALUE = 2e-5  # largest difference of a colour in [0, 1]: two float32 renderers, each within 5e-6 of the reference
_GRADIENT = 5e-4  # the same of a gradient, as a share of its largest entry; each is within 1e-4 of the reference


def disagreement(kernels: ModuleType, device: torch.device) -> str | None:
    """Return in which result these kernels differ from the CPU's on this device, and by how much; None for none.

    Both paint one scene of random strokes, forward and backward; the canvas and every gradient are compared.
    """
    for name, (expected, found) in _results(kernels, device).items():
        allowed = _VALUE if name == "canvas" else _GRADIENT * float(expected.abs().max())
        error = float((found.cpu() - expected).abs().nan_to_num(torch.inf).max())
        if error > allowed:
            return f"its {name} is {error:.2g} off, and {allowed:.2g} is allowed"
    return None


def _results(kernels: ModuleType, device: torch.device) -> dict[str, tuple[Tensor, Tensor]]:
    """Return the painted canvas and the gradient of each argument: by the CPU's kernels, and by these."""
    scene = _scene()
    torch_rng = torch.Generator().manual_seed(1)
    signal = torch.randn(scene["canvas"].shape, generator=torch_rng)
    by_cpu, by_gpu = (
        _painted(module, {name: x.to(where, copy=True) for name, x in scene.items()}, signal.to(where))
        for module, where in ((cpu, torch.device("cpu")), (kernels, device))
    )
    return {name: (by_cpu[name], by_gpu[name]) for name in by_cpu}


def _painted(kernels: ModuleType, scene: dict[str, Tensor], signal: Tensor) -> dict[str, Tensor]:
    leaves = {name: x.requires_grad_() for name, x in scene.items()}
    for _ in range(4 if signal.is_cuda else 1):  # a GPU records what comes again, and replays it by then
        canvas: Tensor = kernels.composite(**leaves)
        gradients = torch.autograd.grad(canvas, list(leaves.values()), signal)
    names = ("gradient of " + name for name in leaves)
    return {"canvas": canvas.detach(), **dict(zip(names, gradients, strict=True))}


def _scene() -> dict[str, Tensor]:
    """Return all that `composite` takes: strokes that wander over the canvas, broad and thin, hard and soft."""
    torch_rng = torch.Generator().manual_seed(0)

    def uniform(low: float, high: float, *shape: int) -> Tensor:
        return low + (high - low) * torch.rand(*shape, generator=torch_rng)

    steps = uniform(-6, 6, _STROKES, _POINTS, 2).cumsum(1)
    return {
        "canvas": uniform(0, 1, 3, _HEIGHT, _WIDTH),
        "points": uniform(-0.1, 1.1, _STROKES, 1, 2) * torch.tensor([_WIDTH, _HEIGHT]) + steps,
        "thickness": uniform(0.5, 5, _STROKES, _POINTS),
        "colours": uniform(0, 1, _STROKES, 3),
        "falloff": uniform(0.6, 3, _STROKES),
        "plateau": uniform(0, 0.7, _STROKES),
        "opacity": uniform(0.3, 1, _STROKES),
    }
