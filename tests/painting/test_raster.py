import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.errors import InputError
from maulstick.painting.raster import Canvas, is_turned_by_picture, parse_length, parse_margin, parse_sheet, parse_size

ROUNDING = 1e-12  # of float64
METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 25.4e-3}
sides = st.floats(5, 100_000).map(lambda x: round(x, 3))


@given(sides, sides)
def test_a_size_in_millimetres_is_read_in_metres(width: float, height: float) -> None:
    for text in (f"{width:.3f}x{height:.3f}mm", f" {width:.3f} \N{MULTIPLICATION SIGN} {height:.3f} mm "):
        assert parse_size(text) == pytest.approx((width * 1e-3, height * 1e-3), rel=ROUNDING)


@given(st.floats(0, 1e6).map(lambda x: round(x, 3)), st.sampled_from(sorted(METRES)))
def test_a_length_has_one_of_four_units(number: float, unit: str) -> None:
    assert parse_length(f"{number:.3f}{unit}") == pytest.approx(number * METRES[unit], rel=ROUNDING)


@pytest.mark.parametrize(
    ("text", "size"),
    [
        ("200x160mm", (0.2, 0.16)),
        ("8x10in", (0.2032, 0.254)),
        ("1x1m", (1.0, 1.0)),
        ("A4", (0.21, 0.297)),
        ("a4-portrait", (0.21, 0.297)),
        ("a4-landscape", (0.297, 0.21)),
        ("letter", (0.2159, 0.2794)),
        ("5x5mm", (0.005, 0.005)),
        ("170 by 230 mm", (0.17, 0.23)),
        ("17x23CM-landscape", (0.23, 0.17)),
        ("200x160mm-portrait", (0.16, 0.2)),
        ("100x100m", (100.0, 100.0)),
    ],
)
def test_papers_and_sizes_are_width_and_height(text: str, size: tuple[float, float]) -> None:
    assert parse_size(text) == pytest.approx(size, rel=ROUNDING)


@pytest.mark.parametrize(
    "text",
    ["", "A4-sideways", "A4-auto", "A9", "200x160", "200mm", "-200x160mm", "nanxnanmm", "1e2x1e2mm"],
)
def test_what_is_no_size_is_repeated_beside_what_would_be(text: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_size(text)
    assert str(caught.value).startswith(f"{text!r} is not a size; write width x height and a unit, as in 200x160mm")
    assert "A4" in str(caught.value)


@pytest.mark.parametrize("text", ["4.9x100mm", "100x4.9mm", "0x0mm", "100001x100mm", "5x101m"])
def test_a_canvas_no_hand_could_paint_is_refused(text: str) -> None:
    with pytest.raises(InputError, match=r"a side of the canvas is [\d.e+]+ mm; it must be between 5 mm and 100 m"):
        parse_size(text)


@pytest.mark.parametrize("text", ["", "139", "mm", "-1mm", "inf mm", "1,5mm"])
def test_what_is_no_length_is_repeated_beside_what_would_be(text: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_length(text)
    assert str(caught.value) == f"{text!r} is not a length; write a number and a unit, as in 139mm, 13.9cm or 5.5in"


@given(st.floats(5e-3, 100), st.floats(5e-3, 100), st.integers(1, 4096))
def test_pixels_are_square_and_as_many_as_asked_for(width: float, height: float, height_px: int) -> None:
    canvas = Canvas.of_height((width, height), height_px)
    assert canvas.height_px == height_px
    assert canvas.width_px >= 1
    assert abs(canvas.width_px - width / height * height_px) <= 0.5 * (1 + ROUNDING) or canvas.width_px == 1
    assert math.isclose(canvas.pixels_per_metre * height, height_px)


def test_a_canvas_without_pixels_is_refused() -> None:
    with pytest.raises(InputError, match="the height in pixels is 0; it must be at least 1"):
        Canvas.of_height((0.2, 0.16), 0)


@given(sides, sides, st.integers(1, 5000), st.integers(1, 5000))
def test_a_sheet_is_turned_as_its_picture_where_that_is_asked_for_and_only_there(
    width: float, height: float, rows: int, columns: int
) -> None:
    size = f"{width:.3f}x{height:.3f}mm"
    said, turned = parse_size(size), parse_sheet(f"{size}-auto", (rows, columns, 3))
    assert parse_sheet(size, (rows, columns)) == parse_sheet(f"{size}-AUTO", None) == said
    assert sorted(turned) == sorted(said)
    assert (turned[0] - turned[1]) * (columns - rows) >= 0
    assert turned == said or rows != columns
    assert is_turned_by_picture(f"{size}-auto")
    assert not is_turned_by_picture(size)


@given(sides, sides, st.floats(0, 60))
def test_a_margin_leaves_5_mm_of_the_sheet_or_is_refused(width: float, height: float, margin: float) -> None:
    size, text = (width * 1e-3, height * 1e-3), f"{margin:.6f}mm"
    if min(width, height) - 2 * round(margin, 6) >= 5 + 1e-6 or float(text[:-2]) == 0:
        assert parse_margin(text, size) == pytest.approx(margin * 1e-3, abs=1e-9)
    elif min(width, height) - 2 * margin < 5 - 1e-6:
        with pytest.raises(InputError, match=r"margin is [\d.]+mm; it must be at most [\d.e-]+mm on a sheet of"):
            parse_margin(text, size)
