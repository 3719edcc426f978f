"""Checks of the arguments of the reference and of the fast kernels."""

import torch
from torch import Tensor

from maulstick.errors import InputError


def plain(*tensors: Tensor) -> list[Tensor]:
    """Return the tensors as the kernels read them, contiguous float32; check these, since a number may overflow."""
    return [x.to(torch.float32).contiguous() for x in tensors]


def check_strokes(points: Tensor, thickness: Tensor, falloff: Tensor, plateau: Tensor, opacity: Tensor) -> None:
    """Check that the strokes can be drawn.

    points: (N, n, 2) pixels, n >= 1.  thickness: (N, n) pixels.  falloff, plateau, opacity: (N,) or (1,).

    Raises InputError for a shape, and naming the stroke for a coordinate or number that is not finite or out of range.
    """
    check_shapes(points, thickness, falloff=falloff, plateau=plateau, opacity=opacity)
    _check_each(points.isfinite().all(dim=2), points, "a point")
    _check_each(thickness.isfinite(), thickness, "a thickness")
    for name, value, valid, allowed in (
        ("falloff", falloff, (falloff > 0) & falloff.isfinite(), "above 0"),
        ("plateau", plateau, (plateau >= 0) & (plateau < 1), "in [0, 1)"),
        ("opacity", opacity, (opacity > 0) & (opacity <= 1), "in (0, 1]"),
    ):
        if not valid.all():
            stroke = int(valid.logical_not().nonzero()[0])
            raise InputError.of_range(f"{name} of stroke {stroke}", f"{float(value[stroke]):g}", allowed)


def check_shapes(points: Tensor, thickness: Tensor, **numbers: Tensor) -> None:
    """Check that points (N, n, 2), thickness (N, n) and numbers (N,) or (1,) fit together; else InputError."""
    if points.ndim != 3 or points.shape[2] != 2 or points.shape[1] < 1:
        raise InputError(f"points have shape {tuple(points.shape)}; they must be (N, n, 2) with n of at least 1")
    count = points.shape[0]
    if thickness.shape != points.shape[:2]:
        raise InputError(f"thickness has shape {tuple(thickness.shape)}; points ask for {tuple(points.shape[:2])}")
    for name, value in numbers.items():
        if value.ndim != 1 or value.shape[0] not in (1, count):
            raise InputError(f"{name} has shape {tuple(value.shape)}; it must be ({count},) or (1,)")


def check_canvas(canvas: Tensor, points: Tensor, colours: Tensor, trainable: Tensor | None) -> None:
    """Check that a canvas (C, H, W), colours (N, C) and a mask `trainable` (N,) bool fit together; else InputError."""
    if canvas.ndim != 3 or canvas.numel() == 0:
        raise InputError(f"the canvas has shape {tuple(canvas.shape)}; it must be (C, H, W), none of them 0")
    if colours.shape != (points.shape[0], canvas.shape[0]):
        raise InputError(f"colours have shape {tuple(colours.shape)}; it must be {(points.shape[0], canvas.shape[0])}")
    if trainable is not None and (trainable.shape != points.shape[:1] or trainable.dtype != torch.bool):
        raise InputError(
            f"trainable is {trainable.dtype} {tuple(trainable.shape)}; it must be torch.bool {tuple(points.shape[:1])}"
        )


def check_colours(colours: Tensor) -> None:
    """Check that colours (N, C) are finite. Raises InputError naming the stroke of one that is not."""
    _check_each(colours.isfinite(), colours, "a colour")


def check_size(height: int, width: int) -> None:
    """Check that an image has pixels. Raises InputError where it has none."""
    if height < 1 or width < 1:
        raise InputError.of_range("the image size", f"{height} x {width}", "at least 1 x 1")


def _check_each(valid: Tensor, values: Tensor, what: str) -> None:
    if not valid.all():
        stroke, place = (int(i) for i in valid.logical_not().nonzero()[0])
        came = values[stroke, place].tolist()
        raise InputError(f"stroke {stroke} has {what} that is not finite: {came} at index {place}")
