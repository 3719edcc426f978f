"""What the benchmarks of planning have in common: photographs of scikit-image, laid out 160 mm high."""

from pathlib import Path

import numpy as np
from skimage import data

from maulstick.painting.brush import load_brush
from maulstick.painting.painting import Sheet
from maulstick.planning.layout import Layout, lay_out_for

IMAGES = ("astronaut", "camera", "chelsea", "coffee", "rocket", "hubble_deep_field")
HEIGHT = 0.16
BRUSH = load_brush(str(Path(__file__).with_name("round.json")))


def load(image: str) -> np.ndarray:
    """(H, W, 3) sRGB in [0, 1]."""
    picture = getattr(data, image)()
    if picture.ndim == 2:
        picture = np.repeat(picture[..., None], 3, axis=2)
    return picture.astype(np.float32) / (255 if picture.max() > 1 else 1)


def laid_out(image: str, px: int) -> Layout:
    """To be painted on all of a sheet, at so many pixels of height."""
    picture = load(image)
    sheet = Sheet(width=HEIGHT * picture.shape[1] / picture.shape[0], height=HEIGHT)
    return lay_out_for(picture, sheet, BRUSH, "contain", px)
