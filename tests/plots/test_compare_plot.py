"""Plot of paintings side by side: all at one scale, as large as fits."""

import io
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from maulstick.painting.raster import Canvas
from maulstick.plots.compare import Panel, compare_plot

COLOURS = [(255, 0, 0), (0, 0, 255), (0, 255, 0), (255, 0, 255), (0, 255, 255), (255, 255, 0), (0, 0, 128)]


def a_panel(number: int, size: tuple[float, float] = (0.2, 0.16)) -> Panel:
    """Make a panel of one colour."""

    def draw(canvas: Canvas) -> NDArray[np.float32]:
        colour = np.divide(COLOURS[number], 255, dtype=np.float32)
        return np.full((canvas.height_px, canvas.width_px, 3), colour, dtype=np.float32)

    return Panel(f"plan {number}", "40 strokes", size, draw)


def pixels(panels: list[Panel], px: int = 600) -> NDArray[np.int64]:
    with Image.open(io.BytesIO(compare_plot(panels, "paintings", "told", "", px))) as image:
        return np.array(image.convert("RGB"), dtype=np.int64)


def box(plot: NDArray[np.int64], number: int) -> tuple[int, int, int, int]:
    """Find the left, top, right and bottom of a panel."""
    where = np.argwhere((np.abs(plot - COLOURS[number]) <= 2).all(axis=2))
    assert len(where)
    (top, left), (bottom, right) = where.min(axis=0), where.max(axis=0) + 1
    return int(left), int(top), int(right), int(bottom)


@pytest.mark.parametrize("count", [2, 3, 5, 7])
def test_panels_stand_in_rows_apart_from_one_another(count: int) -> None:
    plot = pixels([a_panel(i) for i in range(count)])
    assert plot.shape == (600, 960, 3)
    boxes = [box(plot, i) for i in range(count)]
    for (_, top, right, bottom), (left, next_top, _, _) in pairwise(boxes):
        assert right < left or bottom < next_top
        assert next_top >= top
    shapes = {(right - left, bottom - top) for left, top, right, bottom in boxes}
    assert np.ptp(np.array(list(shapes)), axis=0).max() <= 1
    assert min(min(left, top) for left, top, _, _ in boxes) > 10


def test_sheets_of_different_sizes_are_shown_at_one_scale() -> None:
    plot = pixels([a_panel(0, (0.2, 0.1)), a_panel(1, (0.05, 0.1)), a_panel(2, (0.1, 0.2))])
    across, down = zip(
        *[(right - left, bottom - top) for left, top, right, bottom in (box(plot, i) for i in range(3))], strict=True
    )
    assert across[0] / across[1] == pytest.approx(4, rel=0.04)
    assert down[2] / down[0] == pytest.approx(2, rel=0.04)
    assert across[0] / down[0] == pytest.approx(2, rel=0.04)


def test_few_panels_are_larger_than_many() -> None:
    def across(count: int) -> int:
        left, _, right, _ = box(pixels([a_panel(i) for i in range(count)]), 0)
        return right - left

    assert across(1) > across(2) > across(4)


def test_a_panel_is_drawn_with_the_pixels_that_it_takes() -> None:
    asked: list[Canvas] = []

    def draw(canvas: Canvas) -> NDArray[np.float32]:
        asked.append(canvas)
        return a_panel(0).draw(canvas)

    left, top, right, bottom = box(pixels([Panel("a", "", (0.2, 0.16), draw)]), 0)
    assert (asked[0].width_px, asked[0].height_px) == pytest.approx((right - left, bottom - top), abs=1)


@pytest.mark.parametrize("size", [(100.0, 0.005), (0.005, 100.0), (0.005, 0.005)])
def test_the_thinnest_sheet_has_its_place(size: tuple[float, float]) -> None:
    assert pixels([a_panel(0, size), a_panel(1)], 240).shape == (240, 384, 3)
    assert pixels([a_panel(0, size)] * 7, 240).shape == (240, 384, 3)


def test_the_same_panels_are_the_same_plot() -> None:
    panels = [a_panel(0), a_panel(1)]
    assert compare_plot(panels, "a", "b", "c", 300) == compare_plot(panels, "a", "b", "c", 300)
