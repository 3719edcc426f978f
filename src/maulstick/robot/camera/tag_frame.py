"""The four tags beside the sheet's corners by which a photograph is put into the canvas frame."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maulstick.errors import InputError
from maulstick.robot.camera.opencv import opencv
from maulstick.storage.arrays import Floats

TAGS = (0, 1, 2, 3)
"""Upper left, upper right, lower right, lower left."""

MODULES = 8
"""Squares across the black of an AprilTag 36h11; the white around it is one more on each side."""

_OUTWARD = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=np.float64)
_SMALLEST, _LARGEST = 5e-3, 0.5


@dataclass(frozen=True)
class TagFrame:
    """AprilTags 36h11, 0 to 3, on square cards; a card's corner touches the sheet's, and its edges go on from there.

    width, height: of the sheet.  side: of a tag's black square.  gap: from the card's corner to it. All in metres.
    The cards are fixed to what the sheet lies on, not to the sheet.
    """

    width: float
    height: float
    side: float = 20e-3
    gap: float = 15e-3

    def __post_init__(self) -> None:
        if not (self.width > 0 and self.height > 0):
            raise InputError.of_range("the sheet", f"{self.width:g} x {self.height:g} m", "larger than nothing")
        if not _SMALLEST <= self.side <= _LARGEST:
            raise InputError.of_range("the side of a tag", f"{1e3 * self.side:g} mm", "between 5 and 500 mm")
        if not self.quiet <= self.gap <= _LARGEST:
            allowed = f"between {1e3 * self.quiet:g} mm, an eighth of the tag, and 500 mm"
            raise InputError.of_range("the gap beside a tag", f"{1e3 * self.gap:g} mm", allowed)

    @property
    def quiet(self) -> float:
        """The width of the white around a tag, metres."""
        return self.side / MODULES

    @property
    def card(self) -> float:
        """The side of a card, metres."""
        return self.gap + self.side + self.quiet

    def corners(self, tag: int) -> Floats:
        """(4, 2) metres: upper left, upper right, lower right, lower left corner of the tag's black."""
        return self._square(tag, self.gap, self.gap + self.side)

    def card_corners(self, tag: int) -> Floats:
        """(4, 2) metres: the corners of the tag's card, in the same order."""
        return self._square(tag, 0.0, self.card)

    def _square(self, tag: int, near: float, far: float) -> Floats:
        outward = _OUTWARD[tag]
        anchor = (outward > 0) * (self.width, self.height)
        centre = anchor + outward * (near + far) / 2
        return np.asarray(centre + _OUTWARD * (far - near) / 2)

    def card_picture(self, tag: int, pixels_per_metre: float) -> NDArray[np.uint8]:
        """The card as it is printed, grey: a square of whole pixels, black on white."""
        pixels = max(1, round(self.card * pixels_per_metre))
        upper_left, _, lower_right, _ = (self.corners(tag) - self.card_corners(tag)[0]) / self.card * pixels
        left, top = (round(x) for x in upper_left)
        right, bottom = (round(x) for x in lower_right)
        cv2 = opencv()
        family = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36H11)
        black = cv2.aruco.generateImageMarker(family, tag, MODULES)
        picture = np.full((pixels, pixels), 255, dtype=np.uint8)
        picture[top:bottom, left:right] = cv2.resize(black, (right - left, bottom - top), interpolation=0)
        return picture
