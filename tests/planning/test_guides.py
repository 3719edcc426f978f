"""Guides: directions that lines and regions say, and the strokes that keep to them."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from maulstick.painting.brush import Brush
from maulstick.painting.raster import Canvas
from maulstick.planning.guides import Guides
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.placement import Places
from maulstick.planning.regions import Region, Regions
from maulstick.planning.stroke_canvas import StrokeCanvas
from maulstick.storage.arrays import Floats
from maulstick.storage.arrays import Image as Picture
from maulstick.style import load_style
from tests.planning.conftest import problem_for

CANVAS = Canvas(0.2, 0.1, 600)
FREE = load_style("free", CANVAS)
STRAIGHT = np.array([[0.02, 0.05], [0.18, 0.05]])
ACROSS = np.array([[0.1, 0.01], [0.1, 0.09]])


def angle_at(guides: Guides, x: float, y: float) -> tuple[float, float]:
    """Return the angle in radians from -pi/2 to pi/2, and how strict it is, at a place in metres."""
    said = guides.field[int(600 * y), int(600 * x)]
    return float(np.angle(said) / 2), float(abs(said))


def strokes(centres: Floats, angles: Floats) -> StrokeParameters:
    count = len(centres)
    return StrokeParameters(
        codes=torch.zeros(count, 64),
        centres=torch.from_numpy(centres).float(),
        angles=torch.from_numpy(angles).float(),
        pressure_knots=torch.zeros(count, 8),
        colours=torch.zeros(count, 3),
        brush_of=torch.zeros(count, dtype=torch.long),
    )


def test_directions_are_strict_along_a_line_and_fade_away_from_it() -> None:
    guides = Guides.of(CANVAS, [STRAIGHT])
    near, farther, far = (angle_at(guides, 0.1, y) for y in (0.051, 0.065, 0.095))
    assert near[0] == pytest.approx(0, abs=1e-6)
    assert near[1] > 0.98
    assert 0.1 < farther[1] < 0.9
    assert far[1] < 0.01


def test_a_line_says_the_same_both_ways_drawn() -> None:
    there, back = Guides.of(CANVAS, [ACROSS]), Guides.of(CANVAS, [ACROSS[::-1]])
    assert there.field == pytest.approx(back.field, abs=1e-9)


@given(turn=st.floats(-1.5, 1.5), wide=st.floats(0.001, 0.04))
def test_any_straight_line_gives_its_own_direction(turn: float, wide: float) -> None:
    along = wide * np.array([np.cos(turn), np.sin(turn)])
    guides = Guides.of(CANVAS, [np.array([0.1, 0.05]) + np.array([-along, along])])
    angle, strict = angle_at(guides, 0.1, 0.05)
    assert strict > 0.9
    assert np.cos(2 * (angle - turn)) > 0.999


@pytest.mark.parametrize("line", [np.array([[0.1, 0.05]]), np.array([[0.1, 0.05]] * 3), STRAIGHT + 5, STRAIGHT[:0]])
def test_a_dot_or_a_line_beside_the_sheet_says_nothing(line: Floats) -> None:
    assert np.abs(Guides.of(CANVAS, [line]).field).max() == 0


def test_a_region_of_an_angle_comes_before_lines_and_one_that_follows_guides_does_so_all_over() -> None:
    labels = np.zeros((60, 120), dtype=np.int64)
    labels[:, 40:80], labels[:, 80:] = 1, 2
    said = (
        Region("rest", FREE, (True,)),
        Region("coat", FREE, (True,), angle=0.7),
        Region("hair", FREE, (True,), follows_guides=True),
    )
    guides = Guides.of(CANVAS, [STRAIGHT], Regions(labels, said, CANVAS))
    assert angle_at(guides, 0.1, 0.05) == pytest.approx((0.7, 1.0))
    assert angle_at(guides, 0.17, 0.095) == pytest.approx((0.0, 1.0), abs=1e-6)
    assert angle_at(guides, 0.03, 0.095)[1] < 0.01


def test_strokes_are_turned_back_as_far_as_their_place_is_strict() -> None:
    guides = Guides.of(CANVAS, [STRAIGHT])
    kept = strokes(np.array([[0.1, 0.05], [0.1, 0.05], [0.1, 0.066], [0.1, 0.099]]), np.array([1.0, 0.1, 1.0, 1.0]))
    guides.keep(kept)
    strict, within, loose, free = kept.angles.tolist()
    assert strict == pytest.approx(np.pi / 18, rel=0.05)
    assert within == pytest.approx(0.1)
    assert np.pi / 18 < loose < 1
    assert free == pytest.approx(1)


def test_strokes_that_lie_the_other_way_round_are_turned_by_the_least() -> None:
    kept = strokes(np.array([[0.1, 0.05]]), np.array([np.pi - 0.5]))
    Guides.of(CANVAS, [STRAIGHT]).keep(kept)
    assert kept.angles.item() == pytest.approx(np.pi - np.pi / 18, rel=0.02)


def test_places_are_turned_where_directions_are_strict_and_stay_elsewhere() -> None:
    centres = 600 * np.array([[0.1, 0.05], [0.1, 0.099]])
    places = Places(centres, np.array([3.5, 3.5]), np.ones(2), np.zeros((2, 3)))
    turned = Guides.of(CANVAS, [STRAIGHT]).turned(places).angles
    assert turned == pytest.approx([np.pi, 3.5], abs=0.02)


def test_other_directions_stay_where_nothing_is_said() -> None:
    guides, own = Guides.of(CANVAS, [STRAIGHT]), np.full((60, 120), 0.5j)
    both = guides.over(own)
    assert both[30, 60] == pytest.approx(guides.field[30, 60], abs=0.02)
    assert both[59, 60] == pytest.approx(0.5j, abs=0.02)


def test_strokes_in_groups_are_turned_back_by_the_angle_of_a_region_alone() -> None:
    labels = np.zeros((60, 120), dtype=np.int64)
    labels[:, 60:] = 1
    regions = Regions(labels, (Region("rest", FREE, (True,)), Region("coat", FREE, (True,), angle=0.0)), CANVAS)
    kept = strokes(np.array([[0.05, 0.05], [0.15, 0.05]]), np.array([1.0, 1.0]))
    Guides.of(CANVAS, [STRAIGHT], regions).keep(kept, in_groups=True)
    assert kept.angles.tolist() == pytest.approx([1.0, np.pi / 18])


def test_a_stroke_that_left_its_region_lies_as_its_own_region_says_once_it_is_back(
    portrait: Picture, round_brush: Brush
) -> None:
    problem = problem_for(portrait, round_brush)
    labels = np.zeros(problem.weights.shape, dtype=np.int64)
    labels[:, labels.shape[1] // 2 :] = 1
    said = (Region("left", FREE, (True,), angle=0.0), Region("right", FREE, (True,), angle=1.2))
    regions = Regions(labels, said, problem.canvas)
    directed = replace(problem, regions=regions, style=regions.style, guides=Guides.of(problem.canvas, [], regions))
    away = strokes(np.array([[0.2 * problem.canvas.width, 0.5 * problem.canvas.height]]), np.array([0.0]))
    codes = regions.style.codes_in(1, FREE.sample(1, torch.Generator().manual_seed(0))[0])
    knots = FREE.sample(1, torch.Generator().manual_seed(0))[1]
    back = StrokeCanvas(replace(away, codes=codes, pressure_knots=knots), directed).strokes
    assert regions.at(back.centres).tolist() == [1]
    assert back.angles.item() == pytest.approx(1.2 - np.pi / 18)
