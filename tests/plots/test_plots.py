"""Plots are looked at by people; these tests see to their proportions, and that the ink is where it was drawn."""

import io
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from maulstick.painting.brush import load_brush
from maulstick.plots.brush import brush_plot
from maulstick.plots.ink import ink_plot
from maulstick.plots.strokes import strokes_plot
from maulstick.strokes.ink import Ink
from maulstick.strokes.strokes import Strokes
from tests.support.nominal import nominal

PX = 480
WACOM = Path(__file__).parents[3] / "shared" / "data" / "uil_strokes.npz"


def pixels(png: bytes) -> NDArray[np.float64]:
    with Image.open(io.BytesIO(png)) as image:
        assert image.height == PX
        return np.array(image.convert("RGB"), dtype=np.float64)


def paper(plot: NDArray[np.float64]) -> tuple[slice, slice]:
    """Find the white sheet."""
    rows, columns = np.nonzero((plot == 255).all(axis=2))
    return slice(rows.min(), rows.max() + 1), slice(columns.min(), columns.max() + 1)


def inked(plot: NDArray[np.float64]) -> NDArray[np.bool_]:
    return plot.max(axis=2) < 128


def a_line(*points: tuple[float, float], pressure: float | tuple[float, ...] = np.nan) -> NDArray[np.float64]:
    places = np.array(points)
    return np.column_stack([np.full(len(places), np.nan), places, np.full(len(places), pressure)])


@pytest.mark.parametrize("size", [(0.2, 0.15), (0.15, 0.2), (30.0, 20.0), (0.05, 0.02)])
def test_a_sheet_keeps_its_proportions(size: tuple[float, float]) -> None:
    sheet = paper(pixels(ink_plot(Ink.of([], size), "", PX)))
    high, wide = (part.stop - part.start for part in sheet)
    assert wide / high == pytest.approx(size[0] / size[1], abs=0.02)


def test_strokes_lie_where_they_were_drawn() -> None:
    ink = Ink.of([a_line((0.05, 0.03), (0.15, 0.03)), a_line((0.1, 0.12))], (0.2, 0.15))
    plot = pixels(ink_plot(ink, "", PX))
    rows, columns = paper(plot)
    drawn = np.argwhere(inked(plot[rows, columns]))
    scale = (columns.stop - columns.start) / 0.2
    line, dot = drawn[drawn[:, 0] < 0.075 * scale], drawn[drawn[:, 0] > 0.075 * scale]
    assert line[:, 0].mean() == pytest.approx(0.03 * scale, abs=1.5)
    assert line[:, 1].min() == pytest.approx(0.05 * scale, abs=4), "the start is under a red disc"
    assert line[:, 1].max() == pytest.approx(0.15 * scale, abs=2)
    assert dot.mean(axis=0) == pytest.approx([0.12 * scale, 0.1 * scale], abs=1.5)


def test_a_stroke_is_wider_where_it_was_pressed_harder() -> None:
    ink = Ink.of([a_line((0.002, 0.005), (0.018, 0.005), pressure=(0.0, 1.0))], (0.02, 0.01))
    plot = pixels(ink_plot(ink, "", PX))
    rows, columns = paper(plot)
    widths = inked(plot[rows, columns]).sum(axis=0)
    scale = (columns.stop - columns.start) / 0.02
    quarter, three_quarters = (widths[int(share * scale)] for share in (0.006, 0.014))
    assert quarter == pytest.approx((0.15e-3 + 0.25 * 1.05e-3) * scale, abs=1.5)
    assert three_quarters == pytest.approx((0.15e-3 + 0.75 * 1.05e-3) * scale, abs=1.5)


def test_what_runs_off_the_sheet_is_not_drawn_beside_it() -> None:
    empty = pixels(ink_plot(Ink.of([], (0.2, 0.15)), "", PX))
    plot = pixels(ink_plot(Ink.of([a_line((-1, 0.02), (1, 0.02))], (0.2, 0.15)), "", PX))
    _, columns = paper(empty)
    beside = np.r_[0 : columns.start - 2, columns.stop + 2 : plot.shape[1]]
    rows = slice(0, round(0.7 * PX))
    assert np.array_equal(plot[rows, beside], empty[rows, beside])
    assert inked(plot[rows, columns]).any()


def test_strokes_of_a_specimen_are_at_one_scale_and_the_longest_comes_first() -> None:
    lines = [a_line((0.01, 0.01), (0.01, 0.01 + length)) for length in (0.01, 0.04, 0.02)]
    plot = pixels(strokes_plot(Strokes.of(Ink.of(lines, (0.2, 0.2))), "", PX))
    rows, columns = paper(plot)
    dark = inked(plot[rows, columns])
    lengths = []
    for row in dark[np.flatnonzero(dark.any(axis=1))]:
        edges = np.flatnonzero(np.diff(np.concatenate([[False], row, [False]]).astype(int)))
        lengths.append((edges[1::2] - edges[::2]).tolist())
    longest = np.concatenate(lengths).max()
    found = next(row for row in lengths if max(row) == longest)
    assert longest > 100
    assert found[0] == longest or len(found) == 1


@pytest.mark.parametrize("number", [0, 1, 2, 241, 3000])
def test_any_number_of_strokes_has_a_specimen_and_a_sheet(number: int) -> None:
    rng = np.random.default_rng(0)
    strokes = [a_line(*(0.1 + 0.01 * rng.normal(size=(8, 2)))) for _ in range(number)]
    ink = Ink.of(strokes, (0.2, 0.2))
    for png in (ink_plot(ink, "many", PX), strokes_plot(Strokes.of(ink), "many", PX)):
        plot = pixels(png)
        assert inked(plot[paper(plot)]).any() == (number > 0)


def test_a_dot_and_a_point_without_extent_can_be_shown() -> None:
    for pressure in (np.nan, 0.7):
        ink = Ink.of(
            [a_line((0.1, 0.1), pressure=pressure), a_line((0.1, 0.1), (0.1, 0.1), pressure=pressure)], (0.2, 0.2)
        )
        for png in (ink_plot(ink, "", PX), strokes_plot(Strokes.of(ink), "", PX)):
            plot = pixels(png)
            assert inked(plot[paper(plot)]).any()


@pytest.mark.parametrize("size", [(100, 0.001), (0.001, 100), (30, 30), (1e-3, 1e-3)])
def test_sheets_of_any_size_can_be_shown(size: tuple[float, float]) -> None:
    ink = Ink.of([a_line((0, 0), size, pressure=0.5), a_line((0, size[1]), size)], size)
    plot = pixels(ink_plot(ink, "", PX))
    assert plot.shape[1] <= 3 * PX + 1


def test_a_name_is_shown_whatever_is_in_it() -> None:
    empty = Ink.of([], (0.1, 0.1))
    nameless = pixels(ink_plot(empty, "", PX))
    for title in ("$x_1$ \\frac", "漢字", "x" * 300, "a\nb"):
        assert not np.array_equal(pixels(ink_plot(empty, title, PX)), nameless)


@pytest.mark.parametrize("name", ["round", "marker", "fineliner"])
def test_the_mark_of_a_brush_becomes_wider_towards_the_right(name: str) -> None:
    brush = load_brush(name)
    plot = pixels(brush_plot(brush, f"{name}.json", PX))
    rows = slice(round(0.13 * PX), round(0.44 * PX))
    sheet = plot[rows]
    widths = (255 - sheet.mean(axis=2)).clip(min=0).sum(axis=0)
    left, right = (widths[round(share * plot.shape[1])] for share in (0.2, 0.8))
    assert right > left if brush.pressure_matters else right == pytest.approx(left, rel=0.05)
    assert left > 0


def test_a_brush_with_much_to_tell_has_a_plot() -> None:
    brush = nominal("round").model_copy(
        update={
            "name": "long " * 40,
            "source": "fitted to photographs " * 60,
            "beta": -0.001,
            "m_x": 1.05,
            "b_x": -3e-4,
        }
    )
    assert inked(pixels(brush_plot(brush, "x" * 200, PX))).any()


def test_the_same_ink_is_the_same_picture() -> None:
    ink = Ink.of([a_line((0.01, 0.01), (0.04, 0.03), pressure=(0.2, 0.9))], (0.05, 0.05))
    assert ink_plot(ink, "twice", PX) == ink_plot(ink, "twice", PX)


@pytest.mark.skipif(not WACOM.exists(), reason="shared data absent: uil_strokes.npz")
def test_a_drawing_by_hand_covers_a_few_hundredths_of_its_sheet() -> None:
    with np.load(WACOM, allow_pickle=False) as data:
        strokes = np.split(data["data"][:, :2], np.cumsum(data["lens"])[:-1])
        drawn = [stroke for stroke, name in zip(strokes, data["source"], strict=True) if name == "will/apple.will"]
    ink = Ink.of([a_line(*(stroke * 3e-4)) for stroke in drawn], (0.15, 0.15))
    plot = pixels(ink_plot(ink, "apple", PX))
    assert 0.005 < inked(plot[paper(plot)]).mean() < 0.1
