import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.errors import InputError
from maulstick.painting.fit import FITS, lay_out
from maulstick.painting.raster import Canvas

SHEET = Canvas.of_height((0.2, 0.16), 160)  # a pixel is a millimetre


@pytest.mark.parametrize(
    ("width", "height", "area"),
    [
        (40, 32, (0, 0, 0.2, 0.16)),
        (80, 32, (0, 0.04, 0.2, 0.08)),
        (16, 32, (0.06, 0, 0.08, 0.16)),
        (400, 320, (0, 0, 0.2, 0.16)),
    ],
)
def test_contain_puts_the_whole_picture_in_the_middle_of_white_paper(
    width: int, height: int, area: tuple[float, float, float, float]
) -> None:
    target, placed = lay_out(np.zeros((height, width, 3), np.float32), SHEET, "contain")
    assert target.shape == (160, 200, 3)
    assert target.dtype == np.float32
    assert placed == pytest.approx(area)
    left, top, across, down = (round(1000 * side) for side in placed)
    white = target.copy()
    white[top : top + down, left : left + across] = 1
    assert (white == 1).all()
    assert (target == 0).all(axis=2).sum() == across * down


def test_contain_leaves_around_the_picture_what_is_on_the_sheet() -> None:
    under = np.random.default_rng(0).random((160, 200, 3), dtype=np.float32)
    before = under.copy()
    black = np.zeros((32, 16, 3), np.float32)
    target, (x, _, wide, _) = lay_out(black, SHEET, "contain", under)
    left, right = round(1000 * x), round(1000 * (x + wide))
    assert np.array_equal(target[:, :left], under[:, :left])
    assert np.array_equal(target[:, right:], under[:, right:])
    assert (target[:, left:right] == 0).all()
    assert np.array_equal(under, before), "what came in was changed"


def test_cover_fills_the_sheet_and_cuts_both_sides_alike() -> None:
    wide = np.ones((32, 80, 3), np.float32)
    wide[:, 20:60] = 0  # what stays: 40 of 80 columns
    target, area = lay_out(wide, SHEET, "cover")
    assert area == (0, 0, 0.2, 0.16)
    assert target.shape == (160, 200, 3)
    assert target[:, 20:-20].max() < 1e-6  # but for what the filter sees beyond the cut
    assert target == pytest.approx(target[:, ::-1], abs=1e-6)


@pytest.mark.parametrize("fit", FITS)
def test_a_circle_stays_a_circle(fit: str) -> None:
    rows, columns = np.mgrid[0:200, 0:500]
    circle = ((rows - 99.5) ** 2 + (columns - 249.5) ** 2 < 60**2).astype(np.float32)
    target, _ = lay_out(np.repeat(circle[..., None], 3, axis=2), SHEET, fit)
    inside = target[..., 0] > 0.5
    if fit == "contain":
        inside[:40] = inside[120:] = False  # the paper
    down, across = np.ptp(np.nonzero(inside), axis=1) + 1
    assert abs(int(down) - int(across)) <= 1
    assert int(down) == pytest.approx(120 * (0.4 if fit == "contain" else 0.8), abs=2)


@given(
    st.integers(1, 300),
    st.integers(1, 300),
    st.floats(0.05, 0.5),
    st.floats(0.05, 0.5),
    st.integers(1, 200),
    st.sampled_from(FITS),
)
def test_the_area_lies_on_the_canvas_in_whole_pixels(
    width: int, height: int, across: float, down: float, height_px: int, fit: str
) -> None:
    canvas = Canvas.of_height((across, down), height_px)
    target, (x, y, wide, high) = lay_out(np.zeros((height, width, 3), np.float32), canvas, fit)
    assert target.shape == (canvas.height_px, canvas.width_px, 3)
    assert min(x, y) >= 0
    assert min(wide, high) > 0
    assert x + wide <= across * (1 + 1e-9)
    assert y + high <= down * (1 + 1e-9)
    pixels = canvas.pixels_per_metre
    assert (x * pixels, y * pixels) == pytest.approx((round(x * pixels), round(y * pixels)), abs=1e-6)
    inked = np.argwhere(target[..., 0] < 0.5)
    top, left = inked.min(axis=0)
    bottom, right = inked.max(axis=0) + 1
    assert (left, top) == (round(x * pixels), round(y * pixels))
    assert abs(right - (x + wide) * pixels) < 1  # the sheet ends within its last pixel
    assert abs(bottom - (y + high) * pixels) < 1


@pytest.mark.parametrize("fit", FITS)
@pytest.mark.parametrize("shape", [(1, 10_000), (10_000, 1), (1, 1)])
def test_the_thinnest_picture_is_still_painted(fit: str, shape: tuple[int, int]) -> None:
    target, (_, _, wide, high) = lay_out(np.zeros((*shape, 3), np.float32), SHEET, fit)
    assert (target == 0).all(axis=2).sum() == round(1e6 * wide * high)
    assert min(wide, high) >= 0.001 * (1 - 1e-9)


def test_an_unknown_fit_is_refused_with_those_there_are() -> None:
    with pytest.raises(InputError) as caught:
        lay_out(np.zeros((2, 2, 3), np.float32), SHEET, "stretch")
    assert str(caught.value) == "there is no fit 'stretch'; there are: contain, cover"


@given(
    st.integers(1, 300),
    st.integers(1, 300),
    st.floats(0.05, 0.5),
    st.floats(0.05, 0.5),
    st.integers(20, 200),
    st.floats(0.001, 0.02),
    st.sampled_from(FITS),
)
def test_a_margin_is_as_wide_at_all_edges_and_the_picture_lies_in_its_middle(
    width: int, height: int, across: float, down: float, height_px: int, margin: float, fit: str
) -> None:
    canvas = Canvas.of_height((across, down), height_px)
    pixel = 1 / canvas.pixels_per_metre
    target, (x, y, wide, high) = lay_out(np.zeros((height, width, 3), np.float32), canvas, fit, margin=margin)
    assert min(x, y) >= margin - 1e-9
    assert max(x + wide - across, y + high - down) <= -margin + 1e-9
    assert (2 * x + wide, 2 * y + high) == pytest.approx((across, down), abs=1e-9)
    if fit == "cover":
        assert (wide, high) == pytest.approx((across - 2 * margin, down - 2 * margin))
    inked = np.argwhere(target[..., 0] < 0.5)
    edges = (*inked.min(axis=0), *(inked.max(axis=0) + 1))
    assert edges == pytest.approx([each / pixel for each in (y, x, y + high, x + wide)], abs=1.5 + 1e-6)
