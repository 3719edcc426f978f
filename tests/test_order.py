import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from maulstick.order import by_paint, light_to_dark
from maulstick.palette import lightness

colours = st.integers(1, 30).flatmap(lambda n: arrays(np.float64, (n, 3), elements=st.floats(0, 1, width=16)))
paint_of_each = st.lists(st.integers(0, 4), max_size=30).map(lambda paints: np.array(paints, dtype=np.int64))


@given(colours)
def test_light_strokes_come_before_dark_ones_and_each_comes_once(strokes: NDArray[np.float64]) -> None:
    order = light_to_dark(strokes)
    assert sorted(order) == list(range(len(strokes)))
    assert (np.diff(lightness(strokes[order])) <= 0).all()


@given(st.integers(0, 20))
def test_strokes_of_one_colour_stay_as_they_were(count: int) -> None:
    assert light_to_dark(np.full((count, 3), 0.4)).tolist() == list(range(count))


def test_white_comes_first_and_black_last() -> None:
    assert light_to_dark(np.array([[0.0, 0, 0], [0, 0, 1], [1, 1, 1], [0, 1, 0]])).tolist() == [2, 3, 1, 0]


@given(paint_of_each, st.randoms(use_true_random=False))
def test_a_paint_stands_together_in_the_order_that_was_before(paint_of: NDArray[np.int64], chance: object) -> None:
    before = np.arange(len(paint_of))
    chance.shuffle(before)  # type: ignore[attr-defined]
    order = by_paint(paint_of, before)
    assert (np.diff(paint_of[order]) >= 0).all()
    for paint in range(5):
        assert order[paint_of[order] == paint].tolist() == before[paint_of[before] == paint].tolist()
