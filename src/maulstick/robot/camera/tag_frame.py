"""The four tags beside the sheet's corners by which a photograph is put into the canvas frame."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maulstick.errors import InputError, option
from maulstick.robot.camera.opencv import opencv
from maulstick.storage.arrays import Floats

TAGS = (0, 1, 2, 3)
"""Ids of the tags at the upper left, upper right, lower right and lower left corner."""

MODULES = 8
"""Squares across the black part of an AprilTag 36h11; its white rim is one more on each side."""

_OUTWARD = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=np.float64)  # signs of x and y, by tag
_SMALLEST, _LARGEST = 5e-3, 0.5  # metres: smallest and largest side of a tag, and the largest gap


@dataclass(frozen=True)
class TagFrame:
    """Frame of four AprilTags 36h11, 0 to 3, on square cards around a sheet.

    A card's corner touches the sheet's corner, and its edges continue the sheet's edges.
    width, height: size of the sheet.  side: of a tag's black square.  gap: from the card's corner to it. All in metres.
    The cards are fixed to what the sheet lies on, not to the sheet.
    """

    width: float
    height: float
    side: float = 20e-3
    gap: float = 15e-3

    def __post_init__(self) -> None:
        if not (self.width > 0 and self.height > 0):
            raise InputError.of_range("the sheet", f"{self.width:g} x {self.height:g} m", "larger than nothing")
        least = _SMALLEST / MODULES
        if not least <= self.gap <= _LARGEST:
            allowed = f"between {1e3 * least:g} and {1e3 * _LARGEST:g} mm"
            raise InputError.of_range("the gap beside a tag", f"{1e3 * self.gap:g} mm", allowed)
        most = min(MODULES * self.gap, _LARGEST)  # its white rim lies within the gap
        if not _SMALLEST <= self.side <= most:
            allowed = f"between {1e3 * _SMALLEST:g} and {1e3 * most:g} mm, for a gap of {1e3 * self.gap:g} mm beside it"
            raise InputError.of_range(option("tag"), f"{1e3 * self.side:g} mm", allowed)

    @property
    def quiet(self) -> float:
        """Width of the white rim around a tag, metres."""
        return self.side / MODULES

    @property
    def card(self) -> float:
        """Side of a card, metres."""
        return self.gap + self.side + self.quiet

    def corners(self, tag: int) -> Floats:
        """Return the corners (4, 2) of a tag's black square, metres: upper left, then clockwise."""
        return self._square(tag, self.gap, self.gap + self.side)

    def card_corners(self, tag: int) -> Floats:
        """Return the corners (4, 2) of a tag's card, metres, in the same order."""
        return self._square(tag, 0.0, self.card)

    def _square(self, tag: int, near: float, far: float) -> Floats:
        """Return the corners (4, 2) of the square from `near` to `far` of the sheet's corner, metres."""
        outward = _OUTWARD[tag]
        anchor = (outward > 0) * (self.width, self.height)
        centre = anchor + outward * (near + far) / 2
        return np.asarray(centre + _OUTWARD * (far - near) / 2)

    def card_picture(self, tag: int, pixels_per_metre: float) -> NDArray[np.uint8]:
        """Draw a card as it is printed: (n, n) grey, 0 to 255, black on white."""
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
