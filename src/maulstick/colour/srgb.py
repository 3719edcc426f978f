"""Conversion between sRGB and linear light (IEC 61966-2-1)."""

from typing import TypeVar

import numpy as np

from maulstick.storage.arrays import Floats, Image

Values = TypeVar("Values", Image, Floats)


def light_of(colours: Values) -> Values:
    """Linear light in [0, 1] of sRGB in [0, 1], any shape, in the precision of the argument."""
    return np.where(colours <= 0.04045, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4)


def colours_of(light: Values) -> Values:
    """Return sRGB in [0, 1] of linear light, any shape; light outside [0, 1] is clipped."""
    light = light.clip(0, 1)
    return np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1 / 2.4) - 0.055)
