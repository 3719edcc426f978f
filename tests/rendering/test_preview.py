from collections.abc import Sequence

import numpy as np
import pytest
from torch import Tensor

from maulstick.painting import painting as paintings
from maulstick.painting.brush import Brush, load_brush
from maulstick.painting.fields import Point
from maulstick.painting.painting import Paint, Painting, Provenance, Sheet, Stroke
from maulstick.painting.picture import encode_png
from maulstick.painting.raster import Canvas
from maulstick.painting.refined import refined
from maulstick.rendering import preview as rendering
from maulstick.rendering.preview import coverage, growing, preview, truth
from tests.support.nominal import nominal
from tests.support.tolerances import BESIDE_A_POINT

CANVAS = Canvas(0.08, 0.06, 1000)
FLOAT32 = 1e-6
BRUSHES = {"wide": nominal("round"), "pen": nominal("fineliner").model_copy(update={"beta": 0.002})}
RED, BLUE = Paint(colour=(1, 0, 0), brush="wide"), Paint(colour=(0, 0, 1), brush="pen")


def across(y: float, pressure: float = 0.5) -> tuple[Point, ...]:
    return ((0.01, y, pressure), (0.04, y, pressure), (0.07, y, pressure))


def a_painting(
    strokes: Sequence[tuple[int, tuple[Point, ...]]],
    paper: tuple[float, float, float] = (1.0, 1.0, 1.0),
    brushes: dict[str, Brush] = BRUSHES,
    paints: tuple[Paint, ...] = (RED, BLUE),
) -> Painting:
    return Painting(
        sheet=Sheet(width=0.08, height=0.06, paper=paper),
        provenance=Provenance(version="1"),
        brushes=brushes,
        paints=paints,
        strokes=tuple(Stroke(id=i, paint=paint, trajectory=path) for i, (paint, path) in enumerate(strokes)),
    )


def test_an_image_has_the_pixels_of_the_canvas_the_paper_s_colour_and_each_stroke_s_paint() -> None:
    image = preview(a_painting([(0, across(0.0155)), (1, across(0.0455))], paper=(0.9, 0.8, 0.7)), CANVAS)
    assert (image.shape, image.dtype) == ((60, 80, 3), np.float32)
    assert image[2, 2] == pytest.approx([0.9, 0.8, 0.7], abs=FLOAT32)
    assert image[15, 40] == pytest.approx([1, 0, 0], abs=FLOAT32)
    assert image[45, 40] == pytest.approx([0, 0, 1], abs=FLOAT32)


def test_images_that_grow_are_the_previews_of_so_many_strokes() -> None:
    painting = a_painting([(i % 2, across(0.01 + 0.004 * i, 0.3 + 0.1 * i)) for i in range(6)])
    ends = [0, 2, 2, 5, 6]
    for end, image in zip(ends, growing(painting, CANVAS, ends), strict=True):
        np.testing.assert_allclose(image, preview(painting, CANVAS, end), atol=FLOAT32)


def test_each_paint_is_applied_by_its_own_brush() -> None:
    image = preview(a_painting([(0, across(0.015)), (1, across(0.045))]), CANVAS)
    coloured = (image.min(axis=2) < 0.5)[:, 40]
    assert coloured[:30].sum() in (5, 6, 7), "a round brush at half its pressure: 4 mm and half of its edge, each side"
    assert coloured[30:].sum() in (2, 3), "the pen"


def test_pressure_widens_the_mark_of_a_brush_and_not_of_a_pen() -> None:
    def inked(paint: int, pressure: float) -> float:
        return float((1 - preview(a_painting([(paint, across(0.03, pressure))]), CANVAS).min(axis=2)).sum())

    assert inked(0, 1.0) > 2 * inked(0, 0.0)
    assert inked(1, 1.0) == inked(1, 0.0)


def test_only_the_first_strokes_are_shown_on_request() -> None:
    painting = a_painting([(0, across(0.01)), (1, across(0.03)), (0, across(0.05))])
    for count in range(4):
        shorter = a_painting([(0, across(0.01)), (1, across(0.03)), (0, across(0.05))][:count])
        assert np.array_equal(preview(painting, CANVAS, count), preview(shorter, CANVAS))
    assert np.array_equal(preview(painting, CANVAS, 9), preview(painting, CANVAS))
    assert not np.array_equal(preview(painting, CANVAS, 2), preview(painting, CANVAS))


def test_a_painting_of_several_parts_looks_as_if_it_were_one(monkeypatch: pytest.MonkeyPatch) -> None:
    paths = [across(0.005 * (1 + i % 9), 0.3 + 0.02 * i) for i in range(30)]
    painting = a_painting([(i % 2, path) for i, path in enumerate(paths)])
    whole, covered = preview(painting, CANVAS), coverage(painting, CANVAS)
    monkeypatch.setattr(paintings, "_MOST_POINTS", 7)
    assert len(list(painting.parts())) == 15
    assert np.array_equal(preview(painting, CANVAS), whole)
    assert np.array_equal(coverage(painting, CANVAS), covered)


def test_one_long_stroke_is_rendered_apart_from_many_short_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    sizes: list[int] = []

    def sized(image: Tensor, points: Tensor, *others: object) -> Tensor:
        sizes.append(points.numel())
        return image

    long = tuple((0.01 + 1e-7 * i, 0.03, 0.5) for i in range(500_000))
    monkeypatch.setattr(rendering, "composite", sized)
    preview(a_painting([(0, across(0.01))] * 400 + [(1, long)] + [(0, across(0.02))] * 400), CANVAS)
    assert max(sizes) <= 2 * 2**20


def test_all_pictures_of_a_painting_show_its_strokes_refined() -> None:
    bow = ((0.01, 0.02, 0.5), (0.04, 0.045, 0.5), (0.07, 0.02, 0.5))
    painting = a_painting([(1, bow)], brushes=BRUSHES | {"pen": nominal("fineliner")})
    fine = Canvas(0.08, 0.06, 10_000)
    columns, rows = (np.array(refined(painting).strokes[0].trajectory)[1:-1, :2].T * 10_000).astype(int)
    assert len(rows) > 10
    for picture in (preview(painting, fine), truth(painting, fine)):
        assert picture[rows, columns, 0].max() < 0.5
    assert coverage(painting, fine)[rows, columns].min() > 0.5


@pytest.mark.parametrize("brush", ["marker", "nib"])
def test_strokes_look_the_same_beside_one_of_many_more_points(brush: str) -> None:
    brushes = {"marker": load_brush("marker"), "nib": nominal("round").model_copy(update={"nib": (0.4, 0.2)})}
    paints = (Paint(colour=(0, 0, 1), brush="pen"),)
    painting = a_painting(
        [
            (0, ((0.01, 0.012, 0.3), (0.07, 0.01, 0.1))),
            (0, ((0.02, 0.022, 0.4), (0.02, 0.022, 0.4))),
            (0, tuple((x, 0.05, 0.5) for x in np.linspace(0.01, 0.07, 50).tolist())),
        ],
        brushes={"pen": brushes[brush]},
        paints=paints,
    )
    alone = preview(painting, CANVAS, 2)[:35]
    assert np.abs(preview(painting, CANVAS)[:35] - alone).max() < BESIDE_A_POINT


def test_a_later_stroke_lies_on_top() -> None:
    crossing = ((0.04, 0.01, 0.5), (0.04, 0.05, 0.5))
    assert preview(a_painting([(0, across(0.03)), (1, crossing)]), CANVAS)[30, 40] == pytest.approx([0, 0, 1], abs=0.1)
    assert preview(a_painting([(1, crossing), (0, across(0.03))]), CANVAS)[30, 40] == pytest.approx([1, 0, 0], abs=0.1)


@pytest.mark.parametrize("strokes", [None, 0, 3])
def test_no_strokes_are_blank_paper(strokes: int | None) -> None:
    blank = np.broadcast_to(np.array([0.2, 0.4, 1.0], np.float32), (60, 80, 3))
    assert np.array_equal(preview(a_painting([], (0.2, 0.4, 1.0)), CANVAS, strokes), blank)
    assert np.array_equal(preview(a_painting([], (0.2, 0.4, 1.0), paints=()), CANVAS, strokes), blank)
    assert np.array_equal(preview(a_painting([(0, across(0.03))], (0.2, 0.4, 1.0)), CANVAS, 0), blank)


def test_marks_are_shown_and_not_commands() -> None:
    shifted = BRUSHES | {"wide": nominal("round").model_copy(update={"b_y": 0.01})}
    image = preview(a_painting([(0, across(0.02))], brushes=shifted), CANVAS)
    straight = preview(a_painting([(0, across(0.03))]), CANVAS)
    assert np.abs(image - straight).max() < 1e-4
    assert np.abs(image - preview(a_painting([(0, across(0.02))]), CANVAS)).max() > 0.5


def test_strokes_of_different_numbers_of_points_are_shown_as_each_would_be_alone() -> None:
    dot, long = ((0.02, 0.015, 1.0),), across(0.045)
    both = preview(a_painting([(0, dot), (1, long)]), CANVAS)
    assert np.array_equal(both[:30], preview(a_painting([(0, dot)]), CANVAS)[:30])
    assert np.array_equal(both[30:], preview(a_painting([(1, long)]), CANVAS)[30:])
    assert both[15, 20] == pytest.approx([1, 0, 0], abs=FLOAT32)


@pytest.mark.parametrize("pixels_per_metre", [500, 2000, 8000])
def test_a_painting_looks_alike_at_every_resolution(pixels_per_metre: float) -> None:
    painting = a_painting([(0, across(0.02)), (1, across(0.045, 0.0))])
    image = preview(painting, Canvas(0.08, 0.06, pixels_per_metre))
    assert image.shape == (0.06 * pixels_per_metre, 0.08 * pixels_per_metre, 3)
    reference = preview(painting, Canvas(0.08, 0.06, 4000))
    assert image.mean(axis=(0, 1)) == pytest.approx(reference.mean(axis=(0, 1)), rel=0.01)


def test_strokes_go_over_what_is_on_the_sheet() -> None:
    used = np.random.default_rng(0).integers(0, 256, (60, 80, 3)).astype(np.float32) / 255
    painting = a_painting([(0, across(0.0155))])
    sheet = Sheet(width=0.08, height=0.06, picture=encode_png(used))
    image = preview(painting.model_copy(update={"sheet": sheet}), CANVAS)
    assert np.array_equal(image[30:], used[30:])
    assert image[15, 40] == pytest.approx([1, 0, 0], abs=FLOAT32)


def test_coverage_is_of_the_sheet_whatever_the_colour_of_the_paint() -> None:
    white = (RED.model_copy(update={"colour": (1.0, 1.0, 1.0)}), BLUE)
    strokes = [(0, across(0.0155)), (1, across(0.0455))]
    covered = coverage(a_painting(strokes), CANVAS)
    assert (covered.shape, covered.dtype) == ((60, 80), np.float32)
    assert np.array_equal(covered, coverage(a_painting(strokes, paints=white), CANVAS))
    black = preview(a_painting(strokes, paints=(RED.model_copy(update={"colour": (0.0, 1.0, 1.0)}), BLUE)), CANVAS)
    assert covered == pytest.approx(1 - black[..., 0], abs=FLOAT32)
    assert coverage(a_painting([]), CANVAS).max() == 0


def test_paint_over_paint_covers_no_more() -> None:
    once, twice = (coverage(a_painting([(1, across(0.03))] * count), CANVAS).sum() for count in (1, 2))
    assert once < twice < 1.3 * once, "only its soft edge grows"
