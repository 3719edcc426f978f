import re
import struct
import subprocess
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest
import tifffile
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from PIL import Image, ImageCms

from maulstick.errors import InputError
from maulstick.painting.picture import (
    canvas_photograph,
    decode_png,
    encode_png,
    read_picture,
    spread,
)
from maulstick.painting.raster import Canvas

EIGHT_BIT = 1 / 255  # one step of the usual picture
HALVES_DOWN, HALVES_ACROSS = (slice(2, 22), slice(26, 46)), (slice(2, 30), slice(34, 62))  # but for their edges
JPEG = 0.04  # what its compression may change on smooth pictures
EVERYTHING = (
    "L.png",
    "RGB.png",
    "RGB.bmp",
    "RGB.jpg",
    "RGB.tif",
    "RGB.webp",
    "RGB.ppm",
    "RGB.tga",
    "RGB.jp2",
    "RGB.gif",
    "L.jpg",
    "CMYK.jpg",
    "CMYK.tif",
    "YCbCr.jpg",
    "1.png",
    "P.png",
    "RGBA.png",
    "RGBA.webp",
    "LA.png",
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("pictures")


def ramp(height: int = 24, width: int = 36) -> NDArray[np.uint8]:
    """(H, W, 3) red grows to the right, green downwards, blue is half."""
    rows, columns = np.mgrid[0:height, 0:width]
    red, green = 255 * columns / max(width - 1, 1), 255 * rows / max(height - 1, 1)
    return np.stack([red, green, np.full_like(red, 128)], axis=2).astype(np.uint8)


def png(width: int, height: int, bits: int = 8, colour: int = 0, rows: bytes = b"") -> bytes:
    """A PNG made by hand: one that says more of its size than it has rows, or one of 16 bits."""

    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, colour, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + header + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


@pytest.mark.parametrize("name", EVERYTHING)
def test_every_mode_and_format_is_read_as_srgb(tmp_path: Path, name: str) -> None:
    mode, suffix = name.split(".")
    Image.fromarray(ramp()).convert(mode).save(tmp_path / name)
    picture = read_picture(tmp_path / name)
    with Image.open(tmp_path / name) as image:
        expected = np.asarray(image.convert("RGB"), dtype=np.float32) / 255
    assert picture.shape == (24, 36, 3)
    assert picture.dtype == np.float32
    assert picture == pytest.approx(expected, abs=1e-6)
    if mode == "RGB" and suffix != "gif":
        lossless = suffix in ("png", "bmp", "tif", "ppm", "tga")
        assert picture == pytest.approx(ramp() / 255, abs=1e-6 if lossless else 3 * JPEG)


def test_what_is_transparent_is_white_and_what_is_half_so_is_half(tmp_path: Path) -> None:
    Image.fromarray(np.array([[[255, 0, 0, 0], [255, 0, 0, 128], [255, 0, 0, 255]]], np.uint8)).save(tmp_path / "a.png")
    expected = [[[1, 1, 1], [1, 0.5, 0.5], [1, 0, 0]]]
    assert read_picture(tmp_path / "a.png") == pytest.approx(np.array(expected), abs=EIGHT_BIT)
    Image.fromarray(np.array([[[0, 0], [0, 128], [0, 255]]], np.uint8), "LA").save(tmp_path / "b.png")
    assert read_picture(tmp_path / "b.png")[0, :, 0] == pytest.approx([1, 0.5, 0], abs=EIGHT_BIT)
    palette = Image.fromarray(np.array([[0, 1]], np.uint8), "P")
    palette.putpalette([0, 0, 0, 0, 0, 255])
    for suffix in ("gif", "png"):
        palette.save(tmp_path / f"c.{suffix}", transparency=0)
        assert read_picture(tmp_path / f"c.{suffix}").tolist() == [[[1, 1, 1], [0, 0, 1]]]
    Image.fromarray(np.array([[[9, 9, 9], [0, 0, 0]]], np.uint8)).save(tmp_path / "d.png", transparency=(9, 9, 9))
    assert read_picture(tmp_path / "d.png").tolist() == [[[1, 1, 1], [0, 0, 0]]]


def test_a_transparent_edge_takes_no_colour_from_what_cannot_be_seen(tmp_path: Path) -> None:
    pixels = np.zeros((8, 8, 4), np.uint8)
    pixels[:, :4] = (0, 255, 0, 0)
    pixels[:, 4:] = (0, 0, 0, 255)
    Image.fromarray(pixels).save(tmp_path / "edge.png")
    small = read_picture(tmp_path / "edge.png", 4)
    assert np.ptp(small, axis=2).max() <= EIGHT_BIT


@pytest.mark.parametrize("name", ["grey.png", "grey.tif", "grey.pgm"])
def test_a_16_bit_grey_picture_keeps_its_16_bits(tmp_path: Path, name: str) -> None:
    grey = np.linspace(0, 65535, 48, dtype=np.uint16).reshape(6, 8)
    Image.fromarray(grey).save(tmp_path / name)
    picture = read_picture(tmp_path / name)
    assert picture == pytest.approx(np.repeat(grey[..., None] / 65535, 3, axis=2), abs=1e-6)
    assert read_picture(tmp_path / name, 4).shape == (3, 4, 3)


def test_a_16_bit_colour_picture_is_read_to_8_bits(tmp_path: Path) -> None:
    deep = ramp().astype(np.uint16) * 257
    rows = b"".join(b"\0" + row.astype(">u2").tobytes() for row in deep)
    (tmp_path / "deep.png").write_bytes(png(36, 24, bits=16, colour=2, rows=rows))
    tifffile.imwrite(tmp_path / "deep.tif", deep, photometric="rgb")
    for name in ("deep.png", "deep.tif"):
        assert read_picture(tmp_path / name) == pytest.approx(ramp() / 255, abs=EIGHT_BIT)


def test_a_float_tiff_is_read_only_where_it_says_fractions(tmp_path: Path) -> None:
    Image.fromarray(np.array([[0.0, 0.25, 1.0]], np.float32)).save(tmp_path / "fractions.tif")
    assert read_picture(tmp_path / "fractions.tif")[0, :, 0].tolist() == [0, 0.25, 1]
    for wrong in (300.0, -1.0, float("nan")):
        Image.fromarray(np.array([[0.0, wrong]], np.float32)).save(tmp_path / "wrong.tif")
        with pytest.raises(InputError, match="its grey values are not 16-bit numbers, nor fractions of 1"):
            read_picture(tmp_path / "wrong.tif")


def test_a_tiff_that_would_be_misread_is_refused(tmp_path: Path) -> None:
    deep = np.zeros((3, 4, 5), np.uint16)
    tifffile.imwrite(tmp_path / "planar.tif", deep, photometric="rgb", planarconfig="separate")
    with pytest.raises(InputError, match="a TIFF with 16 bits or transparency must not keep its channels apart"):
        read_picture(tmp_path / "planar.tif")
    tifffile.imwrite(tmp_path / "negative.tif", deep[0], photometric="miniswhite")
    with pytest.raises(InputError, match="a TIFF with 16 bits must not count from white to black"):
        read_picture(tmp_path / "negative.tif")


@pytest.mark.parametrize("suffix", ["jpg", "png", "tif", "webp"])
@pytest.mark.parametrize("orientation", range(1, 9))
def test_a_photograph_is_upright_however_the_camera_was_held(tmp_path: Path, suffix: str, orientation: int) -> None:
    upright = ramp(48, 72)
    stored = {  # EXIF 3.0, 4.6.5.1: which side of the scene row 0 and column 0 are
        1: upright,
        2: upright[:, ::-1],
        3: upright[::-1, ::-1],
        4: upright[::-1],
        5: upright.swapaxes(0, 1),
        6: upright.swapaxes(0, 1)[::-1],
        7: upright[::-1, ::-1].swapaxes(0, 1),
        8: upright.swapaxes(0, 1)[:, ::-1],
    }[orientation]
    exif = Image.Exif()
    exif[274] = orientation
    path = tmp_path / f"turned.{suffix}"
    Image.fromarray(np.ascontiguousarray(stored)).save(path, exif=exif)
    assert read_picture(path) == pytest.approx(upright / 255, abs=3 * JPEG)
    assert read_picture(path, 36).shape == (24, 36, 3)


def test_a_colour_profile_is_applied_where_it_is_one(tmp_path: Path) -> None:
    srgb = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    swapped = srgb.replace(b"rXYZ", b"____").replace(b"gXYZ", b"rXYZ").replace(b"____", b"gXYZ")
    image = Image.fromarray(ramp())
    for name, profile, expected in (
        ("same", srgb, ramp()),
        ("swapped", swapped, ramp()[..., [1, 0, 2]]),
        ("broken", b"no profile at all", ramp()),
    ):
        image.save(tmp_path / f"{name}.png", icc_profile=profile)
        assert read_picture(tmp_path / f"{name}.png") == pytest.approx(expected / 255, abs=2 * EIGHT_BIT), name


def test_a_photograph_of_a_telephone_is_read() -> None:
    picture = read_picture(Path(__file__).parent / "pictures" / "telephone.heic")
    assert picture.shape == (48, 64, 3)
    quarters = [picture[rows, columns].mean(axis=(0, 1)) for rows in HALVES_DOWN for columns in HALVES_ACROSS]
    asked = np.array([(220, 30, 30), (30, 200, 30), (30, 30, 220), (250, 250, 250)]) / 255
    assert np.abs(np.array(quarters) - asked).max() < JPEG


def test_a_damaged_photograph_of_a_telephone_is_told(tmp_path: Path) -> None:
    whole = (Path(__file__).parent / "pictures" / "telephone.heic").read_bytes()
    for length in (12, 200, len(whole) - 100):
        (tmp_path / "cut.heic").write_bytes(whole[:length])
        with pytest.raises(InputError, match=r"cut\.heic"):
            read_picture(tmp_path / "cut.heic")


def test_one_pixel_is_a_picture(tmp_path: Path) -> None:
    Image.new("RGB", (1, 1), (255, 0, 51)).save(tmp_path / "one.png")
    assert read_picture(tmp_path / "one.png", 1) == pytest.approx(np.array([[[1, 0, 0.2]]]))


def test_the_first_picture_of_a_video_is_read(tmp_path: Path) -> None:
    frames = [Image.new("RGB", (4, 3), colour) for colour in ("red", "blue")]
    for suffix in ("gif", "tif", "webp"):
        path = tmp_path / f"video.{suffix}"
        frames[0].save(path, save_all=True, append_images=frames[1:])
        assert read_picture(path).reshape(-1, 3).mean(axis=0) == pytest.approx([1, 0, 0], abs=JPEG)


@given(st.integers(1, 60), st.integers(1, 60), st.integers(1, 80), st.sampled_from(["png", "jpg"]))
def test_no_side_is_longer_than_asked_and_nothing_is_enlarged(
    folder: Path, width: int, height: int, longest: int, suffix: str
) -> None:
    path = folder / f"picture.{suffix}"
    Image.new("RGB", (width, height), "white").save(path)
    rows, columns, _ = read_picture(path, longest).shape
    scale = min(1, longest / max(width, height))
    assert max(rows, columns) == min(longest, max(width, height))
    assert min(rows, columns) >= 1
    assert abs(rows - height * scale) <= 1
    assert abs(columns - width * scale) <= 1


def test_scaling_down_averages_what_it_leaves_out(tmp_path: Path) -> None:
    Image.fromarray(ramp(400, 600)).save(tmp_path / "large.jpg", quality=95)
    assert read_picture(tmp_path / "large.jpg", 60) == pytest.approx(ramp(40, 60) / 255, abs=JPEG)


def test_a_40_megapixel_photograph_takes_little_memory(tmp_path: Path) -> None:
    Image.new("RGB", (7680, 5210), (200, 100, 50)).save(tmp_path / "large.jpg")
    program = (
        "import re, sys; from maulstick.painting.picture import read_picture\n"
        "peak = lambda: int(re.search(r'VmHWM:\\s+(\\d+)', open('/proc/self/status').read())[1]) / 1024\n"
        "before = peak(); picture = read_picture(sys.argv[1], 768); print(*picture.shape, peak() - before)"
    )
    run = subprocess.run(
        [sys.executable, "-c", program, tmp_path / "large.jpg"], capture_output=True, text=True, check=True
    )
    height, width, channels, mebibytes = map(float, run.stdout.split())
    assert (height, width, channels) == (521, 768, 3)
    assert mebibytes < 60


@pytest.mark.parametrize("size", [(10_001, 10_000), (15_000, 10_000), (30_000, 30_000)])
def test_more_than_100_megapixels_are_refused_before_they_are_read(tmp_path: Path, size: tuple[int, int]) -> None:
    (tmp_path / "bomb.png").write_bytes(png(*size))
    with pytest.raises(InputError) as caught:
        read_picture(tmp_path / "bomb.png", 64)
    assert str(caught.value) == f"the picture {tmp_path / 'bomb.png'} has more than 100 megapixels; scale it down first"


def test_100_megapixels_are_not_refused_for_their_size(tmp_path: Path) -> None:
    (tmp_path / "whole.png").write_bytes(png(10_000, 10_000))
    with pytest.raises(InputError, match=r"cannot read the picture .*truncated"):  # it has no pixels
        read_picture(tmp_path / "whole.png", 64)


@pytest.mark.parametrize("suffix", ["jpg", "png", "tif", "webp", "gif", "bmp", "ppm", "jp2"])
def test_a_truncated_picture_is_refused_in_one_line(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"picture.{suffix}"
    noise = np.random.default_rng(0).integers(0, 256, (64, 64, 3), dtype=np.uint8)
    Image.fromarray(noise).save(path)
    whole = path.read_bytes()
    for share in (0.1, 0.5, 0.9):
        path.write_bytes(whole[: int(share * len(whole))])
        for longest in (None, 8):
            with pytest.raises(InputError) as caught:
                read_picture(path, longest)
            assert re.search(
                rf"(cannot read the picture {path}: \S|{path} is not a picture that can be read)", str(caught.value)
            )
            assert "\n" not in str(caught.value)


def test_a_damaged_picture_is_read_or_refused_but_nothing_else(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    refused = 0
    for suffix in ("jpg", "png", "tif", "webp", "gif"):
        path = tmp_path / f"picture.{suffix}"
        exif = Image.Exif()
        exif[274] = 6
        Image.fromarray(ramp()).save(path, exif=exif)
        whole = np.frombuffer(path.read_bytes(), np.uint8)
        for _ in range(60):
            damaged = whole.copy()
            damaged[rng.integers(0, len(whole), 4)] = rng.integers(0, 256, 4)
            path.write_bytes(damaged.tobytes())
            try:
                picture = read_picture(path, 64)
            except InputError:
                refused += 1
            else:
                assert max(picture.shape[:2]) <= 64
                assert 0 <= picture.min() <= picture.max() <= 1
    assert refused > 0


@pytest.mark.parametrize(
    "content", [b"hello", b"%PDF-1.7", b"<svg/>", b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n"]
)
def test_a_file_that_is_no_photograph_is_refused_with_those_that_are(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "photo.jpg").write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_picture(tmp_path / "photo.jpg")
    assert str(caught.value).startswith(
        f"{tmp_path / 'photo.jpg'} is not a picture that can be read; save it as one of JPEG, PNG"
    )


def test_a_picture_that_is_missing_empty_or_a_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "empty.png").touch()
    with pytest.raises(InputError, match=r"there is no picture .*none\.png; check its name and folder"):
        read_picture(tmp_path / "none.png")
    with pytest.raises(InputError, match=r"the picture .*empty\.png is empty; make or copy it again"):
        read_picture(tmp_path / "empty.png")
    with pytest.raises(InputError, match="is a folder; name the picture itself"):
        read_picture(tmp_path)


def test_a_picture_of_no_pixels_cannot_be_asked_for(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="the longest side in pixels is 0; it must be at least 1"):
        read_picture(tmp_path / "any.png", 0)


SHEET = Canvas.of_height((0.2, 0.16), 160)  # a pixel is a millimetre


@pytest.mark.parametrize("shape", [(1, 1), (3, 7), (40, 20)])
def test_a_picture_kept_in_a_file_is_known_to_a_step_of_its_8_bits(shape: tuple[int, int]) -> None:
    picture = np.random.default_rng(0).random((*shape, 3), dtype=np.float32)
    again = decode_png(encode_png(picture))
    assert (again.shape, again.dtype) == (picture.shape, np.float32)
    assert again == pytest.approx(picture, abs=0.5001 * EIGHT_BIT)
    assert np.array_equal(decode_png(encode_png(again)), again)


def test_a_kept_picture_is_read_with_the_care_of_any_other(tmp_path: Path) -> None:
    pixels = np.array([[[255, 0, 0, 0], [255, 0, 0, 255]]], np.uint8)
    exif = Image.Exif()
    exif[274] = 6
    Image.fromarray(pixels).save(tmp_path / "a.png", exif=exif)
    assert decode_png((tmp_path / "a.png").read_bytes()).tolist() == [[[1, 1, 1]], [[1, 0, 0]]]


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (b"", "the picture is not a PNG; save it as one"),
        (b"BM" + bytes(60), "the picture is not a PNG; save it as one"),
        (png(4096, 4096), "the picture is a damaged PNG: image file is truncated"),
        (png(1, 4097), "the picture is 1 x 4097 pixels; it must be at most 4096 on a side"),
        (png(10_000, 10_000), "the picture is 10000 x 10000 pixels; it must be at most 4096 on a side"),
        (png(2**31 - 1, 2**31 - 1), "the picture has more than 4096 pixels on a side; scale it down first"),
    ],
)
def test_what_cannot_be_kept_in_a_file_is_refused(content: bytes, text: str) -> None:
    with pytest.raises(InputError) as caught:
        decode_png(content)
    assert str(caught.value).startswith(text)
    assert "\n" not in str(caught.value)


def test_a_damaged_png_is_decoded_or_refused_but_nothing_else() -> None:
    rng = np.random.default_rng(2)
    whole = np.frombuffer(encode_png(ramp().astype(np.float32) / 255), np.uint8)
    refused = 0
    for _ in range(100):
        damaged = whole.copy()
        damaged[rng.integers(0, len(whole), 3)] = rng.integers(0, 256, 3)
        try:
            assert max(decode_png(damaged.tobytes()).shape) <= 4096
        except InputError:
            refused += 1
    assert refused > 0


def test_a_picture_is_spread_over_a_canvas_of_any_shape() -> None:
    picture = ramp(24, 36).astype(np.float32) / 255
    over = spread(picture, SHEET)
    assert over.shape == (160, 200, 3)
    assert over == pytest.approx(ramp(160, 200) / 255, abs=0.03)
    assert np.array_equal(spread(over, SHEET), over)


@pytest.mark.parametrize("size", [(100, 80), (1000, 800), (50, 40), (101, 80)])
def test_a_photograph_of_the_sheet_has_the_pixels_of_the_canvas(tmp_path: Path, size: tuple[int, int]) -> None:
    Image.fromarray(ramp(size[1], size[0])).save(tmp_path / "sheet.png")
    found = canvas_photograph(tmp_path / "sheet.png", SHEET)
    assert (found.shape, found.dtype) == ((160, 200, 3), np.float32)
    assert found == pytest.approx(ramp(160, 200) / 255, abs=0.03)


@pytest.mark.parametrize(("size", "shape"), [((100, 100), "1.000"), ((103, 80), "1.288"), ((80, 100), "0.800")])
def test_a_photograph_of_another_shape_is_refused_with_both(tmp_path: Path, size: tuple[int, int], shape: str) -> None:
    path = tmp_path / "sheet.png"
    Image.new("RGB", size).save(path)
    with pytest.raises(InputError) as caught:
        canvas_photograph(path, SHEET)
    assert str(caught.value) == (
        f"the photograph {path} is {shape} times as wide as high, and the sheet, 200 x 160 mm, 1.250 times; "
        "cut the photograph at the sheet's edges"
    )
