"""Orders in which a hand would draw strokes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from maulstick.ordering.succession import TRAVEL, Outlines, drawn_by
from maulstick.ordering.tour import Tour, tour
from maulstick.painting.succession import Succession
from maulstick.storage.arrays import Floats
from tests.support.drawn import line, scattered

HOME = (0.0, 0.0)
NOTHING = Succession(jump=0, distance=0, along=0, parallel=0, same_way=0, unlike=0)
END_TO_END = NOTHING.model_copy(update={"along": 4.0})
ONE_WAY = NOTHING.model_copy(update={"same_way": 10.0})


def dashes(rows: int = 6, each: int = 6) -> Floats:
    """Rows of dashes, a little farther apart in their row than from those of the next."""
    return np.array([line((1.4 * i, 0.3 * k), (1.4 * i + 1, 0.3 * k)) for i in range(each) for k in range(rows)])


def way_of(paths: Floats, succession: Succession, reversible: bool = True) -> Tour:
    may = np.full(len(paths), reversible)
    return drawn_by(succession, paths, may, tour(paths[:, [0, -1]], may, HOME))


def drawn(way: Tour) -> np.ndarray[tuple[int, ...], np.dtype[np.int64]]:
    return 2 * way.order + way.turned


def price(paths: Floats, succession: Succession, way: Tour) -> float:
    outlines, ways = Outlines.of(paths), drawn(way)
    travel = outlines.jumps(ways[:-1], ways[1:]).sum()
    return float(TRAVEL * travel - (outlines.numbers(ways[:-1], ways[1:]) @ succession.weights).sum())


def test_a_hand_that_draws_end_to_end_goes_along_rows_where_the_way_across_them_is_shorter() -> None:
    paths = dashes()
    quick, by_hand = (way_of(paths, each) for each in (NOTHING, END_TO_END))
    in_row = [np.isclose(np.diff(paths[way.order, 0, 1]), 0).mean() for way in (quick, by_hand)]
    assert in_row[0] < 0.5
    assert in_row[1] > 0.7


def test_a_hand_that_always_draws_the_same_way_goes_back_between_strokes() -> None:
    paths = np.array([line((0, 0.1 * i), (1, 0.1 * i)) for i in range(13)])
    to_and_fro, one_way = (way_of(paths, each).turned for each in (NOTHING, ONE_WAY))
    assert to_and_fro.sum() == 6
    assert one_way.all() or not one_way.any()


def test_a_hand_of_no_habits_keeps_the_short_way() -> None:
    paths = scattered(60, seed=0)
    may = np.ones(60, dtype=np.bool_)
    quick = tour(paths[:, [0, -1]], may, HOME)
    assert price(paths, NOTHING, way_of(paths, NOTHING)) <= price(paths, NOTHING, quick)
    assert (way_of(paths, NOTHING).order == quick.order).mean() > 0.9


@given(
    st.integers(1, 40),
    st.integers(0, 10**6),
    st.lists(st.floats(-5, 5), min_size=6, max_size=6),
    st.sampled_from([0.0, 0.5, 1.0]),
)
@settings(max_examples=40, deadline=None)
def test_every_stroke_is_drawn_once_backwards_only_where_it_may_be_and_at_no_worse_price(
    count: int, seed: int, weights: list[float], share: float
) -> None:
    paths = scattered(count, seed)
    may = np.random.default_rng(seed).random(count) < share
    succession = Succession(**dict(zip(Succession.model_fields, weights, strict=True)))
    quick = tour(paths[:, [0, -1]], may, HOME)
    way = drawn_by(succession, paths, may, quick)
    assert sorted(way.order) == list(range(count))
    assert not (way.turned & ~may[way.order]).any()
    assert price(paths, succession, way) <= price(paths, succession, quick) + 1e-9
    assert drawn(way)[[0, -1]].tolist() == drawn(quick)[[0, -1]].tolist()


def test_the_same_strokes_are_drawn_in_the_same_order() -> None:
    one, two = (drawn(way_of(scattered(80, seed=1), END_TO_END)) for _ in range(2))
    assert one.tolist() == two.tolist()


@pytest.mark.parametrize("times", [0.01, 100.0])
def test_a_sheet_of_another_size_is_drawn_in_the_same_order(times: float) -> None:
    paths = scattered(60, seed=2)
    ends = Tour(np.arange(60), np.zeros(60, dtype=np.bool_))
    found = [drawn(drawn_by(END_TO_END, each, np.ones(60, dtype=np.bool_), ends)) for each in (paths, times * paths)]
    assert found[0].tolist() == found[1].tolist()
    assert found[0].tolist() != drawn(ends).tolist()


def test_no_strokes_and_few_stay_as_they_are() -> None:
    for count in range(3):
        paths = scattered(count, seed=0)
        assert (
            way_of(paths, END_TO_END).order.tolist()
            == tour(paths[:, [0, -1]], np.ones(count, np.bool_), HOME).order.tolist()
        )


def test_dots_are_drawn_once_each() -> None:
    paths = np.repeat(scattered(20, seed=0)[:, :1], 32, axis=1)
    assert sorted(way_of(paths, END_TO_END).order) == list(range(20))
