"""Corrections of a picture before it is painted: turn, crop, exposure and contrast, which its file never has."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from math import ceil, cos, isfinite, radians, sin
from typing import Any, Final, Self

import numpy as np
from PIL import Image

from maulstick.colour.srgb import colours_of, light_of
from maulstick.errors import InputError, option
from maulstick.painting.picture import MOST_PIXELS
from maulstick.storage.arrays import Pixels

Crop = tuple[float, float, float, float]
"""Left, top, right and lower edge of what is kept, shares of the width and height of the picture as it is turned."""

_Box = tuple[int, int, int, int]  # left, upper, right and lower edge, pixels

WHOLE: Final[Crop] = (0.0, 0.0, 1.0, 1.0)
"""Crop that keeps all of a picture."""

TURNS: Final = (0, 90, 180, 270)
"""Degrees clockwise by which a picture may be turned."""

MOST_STRAIGHTENED: Final = 15.0
"""Degrees by which a picture may be straightened; more would leave little of it, and is a turn."""

MOST_STOPS: Final = 5.0
"""Stops by which a picture may be exposed longer or shorter: beyond, it is white or black."""

CONTRASTS: Final = (0.1, 10.0)
"""Least and largest factor of contrast: nearly one grey, and nearly black and white."""

_GREY = 0.5  # sRGB that contrast leaves as it is: the middle of what the eye tells apart, L* 53


@dataclass(frozen=True, kw_only=True)
class PictureEdit:
    """Corrections of a picture, made in the order of the fields; by default none.

    rotate: degrees clockwise, 0, 90, 180 or 270.
    straighten: degrees clockwise, -15 to 15; the largest part of the same shape without empty corners stays.
    crop: left, top, right and lower edge of what is kept, shares of the turned picture; a pixel stays at least.
    exposure: stops, -5 to 5; each stop doubles the linear light, and what is lighter than white becomes white.
    contrast: factor, 0.1 to 10, of the distance of each sRGB value from mid grey, 0.5.
    Raises InputError for a value that is out of its range.
    """

    rotate: int = 0
    straighten: float = 0.0
    crop: Crop = WHOLE
    exposure: float = 0.0
    contrast: float = 1.0

    def __post_init__(self) -> None:
        if self.rotate not in TURNS or isinstance(self.rotate, bool):
            raise InputError.of_range(option("rotate"), self.rotate, "0, 90, 180 or 270")
        _check_number("straighten", self.straighten, -MOST_STRAIGHTENED, MOST_STRAIGHTENED)
        if not _is_crop(self.crop):
            raise InputError(
                f"{option('crop')} is {_plain(self.crop)}; it must be the left, top, right and lower edge of what is "
                "kept, as shares of the picture from 0 to 1, as in 0.1,0,0.9,1"
            )
        _check_number("exposure", self.exposure, -MOST_STOPS, MOST_STOPS)
        _check_number("contrast", self.contrast, *CONTRASTS)

    @classmethod
    def of(cls, options: Mapping[str, Any]) -> Self:
        """Return the edit among the options of a painting's provenance; none where it names none."""
        given = {field.name: options[field.name] for field in fields(cls) if field.name in options}
        if isinstance(crop := given.get("crop"), list):
            given["crop"] = tuple(crop)
        return cls(**given)

    def read_px(self, pixels: int) -> int:
        """Return the length in pixels to read either side of a picture at, so that the crop keeps so many of it."""
        left, top, right, bottom = self.crop
        return ceil(min(pixels / min(right - left, bottom - top), MOST_PIXELS))  # no side has more

    def applied(self, picture: Pixels) -> Pixels:
        """Return the picture (H, W, 3), sRGB in [0, 1], with these corrections, (h, w, 3)."""
        picture = self._upright(picture)
        return self.toned(_straightened(picture, self.straighten, self._edges(*picture.shape[:2])))

    def shape(self, picture: tuple[int, ...]) -> tuple[int, int]:
        """Return the shape (h, w) of what it leaves of a picture of this shape (H, W, ...)."""
        height, width = picture[:2] if self.rotate % 180 == 0 else picture[1::-1]
        left, top, right, bottom = self._edges(height, width)
        return bottom - top, right - left

    def turned(self, picture: Pixels) -> Pixels:
        """Return the picture (H, W, 3) turned and straightened."""
        picture = self._upright(picture)
        return _straightened(picture, self.straighten, (0, 0, picture.shape[1], picture.shape[0]))

    def cut(self, picture: Pixels) -> Pixels:
        """Return what the crop keeps of a picture (H, W, 3)."""
        return _straightened(picture, 0.0, self._edges(*picture.shape[:2]))

    def toned(self, picture: Pixels) -> Pixels:
        """Return the picture (H, W, 3) exposed, and with its contrast."""
        if self.exposure:
            picture = colours_of(light_of(picture) * np.float32(2**self.exposure))
        if self.contrast != 1:
            picture = (_GREY + np.float32(self.contrast) * (picture - np.float32(_GREY))).clip(0, 1)
        return picture.astype(np.float32, copy=False)

    def _upright(self, picture: Pixels) -> Pixels:
        """Return a view of the picture (H, W, 3), turned."""
        return np.rot90(picture, -self.rotate // 90)

    def _edges(self, height: int, width: int) -> _Box:
        """Return the first column and row that the crop keeps, and those after the last."""
        left, top, right, bottom = self.crop
        (first, last), (upper, lower) = _kept(left, right, width), _kept(top, bottom, height)
        return first, upper, last, lower


def _kept(first: float, last: float, length: int) -> tuple[int, int]:
    """Return the first pixel, and the one after the last, that a crop keeps of so many: one at least."""
    begin = min(round(first * length), length - 1)
    return begin, max(round(last * length), begin + 1)


def _straightened(picture: Pixels, degrees: float, box: _Box) -> Pixels:
    """Return the box of a picture (H, W, 3) turned about its middle and enlarged, so that it fills its frame.

    A part is a copy, or it would keep the whole in memory.
    """
    left, top, right, bottom = box
    height, width = picture.shape[:2]
    if not degrees:
        part = picture[top:bottom, left:right]
        return np.ascontiguousarray(part) if part.shape == picture.shape else part.copy()
    along, across = cos(radians(degrees)), sin(radians(degrees))
    scale = min(
        height / (height * along + width * abs(across)),
        width / (width * along + height * abs(across)),
    )
    a, b, c, d = scale * along, scale * across, -scale * across, scale * along
    x, y = width / 2, height / 2
    from_x, from_y = left - x, top - y
    matrix = (a, b, x + a * from_x + b * from_y, c, d, y + c * from_x + d * from_y)  # from the result to the picture
    turned = np.empty((bottom - top, right - left, 3), dtype=picture.dtype)
    for i in range(3):
        channel = Image.fromarray(np.ascontiguousarray(picture[..., i]))
        size = right - left, bottom - top
        turned[..., i] = np.asarray(channel.transform(size, Image.Transform.AFFINE, matrix, Image.Resampling.BICUBIC))
    return turned.clip(0, 1)


def _is_crop(crop: object) -> bool:
    if not isinstance(crop, tuple) or len(crop) != 4 or not all(isinstance(edge, int | float) for edge in crop):
        return False
    left, top, right, bottom = crop
    return bool(0 <= left < right <= 1 and 0 <= top < bottom <= 1)


def _plain(crop: object) -> str:
    return ",".join(map(str, crop)) if isinstance(crop, tuple) else repr(crop)


def _check_number(name: str, value: object, least: float, most: float) -> None:
    if not isinstance(value, int | float) or not isfinite(value) or not least <= value <= most:
        raise InputError.of_range(option(name), value, f"from {least:g} to {most:g}")


NO_EDIT: Final = PictureEdit()
"""Edit that leaves every picture as it is."""
