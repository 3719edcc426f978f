from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.ndimage import map_coordinates

from maulstick.painting.brush import load_brush
from maulstick.painting.painting import Sheet
from maulstick.planning import lines
from maulstick.planning.layout import lay_out_for
from maulstick.planning.lines import line_drawing, lines_for, lines_on
from maulstick.storage.arrays import Floats, Image
from tests.support.nominal import nominal

PEN = 0.01
SIZE = 200
SIDES = st.integers(1, 40)


def disc(radius: float, dark: float = 0.2) -> Image:
    y, x = np.mgrid[:SIZE, :SIZE] - SIZE / 2 + 0.5
    grey = np.where(np.hypot(x, y) < radius, dark, 0.8)
    return np.repeat(grey[..., None], 3, axis=2).astype(np.float32)


def from_the_middle() -> Floats:
    y, x = np.mgrid[:SIZE, :SIZE] - SIZE / 2 + 0.5
    away: Floats = np.hypot(x, y)
    return away


def test_a_dark_disc_becomes_a_ring_along_its_edge_on_white() -> None:
    drawn, away = line_drawing(disc(60), PEN)[..., 0], from_the_middle()
    assert drawn[np.abs(away - 58) > 5].min() > 0.99
    along = [drawn[np.abs(away - 58) < 5][sector].min() for sector in _sectors(8, np.abs(away - 58) < 5)]
    assert max(along) < 0.3, "and the ring is closed"


def _sectors(count: int, ring: np.ndarray) -> list[np.ndarray]:
    y, x = np.argwhere(ring).T - SIZE / 2 + 0.5
    of = ((np.arctan2(y, x) / (2 * np.pi) + 0.5) * count).astype(int).clip(max=count - 1)
    return [of == sector for sector in range(count)]


@pytest.mark.parametrize("grey", [0.0, 0.4, 1.0])
def test_an_even_grey_has_no_lines(grey: float) -> None:
    drawn = line_drawing(np.full((60, 90, 3), grey, dtype=np.float32), PEN)
    assert drawn == pytest.approx(1.0, abs=0.05)


def test_slow_shading_has_no_lines_and_a_line_on_it_is_drawn() -> None:
    shaded = np.repeat(np.tile(np.linspace(0.3, 0.9, SIZE), (SIZE, 1))[..., None], 3, axis=2).astype(np.float32)
    assert line_drawing(shaded, PEN).min() > 0.9
    shaded[:, 99:101] -= 0.2
    drawn = line_drawing(shaded, PEN)[..., 0]
    assert (drawn[20:-20, 98:102].min(axis=1) < 0.2).all()
    assert drawn[:, :90].min() > 0.8
    assert drawn[:, 110:].min() > 0.8


def test_a_broken_line_is_joined() -> None:
    picture = np.ones((SIZE, SIZE, 3), dtype=np.float32)
    picture[99:101, 20:180] = 0
    picture[99:101, 99] = 1
    assert (line_drawing(picture, PEN)[98:102, 30:170, 0].min(axis=0) < 0.5).all()


def test_lines_are_as_wide_as_the_pen() -> None:
    wide = [(line_drawing(disc(60), pen)[SIZE // 2, :, 0] < 0.5).sum() / 2 for pen in (0.01, 0.05, 0.1)]
    assert wide == pytest.approx([1, 9, 19], abs=2)


def test_a_pen_on_a_small_sheet_makes_wide_lines() -> None:
    pen = nominal("fineliner")
    large, small = (
        lines_for(disc(60), Sheet(width=side, height=side), pen, "contain") for side in (1.0, 10 * pen.widest)
    )
    assert (small < 0.5).mean() > 4 * (large < 0.5).mean()


def test_a_large_picture_is_drawn_at_a_thousand_pixels() -> None:
    large = np.ones((1500, 3000, 3), dtype=np.float32)
    large[700:720] = 0
    drawn = line_drawing(large, PEN)
    assert drawn.shape == (512, 1024, 3)
    assert drawn[230:255].min() < 0.2


@settings(max_examples=25, deadline=None)
@given(
    arrays(
        np.float32, st.tuples(st.integers(1, 40), st.integers(1, 40), st.just(3)), elements=st.floats(0, 1, width=32)
    )
)
def test_any_picture_has_lines_between_black_and_white(picture: Image) -> None:
    drawn = line_drawing(picture, PEN)
    assert drawn.dtype == np.float32
    assert drawn.min() >= 0
    assert drawn.max() <= 1


def test_lines_lie_on_the_sheet_where_its_picture_does_and_nowhere_else() -> None:
    layout = lay_out_for(disc(60), Sheet(width=0.2, height=0.1), load_brush("fineliner"), "contain", 100)
    dark = lines_on(layout, load_brush("fineliner"))
    assert dark.shape == layout.under.shape[:2]
    inside = layout.crop(dark)
    assert np.count_nonzero(inside) == np.count_nonzero(dark) > 0
    ring = np.hypot(*(np.mgrid[: inside.shape[0], : inside.shape[1]] - inside.shape[0] / 2 + 0.5))
    assert dark.max() > 0.3
    assert inside[np.abs(ring - 29) > 4].max() < 0.05, "a disc of 60 pixels of 200 is one of 30 of 100"
    assert not lines_on(replace(layout, target=None), load_brush("fineliner")).any()


def test_a_light_ink_draws_the_lines_that_are_lighter_than_around() -> None:
    pen, sheet = load_brush("fineliner"), Sheet(width=0.1, height=0.1)
    dark, light = (lay_out_for(each, sheet, pen, "contain", 100) for each in (disc(60), 1 - disc(60)))
    assert np.abs(lines_on(light, pen, light=True) - lines_on(dark, pen)).max() < 1e-3
    assert np.abs(lines_on(dark, pen, light=True) - lines_on(dark, pen)).max() > 0.3


def test_the_nearest_pixels_are_those_of_an_interpolation_of_order_0_beyond_the_edges_too() -> None:
    rng = np.random.default_rng(0)
    values = rng.normal(size=(2, 7, 5))
    row, column = rng.uniform(-3, 10, (30, 40)), rng.uniform(-3, 8, (30, 40))
    row[0], column[0] = np.arange(40) / 2 - 6, np.arange(40)[::-1] / 2 - 6  # half-way between pixels
    interpolated = [map_coordinates(each, np.stack([row, column]), order=0, mode="nearest") for each in values]
    np.testing.assert_array_equal(lines._nearest_to(values, row, column), interpolated)
