"""Attention: how much each place of a picture matters to a viewer. A face matters more than its surroundings."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from skimage.data import lbp_frontal_face_cascade_filename
from skimage.feature import Cascade
from skimage.transform import resize

from maulstick.storage.arrays import Floats, Image

_FACE = 3.0  # weight that faces=1 adds to the usual 1 within a face; it falls to 0 at twice the face's radius
_SEARCHED_PX = 400  # longest side of the copy that is searched, which bounds the time of the search
_SMALLEST = 1 / 12  # smallest face that is searched for, as a share of the picture's shorter side


@dataclass(frozen=True)
class Face:
    """A frontal face in a picture: the middle of its square and half the side of it, pixels."""

    x: float
    y: float
    radius: float


def attention(height: int, width: int, found: Sequence[Face], faces: float = 1.0) -> Floats:
    """Return weights (H, W), of mean 1, for a picture of that many pixels; all 1 where no face is found in it.

    faces: how much more a face counts than its surroundings: 0 not at all, 1 four times as much.
    """
    weights = np.ones((height, width))
    y, x = np.mgrid[:height, :width] + 0.5
    for face in found:
        away = np.hypot(y - face.y, x - face.x) / face.radius
        weights = np.maximum(weights, 1 + faces * _FACE * np.clip(2 - away, 0, 1))
    weights /= weights.mean()
    return weights


def find_faces(picture: Image) -> list[Face]:
    """Return the frontal faces in a picture (H, W, 3) in [0, 1], as a cascade of local binary patterns sees them."""
    height, width = picture.shape[:2]
    scale = _SEARCHED_PX / max(height, width)
    squares = _squares(resize(picture, (max(1, round(height * scale)), max(1, round(width * scale)))))
    return [
        Face(
            (square["c"] + square["width"] / 2) / scale,
            (square["r"] + square["height"] / 2) / scale,
            square["height"] / scale / 2,
        )
        for square in squares
    ]


def _squares(picture: Image) -> list[dict[str, int]]:
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
