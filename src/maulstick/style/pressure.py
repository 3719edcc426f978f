"""Pressure along a stroke as a few knots; the paper optimises its heights as parameters of their own."""

from functools import cache

import numpy as np
import torch
from torch import Tensor

from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import POINTS

KNOTS = 4
"""Number of a stroke's pressure knots, equally spaced along it."""


def pressure_along(knots: Tensor) -> Tensor:
    """Pressure (N, 32) at each point of strokes with pressure knots (N, 4), linear between knots."""
    return knots @ _hats_as(knots.dtype, knots.device)


def fit_knots(pressure: Floats) -> Floats:
    """Pressure knots (N, 4) in [0, 1] nearest to the pressure (N, 32); NaN where a stroke's was not recorded."""
    return np.clip(pressure @ np.linalg.pinv(_hats()), 0, 1)


@cache
def _hats() -> Floats:
    at = np.linspace(0, KNOTS - 1, POINTS)
    hats: Floats = (1 - np.abs(at[None] - np.arange(KNOTS)[:, None])).clip(min=0)
    return hats


@cache
def _hats_as(dtype: torch.dtype, device: torch.device) -> Tensor:
    return torch.from_numpy(_hats()).to(device, dtype)
