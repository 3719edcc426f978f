from itertools import permutations, product

import numpy as np
import pytest
import vpype
import vpype_cli
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from maulstick.errors import InputError
from maulstick.ordering.tour import Tour, pen_up, tour
from maulstick.storage.arrays import Bools, Floats
from tests.support.tolerances import TOUR_METRES

HOME = (0.0, 0.0)
Strokes = tuple[Floats, Bools]


def _ends(count: int, seed: int) -> Floats:
    """Strokes of some 20 mm, anywhere on a sheet of 200 mm."""
    rng = np.random.default_rng(seed)
    return 0.2 * rng.random((count, 1, 2)) + 0.02 * rng.standard_normal((count, 2, 2))


def _travel(ends: Floats, order: tuple[int, ...], turned: tuple[bool, ...]) -> float:
    """Return the pen-up travel, metres, added stroke by stroke."""
    metres, pen = 0.0, np.array(HOME)
    for stroke, backwards in zip(order, turned, strict=True):
        first, last = ends[stroke][::-1] if backwards else ends[stroke]
        metres += float(np.hypot(*(first - pen)))
        pen = last
    return metres


def _shortest(ends: Floats, reversible: Bools) -> float:
    """Return the shortest pen-up travel of all possible tours."""
    return min(
        _travel(ends, order, turned)
        for order in permutations(range(len(ends)))
        for turned in product(*((False, True) if reversible[stroke] else (False,) for stroke in order))
    )


def _to_the_nearest(ends: Floats, reversible: Bools) -> float:
    left, metres, pen = set(range(len(ends))), 0.0, np.array(HOME)
    while left:
        near = [(float(np.hypot(*(ends[s, end] - pen))), s, end) for s in left for end in range(1 + reversible[s])]
        step, stroke, end = min(near)
        left.remove(stroke)
        metres, pen = metres + step, ends[stroke, 1 - end]
    return metres


@st.composite
def strokes(draw: st.DrawFn) -> Strokes:
    count = draw(st.integers(0, 25))
    places = st.sampled_from([0.0, 0.1, 0.1, 0.3]) | st.floats(-1, 1)  # so that many coincide
    return draw(arrays(np.float64, (count, 2, 2), elements=places)), draw(arrays(np.bool_, count))


@given(strokes())
@settings(deadline=None)
def test_each_stroke_is_drawn_once_and_only_a_reversible_one_backwards(drawn: Strokes) -> None:
    ends, reversible = drawn
    way = tour(ends, reversible, HOME)
    assert sorted(way.order) == list(range(len(ends)))
    assert not way.turned[~reversible[way.order]].any()


@given(strokes())
@settings(deadline=None)
def test_pen_up_is_the_way_to_the_first_stroke_and_between_strokes(drawn: Strokes) -> None:
    ends, reversible = drawn
    way = tour(ends, reversible, HOME)
    step_by_step = _travel(ends, tuple(way.order), tuple(way.turned))
    assert pen_up(ends, way, HOME) == pytest.approx(step_by_step, abs=TOUR_METRES)


@pytest.mark.parametrize("count", [1, 2, 3, 4])
@pytest.mark.parametrize("seed", range(6))
def test_a_few_strokes_are_drawn_in_the_best_of_all_orders(count: int, seed: int) -> None:
    ends, reversible = _ends(count, seed), np.random.default_rng(seed).random(count) < 0.5
    way = tour(ends, reversible, HOME)
    assert pen_up(ends, way, HOME) == pytest.approx(_shortest(ends, reversible), abs=TOUR_METRES)


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_a_tour_is_a_tenth_shorter_than_going_to_the_nearest(share: float) -> None:
    ends, reversible = _ends(300, 1), np.random.default_rng(1).random(300) < share
    assert pen_up(ends, tour(ends, reversible, HOME), HOME) < 0.9 * _to_the_nearest(ends, reversible)


@pytest.mark.parametrize(("flips", "how"), [(True, "--two-opt"), (False, "--no-flip")])  # --two-opt always flips
def test_a_tour_is_no_longer_than_that_of_vpype(flips: bool, how: str) -> None:
    ends = _ends(400, 2)
    lines = vpype.LineCollection([stroke @ np.array([1, 1j]) for stroke in ends])
    theirs = vpype_cli.execute(f"linesort {how}", vpype.Document(lines)).pen_up_length()
    assert pen_up(ends, tour(ends, np.full(400, flips), HOME), HOME) < theirs


def test_a_pen_at_the_far_end_of_a_row_comes_back_along_it() -> None:
    x = np.array([0.3, 0.1, 0.0, 0.2])
    ends = np.stack([np.stack([x, 0 * x], axis=1), np.stack([x + 0.05, 0 * x], axis=1)], axis=1)
    forth, back = tour(ends, np.full(4, True), (-1.0, 0.0)), tour(ends, np.full(4, True), (1.0, 0.0))
    assert forth.order.tolist() == [2, 1, 3, 0]
    assert not forth.turned.any()
    assert back.order.tolist() == [0, 3, 1, 2]
    assert back.turned.all()


def test_a_tour_is_the_same_every_time() -> None:
    ends, reversible = _ends(200, 3), np.arange(200) % 2 == 0
    once, again = tour(ends, reversible, HOME), tour(ends, reversible, HOME)
    assert once.order.tolist() == again.order.tolist()
    assert once.turned.tolist() == again.turned.tolist()


def test_strokes_that_all_lie_upon_each_other_take_no_travel() -> None:
    ends = np.tile(np.array([[0.1, 0.1], [0.1, 0.1]]), (100, 1, 1))
    way = tour(ends, np.full(100, True), (0.1, 0.1))
    assert sorted(way.order) == list(range(100))
    assert pen_up(ends, way, (0.1, 0.1)) == 0


def test_no_strokes_make_a_tour_of_none() -> None:
    way = tour(np.zeros((0, 2, 2)), np.zeros(0, dtype=np.bool_), HOME)
    assert (len(way.order), len(way.turned), pen_up(np.zeros((0, 2, 2)), way, HOME)) == (0, 0, 0.0)


def test_a_stroke_without_a_place_is_refused() -> None:
    ends = _ends(3, 0)
    ends[1, 0, 1] = np.nan
    with pytest.raises(InputError, match="every x and y must be a finite number"):
        tour(ends, np.full(3, True), HOME)


def test_what_is_given_stays_as_it_was() -> None:
    ends, reversible = _ends(50, 4), np.full(50, True)
    before = ends.copy()
    tour(ends, reversible, HOME)
    assert (ends == before).all()
    assert reversible.all()


def test_turned_strokes_are_walked_backwards() -> None:
    ends = np.array([[[0.0, 0.0], [3.0, 0.0]], [[5.0, 4.0], [3.0, 4.0]]])
    assert pen_up(ends, Tour(np.array([0, 1]), np.array([False, True])), HOME) == 4.0
