"""Pictures to be painted: any photograph as sRGB."""

import io
import warnings
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageCms, UnidentifiedImageError
from PIL.TiffImagePlugin import TiffImageFile

from maulstick.errors import InputError
from maulstick.painting.formats import FORMATS, formats_of
from maulstick.painting.raster import Canvas
from maulstick.storage.arrays import Pixels
from maulstick.storage.files import file_to_read

Picture = str | Path | Image.Image | NDArray[np.generic]
"""What a picture may be in Python: a path, a Pillow image, or an array."""

READ_PX = 4096
"""Longest side of a picture that is read to be planned in one piece, pixels: finer than any such canvas."""

LONGEST_KEPT_PX = 4096
"""Longest side of a picture that is kept within another file, pixels."""

MOST_PIXELS = 100_000_000
"""Pixels of the largest picture that is read, which bounds the memory that it takes."""

_QUALITY = 88  # of a JPEG, on Pillow's scale up to 95
_STRETCH = 0.02  # how much the shapes of photograph and sheet may differ
_BITS, _PHOTOMETRIC, _ORIENTATION, _PLANES = 258, 262, 274, 284  # tags of EXIF and TIFF
_UPRIGHT = {  # what undoes each orientation of EXIF
    2: Image.Transpose.FLIP_LEFT_RIGHT,
    3: Image.Transpose.ROTATE_180,
    4: Image.Transpose.FLIP_TOP_BOTTOM,
    5: Image.Transpose.TRANSPOSE,
    6: Image.Transpose.ROTATE_270,
    7: Image.Transpose.TRANSVERSE,
    8: Image.Transpose.ROTATE_90,
}
_LANCZOS = Image.Resampling.LANCZOS


def read_picture(path: str | Path, longest_px: int | None = None, shortest_px: int = 0) -> Pixels:
    """Return a picture as (H, W, 3) sRGB in [0, 1]: upright, on white where it is transparent, the first of several.

    longest_px: scale it down so that no side is longer; a large JPEG is then never decoded whole.
    shortest_px: but not so far that its shorter side has fewer.
    Raises InputError where the file is missing, damaged, not a picture, or one of more than 100 megapixels.
    """
    if longest_px is not None and longest_px < 1:
        raise InputError.of_range("the longest side in pixels", longest_px, "at least 1")
    path = file_to_read(path, "picture")
    too_large = f"the picture {path} has more than {MOST_PIXELS // 10**6} megapixels; scale it down first"
    try:
        with warnings.catch_warnings():  # Pillow warns of odd metadata and of sizes that are allowed here
            warnings.simplefilter("ignore")
            with Image.open(path, formats=formats_of(path)) as image:
                if image.width * image.height > MOST_PIXELS:
                    raise InputError(too_large)
                return _decode(image, longest_px or max(image.size), shortest_px)
    except InputError:
        raise
    except Image.DecompressionBombError as error:
        raise InputError(too_large) from error
    except UnidentifiedImageError as error:
        formats = ", ".join(FORMATS)
        raise InputError(f"{path} is not a picture that can be read; save it as one of {formats}") from error
    except Exception as error:  # decoders raise anything on a damaged file
        raise InputError(f"cannot read the picture {path}: {_reason(error)}; save or copy it again") from error


def image_of(picture: Picture, longest_px: int = READ_PX, shortest_px: int = 0) -> Pixels:
    """Return (H, W, 3) sRGB in [0, 1] of a path, a Pillow image, or an array (H, W, 3) or (H, W), scaled down.

    longest_px, shortest_px: as for `read_picture`.
    Raises InputError for a file or an image that cannot be read or has no pixels, and for an array that is neither
    uint8 nor float in [0, 1]: its values are never clipped or scaled.
    """
    if isinstance(picture, str | Path):
        return read_picture(picture, longest_px, shortest_px)
    if isinstance(picture, Image.Image):
        return _image_of(picture, longest_px, shortest_px)
    try:
        pixels = np.asarray(picture)
    except Exception as error:  # as of rows of unlike length, or of a tensor on a GPU
        raise InputError(
            f"the picture is no array: {_reason(error)}; give one (H, W, 3), or (H, W) for greys"
        ) from error
    if pixels.ndim not in (2, 3) or (pixels.ndim == 3 and pixels.shape[2] != 3) or 0 in pixels.shape:
        raise InputError(f"the picture has shape {pixels.shape}; it must be (H, W, 3), or (H, W) for greys")
    if pixels.dtype == np.uint8:
        image: Pixels = pixels.astype(np.float32) / np.float32(255)
    elif pixels.dtype.kind == "f":
        if not (pixels.min() >= 0 and pixels.max() <= 1):  # NaN is neither
            reach = " to ".join(np.format_float_positional(end, trim="-") for end in (pixels.min(), pixels.max()))
            raise InputError(f"the picture has values from {reach}; floats must be in [0, 1], so divide them first")
        image = pixels.astype(np.float32)
    else:
        raise InputError(f"the picture is an array of {pixels.dtype}; give uint8, or float in [0, 1]")
    if image.ndim == 2:
        image = np.repeat(image[..., None], 3, axis=2)
    size = _at_most((image.shape[1], image.shape[0]), longest_px, shortest_px)
    if size == (image.shape[1], image.shape[0]):
        return image
    return scaled(image, size, (0, 0, image.shape[1], image.shape[0]))


def _image_of(image: Image.Image, longest_px: int, shortest_px: int) -> Pixels:
    if 0 in image.size:
        raise InputError(f"the picture has {image.width} x {image.height} pixels; it must have one at least")
    try:
        return _decode(image.copy(), longest_px, shortest_px)
    except Exception as error:  # one that was opened but not read yet is decoded here, and its file may be damaged
        raise InputError(f"cannot read the picture: {_reason(error)}; convert it to RGB first") from error


def decode_png(content: bytes) -> Pixels:
    """Return a PNG that is kept within another file as (H, W, 3) sRGB in [0, 1].

    Raises InputError where it is not a PNG, damaged, or longer than 4096 pixels on a side.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with Image.open(io.BytesIO(content), formats=("PNG",)) as image:
                if max(image.size) > LONGEST_KEPT_PX:
                    size = f"{image.width} x {image.height} pixels"
                    raise InputError.of_range("the picture", size, f"at most {LONGEST_KEPT_PX} on a side")
                return _decode(image, LONGEST_KEPT_PX)
    except InputError:
        raise
    except Image.DecompressionBombError as error:
        raise InputError(
            f"the picture has more than {LONGEST_KEPT_PX} pixels on a side; scale it down first"
        ) from error
    except UnidentifiedImageError as error:
        raise InputError("the picture is not a PNG; save it as one") from error
    except Exception as error:  # decoders raise anything on damaged bytes
        raise InputError(f"the picture is a damaged PNG: {_reason(error)}; embed it again") from error


def encode_png(picture: Pixels) -> bytes:
    """Return a picture (H, W, 3) in [0, 1] as a PNG with 8 bits per channel."""
    file = io.BytesIO()
    Image.fromarray(np.round(picture * 255).astype(np.uint8)).save(file, format="PNG")
    return file.getvalue()


def encode_jpeg(picture: Pixels, longest_px: int | None = None) -> bytes:
    """Return a picture (H, W, 3) in [0, 1] as a JPEG, scaled down so that no side is longer than `longest_px`."""
    image = Image.fromarray(np.round(picture * 255).astype(np.uint8))
    if longest_px is not None:
        image.thumbnail((longest_px, longest_px))
    file = io.BytesIO()
    image.save(file, format="JPEG", quality=_QUALITY)
    return file.getvalue()


def canvas_photograph(path: str | Path, canvas: Canvas) -> Pixels:
    """Return a photograph of the sheet, cut at its edges, as (canvas.height_px, canvas.width_px, 3) sRGB in [0, 1].

    Raises InputError where it cannot be read, or its aspect ratio differs from the sheet's by more than 2 %.
    """
    picture = read_picture(path, longest_px=LONGEST_KEPT_PX)
    height, width = picture.shape[:2]
    stretch = (width / height) / (canvas.width / canvas.height)
    if max(stretch, 1 / stretch) > 1 + _STRETCH:
        raise InputError(
            f"the photograph {path} is {width / height:.3f} times as wide as high, and the sheet, "
            f"{1e3 * canvas.width:g} x {1e3 * canvas.height:g} mm, {canvas.width / canvas.height:.3f} times; "
            "cut the photograph at the sheet's edges"
        )
    return spread(picture, canvas)


def spread(picture: Pixels, canvas: Canvas) -> Pixels:
    """Return the picture (H, W, 3) stretched over the whole canvas, (canvas.height_px, canvas.width_px, 3)."""
    height, width = picture.shape[:2]
    return scaled(picture, (canvas.width_px, canvas.height_px), (0, 0, width, height))


def _reason(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


def _decode(image: Image.Image, longest_px: int, shortest_px: int = 0) -> Pixels:
    if isinstance(image, TiffImageFile):
        _refuse_misread(image)
    width, height = _at_most(image.size, longest_px, shortest_px)
    image.draft(None, (2 * width, 2 * height))  # a JPEG is decoded at half, a quarter or an eighth of its size
    image.load()
    turn = _UPRIGHT.get(_orientation(image))
    deep = _is_deep(image)
    image = _deep_grey(image) if deep else _eight_bit(image)
    size = _at_most(image.size, longest_px, shortest_px)
    if image.size != size:
        image = image.resize(size, _LANCZOS, reducing_gap=3.0)
    if not deep:
        image = _srgb(image)
    if turn is not None:
        image = image.transpose(turn)
    pixels = np.array(image, dtype=np.float32)
    if deep:
        return np.repeat(pixels.clip(0, 1)[..., None], 3, axis=2)
    pixels /= 255
    return pixels


def _at_most(size: tuple[int, int], longest_px: int, shortest_px: int) -> tuple[int, int]:
    scale = min(1.0, max(longest_px / max(size), shortest_px / min(size)))
    return max(1, round(size[0] * scale)), max(1, round(size[1] * scale))


def _orientation(image: Image.Image) -> int:
    try:
        return int(image.getexif().get(_ORIENTATION, 1))
    except Exception:  # damaged metadata do not make a picture unreadable
        return 1


def _is_deep(image: Image.Image) -> bool:
    return image.mode in ("I", "F") or image.mode.startswith("I;16")


def _refuse_misread(image: TiffImageFile) -> None:
    """Raise ValueError for TIFFs that Pillow 13 misreads without an error."""
    tags = image.tag_v2
    if tags.get(_PLANES) == 2 and (image.mode == "LA" or max(tags.get(_BITS, (1,))) > 8):
        raise ValueError("a TIFF with 16 bits or transparency must not keep its channels apart (planar)")
    if tags.get(_PHOTOMETRIC) == 0 and _is_deep(image):
        raise ValueError("a TIFF with 16 bits must not count from white to black")


def _deep_grey(image: Image.Image) -> Image.Image:
    """Return a channel of more than 8 bits as floats in [0, 1]."""
    values = np.array(image, dtype=np.float32)
    if image.mode != "F":
        values /= 65535
    if not (values.min() >= 0 and values.max() <= 1):
        raise ValueError("its grey values are not 16-bit numbers, nor fractions of 1")
    return Image.fromarray(values)


def _eight_bit(image: Image.Image) -> Image.Image:
    """Return the image in a mode that can be scaled: RGB, L or CMYK, or RGBA where anything is transparent."""
    if image.has_transparency_data:
        return image.convert("RGBA")
    return image if image.mode in ("RGB", "L", "CMYK") else image.convert("RGB")


def _srgb(image: Image.Image) -> Image.Image:
    """Return an 8-bit image on white paper, with its colour profile applied."""
    profile = image.info.get("icc_profile")
    if image.mode == "RGBA":
        paper = Image.new("RGB", image.size, "white")
        paper.paste(image, mask=image)
        image = paper
    if profile:
        srgb: Any = ImageCms.createProfile("sRGB")
        with suppress(ImageCms.PyCMSError, OSError):  # a profile that does not fit its picture
            return ImageCms.profileToProfile(image, io.BytesIO(profile), srgb, outputMode="RGB") or image
    return image.convert("RGB")


def scaled(picture: Pixels, size: tuple[int, int], box: tuple[float, float, float, float]) -> Pixels:
    """Return the `box` (left, upper, right, lower) of the picture (H, W, 3), scaled to `size` (width, height)."""
    channels = [Image.fromarray(np.ascontiguousarray(picture[..., i])) for i in range(picture.shape[2])]
    return np.stack([np.asarray(channel.resize(size, _LANCZOS, box=box)) for channel in channels], axis=2).clip(0, 1)
