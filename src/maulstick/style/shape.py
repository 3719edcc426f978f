"""Code of a stroke's shape: its length, a spline, and the residual that the spline leaves.

The cubic B-spline through a standardised path has nine control points, the first at the origin and the last on the
x-axis: 15 numbers, in units of the spline's length, which with the logarithm of that length make the 16 of a **gist**.
The spline leaves a residual of 47 numbers, in the same unit and in an orthonormal basis of what splines cannot draw.
It is small, but it makes the difference between a human stroke and a smooth curve. Gist and residual together give the
path again, to float precision.
"""

from functools import cache
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.interpolate import BSpline
from torch import Tensor
from torch.autograd.function import once_differentiable

from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import POINTS
from maulstick.style import _shape

_DEGREE = 3  # cubic: continuous curvature
_CONTROL_POINTS = 9  # changing it would change every stored style
_SPLINE = 2 * (_CONTROL_POINTS - 1) - 1  # free numbers: the first point is the origin, the last has no y
GIST = 1 + _SPLINE
"""Number of numbers in a stroke's gist: log length, and eight control points whose last has no y."""

RESIDUAL = 2 * (POINTS - 1) - _SPLINE
"""Number of numbers in a stroke's residual."""

_SHORTEST = 1e-6  # metres: keeps a spline without length out of the denominators


def spline_basis(control_points: int) -> Floats:
    """Basis (32, control_points) of a clamped cubic B-spline at equal steps of its parameter."""
    knots = np.concatenate([np.zeros(_DEGREE), np.linspace(0, 1, control_points - _DEGREE + 1), np.ones(_DEGREE)])
    basis: Floats = BSpline.design_matrix(np.linspace(0, 1, POINTS), knots, _DEGREE).toarray()
    return basis


def encode(paths: Tensor) -> Tensor:
    """Return gist and residual, (N, 63), of standardised paths (N, 32, 2), metres."""
    parts = [paths[:, 1:, axis] @ _tensor(_inverse(axis), paths) for axis in (0, 1)]
    splines = [part[:, : _splines(axis)] for axis, part in enumerate(parts)]
    residuals = [part[:, _splines(axis) :] for axis, part in enumerate(parts)]
    length = _length(*splines)
    return torch.cat([length.log(), *(part / length for part in splines + residuals)], dim=1)


def decode(numbers: Tensor) -> Tensor:
    """Return standardised paths (N, 32, 2), metres, of gist and residual, (N, 63)."""
    gist, residual = parts(numbers)
    return drawn(gist, strays(residual))


def parts(numbers: Tensor) -> tuple[Tensor, Tensor]:
    """Return gist (…, 16) and residual (…, 47) of numbers (…, 63)."""
    return numbers[..., :GIST], numbers[..., GIST:]


def strays(residual: Tensor) -> Tensor:
    """Return how far residuals (N, 47) take points off the spline, x and y, (N, 2, 32) in units of its length."""
    each = residual.split([POINTS - 1 - _splines(axis) for axis in (0, 1)], dim=1)
    off = [rest @ _tensor(_basis(axis)[:, _splines(axis) :].T, rest) for axis, rest in enumerate(each)]
    return torch.nn.functional.pad(torch.stack(off, dim=1), (1, 0))


def drawn(gist: Tensor, strays: Tensor) -> Tensor:
    """Return standardised paths (N, 32, 2), metres, of gist (N, 16) and strays (N, 2, 32) off the spline."""
    if gist.device.type == "cpu" and gist.dtype == torch.float32:
        paths: Tensor = _Drawn.apply(gist.contiguous(), strays.contiguous())
        return paths
    return plain_drawn(gist, strays)


def plain_drawn(gist: Tensor, strays: Tensor) -> Tensor:
    """Return the same as `drawn`, plainly: on any device, in any precision."""
    size = gist[:, :1].exp()
    splines = gist[:, 1:].split([_splines(axis) for axis in (0, 1)], dim=1)
    scale = size / _length(*splines)
    along = [
        torch.nn.functional.pad((spline * scale) @ _tensor(_basis(axis)[:, : _splines(axis)].T, gist), (1, 0))
        for axis, spline in enumerate(splines)
    ]
    return torch.stack(along, dim=-1) + size[:, :, None] * strays.mT


class _Drawn(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, gist: Tensor, strays: Tensor) -> Tensor:
        ctx.save_for_backward(gist, strays)
        paths = gist.new_empty(len(gist), POINTS, 2)
        _shape.draw(gist.detach().numpy(), strays.detach().numpy(), *bases(), paths.numpy())
        return paths

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad_out: Tensor) -> tuple[Tensor | None, Tensor | None]:
        gist, strays = (tensor.detach() for tensor in ctx.saved_tensors)
        wanted = ctx.needs_input_grad[1]  # of a residual, which a planner leaves as it is
        of_gist, of_strays = torch.empty_like(gist), strays.new_empty(len(strays) if wanted else 0, 2, POINTS)
        given, found = (gist.numpy(), strays.numpy()), (of_gist.numpy(), of_strays.numpy())
        _shape.draw_backward(*given, *bases(), grad_out.contiguous().numpy(), *found)
        return of_gist, of_strays if wanted else None


@cache
def bases() -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Bases (8, 32) for x and (7, 32) for y of the spline: what each number of a gist adds to each point."""
    x, y = (np.pad(_basis(axis)[:, : _splines(axis)].T, ((0, 0), (1, 0))).astype(np.float32) for axis in (0, 1))
    return x, y


def _length(spline_x: Tensor, spline_y: Tensor) -> Tensor:
    """Length of the splines with these control points, (N, 1), metres."""
    x, y = (part @ _tensor(_basis(axis)[:, : _splines(axis)].T, part) for axis, part in enumerate((spline_x, spline_y)))
    steps = torch.nn.functional.pad(torch.stack([x, y], dim=-1), (0, 0, 1, 0)).diff(dim=1)
    squares = steps.square().sum(-1)
    return squares.clamp(min=torch.finfo(squares.dtype).tiny).sqrt().sum(1, keepdim=True).clamp(min=_SHORTEST)


def _splines(axis: int) -> int:
    return _CONTROL_POINTS - 1 - axis


@cache
def _basis(axis: int) -> Floats:
    """Basis (31, 31) for x or y: the spline's, then an orthonormal one of its orthogonal complement.

    The latter is made of cosines by the Gram-Schmidt process; its signs are fixed, so that a code means the same stroke
    on every machine.
    """
    spline = spline_basis(_CONTROL_POINTS)[1:, 1 : 1 + _splines(axis)]
    along = (np.arange(POINTS - 1) + 0.5) * np.pi / (POINTS - 1)
    waves = np.cos(np.outer(along, np.arange(_splines(axis), POINTS - 1)))
    q, r = np.linalg.qr(np.concatenate([spline, waves], axis=1))
    q = q * np.sign(np.diag(r))
    return np.concatenate([spline, q[:, _splines(axis) :]], axis=1)


@cache
def _inverse(axis: int) -> Floats:
    return np.asarray(np.linalg.inv(_basis(axis)).T, dtype=np.float64)


def _tensor(array: Floats, like: Tensor) -> Tensor:
    return torch.from_numpy(np.ascontiguousarray(array)).to(like)
