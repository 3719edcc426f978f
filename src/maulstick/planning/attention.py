"""How much each place of a picture matters to a person: a face more than its surroundings."""

import numpy as np
from numpy.typing import NDArray
from skimage.data import lbp_frontal_face_cascade_filename
from skimage.feature import Cascade
from skimage.transform import resize

_FACE = 3.0
_SEARCHED_PX = 400
_SMALLEST = 1 / 12


def attention(picture: NDArray[np.float32]) -> NDArray[np.float64]:
    """Weights (H, W), of mean 1, for a picture (H, W, 3) in [0, 1]; even where there is no frontal face."""
    height, width = picture.shape[:2]
    scale = _SEARCHED_PX / max(height, width)
    weights = np.ones((height, width))
    y, x = np.mgrid[:height, :width] + 0.5
    for face in _faces(resize(picture, (max(1, round(height * scale)), max(1, round(width * scale))))):
        radius = face["height"] / scale / 2
        centre_y, centre_x = (face["r"] + face["height"] / 2) / scale, (face["c"] + face["width"] / 2) / scale
        away = np.hypot(y - centre_y, x - centre_x) / radius
        weights = np.maximum(weights, 1 + _FACE * np.clip(2 - away, 0, 1))
    weights /= weights.mean()
    return weights


def _faces(picture: NDArray[np.float32]) -> list[dict[str, int]]:
    side = min(picture.shape[:2])
    if side < 1 / _SMALLEST * 4:
        return []
    smallest = max(24, round(_SMALLEST * side))
    found: list[dict[str, int]] = Cascade(lbp_frontal_face_cascade_filename()).detect_multi_scale(
        np.round(picture * 255).astype(np.uint8),
        scale_factor=1.2,
        step_ratio=1,
        min_size=(smallest, smallest),
        max_size=(side, side),
    )
    return found
