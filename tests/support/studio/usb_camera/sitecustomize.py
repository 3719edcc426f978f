"""Stand-in for a USB camera: OpenCV's own class, in every process that Python starts with this folder on its path.

It sees a white sheet on a grey table.
"""

import cv2
import numpy as np
from sheet_seen import CORNERS, SIZE


class _Video:
    def __init__(self, index: int) -> None:
        self._there = index == 0

    def isOpened(self) -> bool:  # noqa: N802
        return self._there

    def set(self, _: int, __: float) -> bool:
        return True

    def grab(self) -> bool:
        return True

    def read(self) -> tuple[bool, np.ndarray]:
        picture = np.full((SIZE[1], SIZE[0], 3), 90, dtype=np.uint8)
        return True, cv2.fillPoly(picture, [np.array(CORNERS)], (220, 220, 220))

    def release(self) -> None:
        pass


cv2.VideoCapture = _Video
