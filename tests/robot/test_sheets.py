from collections.abc import Callable
from typing import NoReturn

import numpy as np
import pytest
import torch
from numpy.testing import assert_allclose

from maulstick.errors import InputError
from maulstick.painting.brush import Brush
from maulstick.painting.raster import Canvas
from maulstick.rendering.kernels.reference import composite
from maulstick.rendering.traj2stroke import Traj2Stroke
from maulstick.robot.simulated import sheets
from maulstick.robot.simulated.sheets import InkedSheet, ModelSheet, MyPaintSheet, sheet_for
from maulstick.storage.arrays import Image
from tests.support.nominal import nominal
from tests.support.robot.small_paintings import BLUE, RED

CANVAS = Canvas(0.03, 0.02, 5000)
ROW = np.array([[0.006, 0.01, 0.5], [0.024, 0.01, 0.5]])


HARD = Brush(name="hard", source="a test", alpha=1e-3, beta=0.5e-3, plateau=0.98, depth=(0, 8e-3))


def modelled() -> InkedSheet:
    return ModelSheet(CANVAS, HARD)


def mypaint() -> InkedSheet:
    try:
        return MyPaintSheet(CANVAS, "marker", 1.2e-3, 2e-3)
    except InputError as error:
        pytest.skip(str(error))


both = pytest.mark.parametrize("sheet", [modelled, mypaint])


def height_of_mark(image: Image, x: float) -> float:
    """Return the metres of a column that are darker than half."""
    column = image[:, round(x * CANVAS.pixels_per_metre)].min(axis=1)
    return float((column < 0.5).sum() / CANVAS.pixels_per_metre)


@both
def test_a_sheet_is_white_until_it_is_drawn_on(sheet: Callable[[], InkedSheet]) -> None:
    paper = sheet()
    assert paper.image().shape == (100, 150, 3)
    assert np.all(paper.image() == 1)
    paper.draw(ROW, RED)
    assert paper.image().min() < 0.5


@both
def test_a_sheet_of_another_colour_may_be_laid_and_drawn_on(sheet: Callable[[], InkedSheet]) -> None:
    paper = sheet()
    paper.draw(ROW, RED)
    dark = np.full_like(paper.image(), 0.25)
    paper.lay(dark)
    assert np.array_equal(paper.image(), dark)
    paper.draw(ROW, (1.0, 1.0, 1.0))
    assert paper.image()[50, 75] == pytest.approx([1.0] * 3, abs=0.1)
    assert np.array_equal(paper.image()[:20], dark[:20])


@both
def test_a_mark_lies_where_it_was_drawn_in_its_colour(sheet: Callable[[], InkedSheet]) -> None:
    paper = sheet()
    paper.draw(ROW, BLUE)
    image = paper.image()
    assert image[50, 75] == pytest.approx(BLUE, abs=0.1)
    assert np.all(image[:20] == 1)
    assert np.all(image[80:] == 1)
    rows, _ = np.nonzero(image[..., 0] < 0.5)
    assert rows.mean() + 0.5 == pytest.approx(50, abs=1)


@both
def test_pressing_harder_makes_the_mark_wider(sheet: Callable[[], InkedSheet]) -> None:
    paper = sheet()
    paper.draw(np.linspace([0.004, 0.01, 0.1], [0.026, 0.01, 1.0], 20), (0, 0, 0))
    assert height_of_mark(paper.image(), 0.008) < 0.7 * height_of_mark(paper.image(), 0.022)


@both
def test_what_is_drawn_off_the_sheet_leaves_nothing(sheet: Callable[[], InkedSheet]) -> None:
    paper = sheet()
    paper.draw(ROW + np.array([0.1, 0, 0]), RED)
    assert np.all(paper.image() == 1)


def test_a_point_is_a_dot() -> None:
    paper = modelled()
    paper.draw(np.array([[0.015, 0.01, 0.5]]), (0, 0, 0))
    paper.draw(np.array([[0.015, 0.01, 0.5]] * 3), (0, 0, 0))
    assert 0 < height_of_mark(paper.image(), 0.015) < 0.004


def test_a_modelled_mark_is_as_wide_as_its_brush() -> None:
    paper = modelled()
    paper.draw(ROW, (0, 0, 0))
    assert height_of_mark(paper.image(), 0.015) == pytest.approx(2e-3, abs=2 / CANVAS.pixels_per_metre)


def test_an_image_that_was_taken_is_not_drawn_on_later() -> None:
    paper = modelled()
    before = paper.image()
    paper.draw(ROW, RED)
    assert np.all(before == 1)


def test_where_libmypaint_is_missing_the_brush_model_draws_what_the_planner_sees(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def missing(_: Canvas) -> NoReturn:
        raise InputError("libmypaint is not installed")

    monkeypatch.setattr(sheets, "MyPaintPaper", missing)
    brush = nominal("round").model_copy(update={"nib": (0.2, 0.1), "faint": 0.5, "opacity": 0.8, "lag": 1e-3})
    paper = sheet_for([brush], CANVAS)
    assert isinstance(paper, ModelSheet)
    bent = np.array([[0.006, 0.01, 0.1], [0.015, 0.012, 0.3], [0.024, 0.005, 0.2]])
    paper.draw(bent, RED)
    marks = Traj2Stroke.of([brush]).marks(torch.tensor(bent[None], dtype=torch.float32), CANVAS.pixels_per_metre)
    numbers = marks.falloff, marks.plateau, marks.opacity
    expected = composite(torch.ones(3, 100, 150), marks.points, marks.thickness, torch.tensor([RED]), *numbers)
    assert_allclose(paper.image(), expected.permute(1, 2, 0).numpy(), atol=2e-5, rtol=0)


def test_tools_are_changed_on_one_sheet() -> None:
    fine, broad = nominal("fineliner"), nominal("marker")
    paper = sheet_for([fine, broad], CANVAS)
    inks = []
    for brush in (fine, broad):
        before = paper.image()
        paper.take(brush)
        paper.draw(ROW, (0, 0, 0))
        inks.append(np.abs(paper.image() - before).sum())
    assert inks[1] > 2 * inks[0] > 0
    assert paper.deepest >= paper.depth


@pytest.mark.parametrize("brush", ["fineliner", "marker", "round"])
def test_every_brush_has_a_sheet_that_takes_its_ink(brush: str) -> None:
    paper = sheet_for([nominal(brush)], CANVAS)
    paper.draw(ROW, (0, 0, 0))
    assert paper.image().min() < 0.6
    assert paper.depth > 0


def test_a_brush_that_nobody_knows_has_a_sheet_as_well() -> None:
    paper = sheet_for([nominal("marker").model_copy(update={"name": "twig"})], CANVAS)
    paper.draw(ROW, (0, 0, 0))
    assert paper.image().min() < 0.6
