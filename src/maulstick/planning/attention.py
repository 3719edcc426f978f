"""Attention: how much each place of a picture matters to a viewer. A face matters more than its surroundings."""

import numpy as np
from skimage.data import lbp_frontal_face_cascade_filename
from skimage.feature import Cascade
from skimage.transform import resize

from maulstick.storage.arrays import Floats, Image

_FACE = 3.0  # weight added to the usual 1 within a face; it falls to 0 at twice the face's radius
_SEARCHED_PX = 400  # longest side of the copy that is searched, which bounds the time of the search
_SMALLEST = 1 / 12  # smallest face that is searched for, as a share of the picture's shorter side


def attention(picture: Image) -> Floats:
    """Return weights (H, W), of mean 1, for a picture (H, W, 3) in [0, 1]; all 1 without a frontal face."""
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


def _faces(picture: Image) -> list[dict[str, int]]:
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
