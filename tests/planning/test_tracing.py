"""Lines of a picture, and strokes that are laid along them."""

from itertools import repeat

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image, ImageDraw

from maulstick.planning.tracing import Along, lay_along, traced, within
from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import path_lengths

SIZE = (160, 200)  # pixels


def drawn(*lines: list[tuple[float, float]], width: int = 2, size: tuple[int, int] = SIZE) -> Floats:
    """How dark lines are, (H, W)."""
    image = Image.new("L", size[::-1], 255)
    for points in lines:
        ImageDraw.Draw(image).line(points, fill=0, width=width, joint="curve")
    return 1 - np.asarray(image, dtype=np.float64) / 255


def arc(radius: float, start: float, end: float, points: int = 60) -> Floats:
    angles = np.linspace(start, end, points)
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def lines_of(dark: Floats, weights: Floats | None = None) -> list[Floats]:
    return traced(dark, np.ones_like(dark) if weights is None else weights)


def stroke(length: float, bend: float = 0.0) -> Floats:
    """A stroke of 32 points from the left to the right, over its chord's middle by `bend` of its chord."""
    share = np.linspace(0, 1, 32)
    return np.stack([length * share, 4 * bend * length * share * (1 - share)], axis=1)


def hand(*strokes: Floats) -> Floats:
    return np.stack(strokes)


def laid(line: Floats, paths: Floats, times: int = 100) -> Along:
    return lay_along([line], paths, np.full(len(paths), times))


def farthest(points: Floats, line: Floats) -> float:
    return float(np.linalg.norm(points[:, None] - line, axis=-1).min(axis=1).max())


STRAIGHT = np.stack([np.linspace(20.0, 180.0, 161), np.full(161, 80.0)], axis=1)


def test_a_line_is_traced_from_end_to_end_in_points_a_pixel_apart() -> None:
    (line,) = lines_of(drawn([(20, 30), (180, 120)]))
    assert np.linalg.norm(np.diff(line, axis=0), axis=1) == pytest.approx(1, abs=0.1)
    assert np.array(sorted(line[[0, -1]].tolist())) == pytest.approx(np.array([[20, 30], [180, 120]]), abs=6)
    assert farthest(line, np.linspace((18, 29), (182, 121), 400)) < 1.5


def test_a_ring_is_one_line() -> None:
    (line,) = lines_of(drawn([tuple(p) for p in (arc(50, 0, 2 * np.pi) + np.array([100, 80])).tolist()]))
    assert np.linalg.norm(line - (100, 80), axis=1) == pytest.approx(50, abs=2.5)
    assert len(line) > 280


def test_a_line_goes_straight_on_where_another_meets_it() -> None:
    lines = lines_of(drawn([(20, 80), (180, 80)], [(100, 20), (100, 140)]))
    assert len(lines[0]) > 140
    assert np.ptp(lines[0][:, 1]) < 4


def test_what_matters_more_is_traced_first() -> None:
    picture, weights = drawn([(20, 40), (180, 40)], [(20, 120), (120, 120)]), np.ones(SIZE)
    assert lines_of(picture)[0][:, 1].mean() == pytest.approx(40, abs=2)
    weights[80:] = 3
    assert lines_of(picture, weights)[0][:, 1].mean() == pytest.approx(120, abs=2)


def test_a_faint_line_is_traced_where_it_hangs_together_with_a_dark_one() -> None:
    both = np.maximum(0.25 * drawn([(20, 40), (180, 40)]), drawn([(20, 40), (60, 40)]))
    (line,) = lines_of(np.maximum(both, 0.25 * drawn([(20, 120), (180, 120)])))
    assert np.ptp(line[:, 0]) > 150
    assert line[:, 1] == pytest.approx(40, abs=2)


@pytest.mark.parametrize("size", [(1, 1), (2, 3), (40, 1), (60, 90)])
def test_a_blank_picture_of_any_size_has_no_lines(size: tuple[int, int]) -> None:
    assert lines_of(np.zeros(size)) == []


def test_lines_are_cut_where_they_may_not_be() -> None:
    where = np.ones(SIZE, dtype=bool)
    where[:, 60:90] = False
    left, right = within([STRAIGHT], where)
    assert left[:, 0].max() < 60
    assert right[:, 0].min() >= 90
    assert len(left) + len(right) == len(STRAIGHT) - 30
    assert within([STRAIGHT], np.zeros(SIZE, dtype=bool)) == []


def test_strokes_lie_end_to_end_from_one_end_of_a_line_to_the_other() -> None:
    found = laid(STRAIGHT, hand(stroke(40), stroke(23), stroke(9)))
    assert found.rows.tolist()[:4] == [0, 0, 0, 0], "the longest that fit"
    ends = found.paths[:, [0, -1], 0]
    assert ends[1:, 0] == pytest.approx(ends[:-1, 1], abs=1)
    assert (ends.min(), ends.max()) == pytest.approx((20, 180), abs=3)
    assert farthest(found.paths.reshape(-1, 2), STRAIGHT) < 0.6


@pytest.mark.parametrize("lap", [0.25, 0.6, -0.25])
def test_strokes_lap_over_the_next_or_leave_a_gap_before_it(lap: float) -> None:
    hands = hand(stroke(20))
    found = lay_along([STRAIGHT], hands, np.array([100]), repeat(lap))
    ends = found.paths[:, [0, -1], 0]
    assert ends[:-1, 1] - ends[1:, 0] == pytest.approx(np.full(len(ends) - 1, 20 * lap), abs=1.5)
    assert ends[-1, 1] > 160


def test_a_line_is_done_where_its_end_is_reached_however_far_strokes_lap() -> None:
    found = lay_along([STRAIGHT, STRAIGHT], hand(stroke(40)), np.array([100]), repeat(0.8))
    assert (found.paths[:, -1, 0] > 175).sum() == 2


def test_each_stroke_is_used_as_often_as_there_are_of_it() -> None:
    found = lay_along([STRAIGHT, STRAIGHT], hand(stroke(40), stroke(20)), np.array([3, 5]))
    assert np.bincount(found.rows).tolist() == [3, 5]


def test_a_bent_line_is_drawn_by_bent_strokes() -> None:
    line = arc(60, 0, np.pi, 190)
    found = laid(line, hand(stroke(50), stroke(50, 0.11), stroke(50, -0.11)))
    assert len(set(found.rows.tolist())) == 1
    assert found.rows[0] in (1, 2)
    assert farthest(found.paths.reshape(-1, 2), line) < 2


def test_strokes_that_lie_off_a_line_or_curl_are_left_to_others() -> None:
    curl = arc(10, 0, 1.9 * np.pi, 32)
    wave = stroke(40) + [0, 1] * np.sin(np.linspace(0, 6 * np.pi, 32))[:, None] * 8
    assert len(laid(STRAIGHT, hand(curl, wave)).rows) == 0
    assert len(laid(STRAIGHT, hand(curl, wave, stroke(40))).rows) == 4


@given(st.floats(0, 2 * np.pi), st.floats(0, 2 * np.pi), st.floats(-0.05, 0.05))
def test_a_stroke_is_drawn_the_hands_way_whichever_way_the_line_goes(along: float, own: float, bend: float) -> None:
    def turned(points: Floats, angle: float) -> Floats:
        return points @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])

    paths = turned(stroke(30, bend), own)[None]
    found = laid(turned(STRAIGHT, along), paths)
    assert len(found.rows) >= 4
    assert (np.abs(found.turns) <= np.pi / 2 + 1e-9).all()
    for path, turn in zip(found.paths, found.turns.tolist(), strict=True):
        again = turned(paths[0], turn)
        assert path - path.mean(axis=0) == pytest.approx(again - again.mean(axis=0), abs=1e-6)
    assert path_lengths(found.paths) == pytest.approx(path_lengths(paths)[0])


@pytest.mark.parametrize("rest", [34, 38])
def test_a_stroke_may_go_on_a_little_beyond_the_end_of_a_line(rest: int) -> None:
    found = laid(STRAIGHT[: 120 + rest], hand(stroke(40)))
    ends = np.sort(found.paths[:, [0, -1], 0], axis=1)
    assert len(found.rows) == 4
    assert ends[-1] == pytest.approx([140, 180], abs=1.5)


def test_a_stroke_that_would_mostly_lie_beyond_the_end_of_a_line_is_left_to_others() -> None:
    assert len(laid(STRAIGHT[:135], hand(stroke(40))).rows) == 3


def test_of_a_stroke_that_fits_badly_hardly_any_of_a_line_is_drawn() -> None:
    wobbly = stroke(40) + [0, 1] * np.sin(np.linspace(0, 8 * np.pi, 32))[:, None]
    assert len(laid(STRAIGHT, hand(wobbly)).rows) == 4
    assert len(laid(STRAIGHT, hand(stroke(40) + 2 * (wobbly - stroke(40)))).rows) == 0


def test_a_line_that_comes_back_to_where_it_began_is_drawn_to_its_end() -> None:
    line = arc(40, 0, 2 * np.pi, 250)
    found = laid(line, hand(stroke(12), stroke(12, 0.04)))
    assert farthest(line, found.paths.reshape(-1, 2)) < 6
    assert len(laid(np.ones((5, 2)), hand(stroke(12))).rows) == 0, "nowhere to go"
