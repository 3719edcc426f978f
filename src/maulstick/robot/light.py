"""sRGB and the amount of light that it stands for (IEC 61966-2-1), for whole photographs."""

import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.float32]


def light_of(colours: Image) -> Image:
    """Light in [0, 1] of sRGB in [0, 1], any shape."""
    colours = np.asarray(colours, dtype=np.float32)
    curved = ((colours + np.float32(0.055)) / np.float32(1.055)) ** np.float32(2.4)
    return np.where(colours <= 0.04045, colours / np.float32(12.92), curved)


def colours_of(light: Image) -> Image:
    """SRGB in [0, 1] of light, any shape; what is darker than black or brighter than white is cut off."""
    light = np.clip(np.asarray(light, dtype=np.float32), 0, 1)
    curved = np.float32(1.055) * light ** np.float32(1 / 2.4) - np.float32(0.055)
    return np.where(light <= 0.0031308, light * np.float32(12.92), curved)
