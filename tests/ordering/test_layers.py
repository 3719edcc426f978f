from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from maulstick.colour.palette import lightness
from maulstick.ordering.layers import by_paint, light_to_dark, runs

colours = st.integers(1, 30).flatmap(lambda n: arrays(np.float64, (n, 3), elements=st.floats(0, 1, width=16)))
ONE = np.zeros(5, dtype=np.int64)  # brush of all paints
paint_of_each = st.lists(st.integers(0, 4), max_size=30).map(lambda paints: np.array(paints, dtype=np.int64))


@given(colours, st.integers(1, 3))
def test_a_brush_paints_its_light_strokes_before_its_dark_ones_and_each_once(
    strokes: NDArray[np.float64], brushes: int
) -> None:
    brush_of = np.arange(len(strokes)) % brushes
    order = light_to_dark(strokes, brush_of)
    assert sorted(order) == list(range(len(strokes)))
    assert (np.diff(brush_of[order]) >= 0).all()
    for brush in range(brushes):
        assert (np.diff(lightness(strokes[order[brush_of[order] == brush]])) <= 0).all()


@given(st.integers(0, 20))
def test_strokes_of_one_colour_stay_as_they_were(count: int) -> None:
    assert light_to_dark(np.full((count, 3), 0.4), np.zeros(count, int)).tolist() == list(range(count))


def test_white_comes_first_and_black_last() -> None:
    four = np.array([[0.0, 0, 0], [0, 0, 1], [1, 1, 1], [0, 1, 0]])
    assert light_to_dark(four, np.zeros(4, int)).tolist() == [2, 3, 1, 0]
    assert light_to_dark(four, np.array([0, 1, 1, 0])).tolist() == [3, 0, 2, 1]


@given(paint_of_each, st.randoms(use_true_random=False))
def test_a_paint_stands_together_in_the_order_that_was_before(paint_of: NDArray[np.int64], rng: object) -> None:
    before = np.arange(len(paint_of))
    rng.shuffle(before)  # type: ignore[attr-defined]
    brush_of = np.array(before) % 2
    order = by_paint(paint_of, brush_of, before)
    loads = 5 * brush_of + paint_of
    assert (np.diff(loads[order]) >= 0).all()
    for load in range(10):
        assert order[loads[order] == load].tolist() == before[loads[before] == load].tolist()


@st.composite
def layered(draw: st.DrawFn) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Draw the paints of strokes, and pairs of them that overlap."""
    paint_of = draw(paint_of_each.filter(len))
    pairs = [(i, j) for j in range(len(paint_of)) for i in range(j) if paint_of[i] != paint_of[j]]
    chosen = draw(st.lists(st.sampled_from(pairs), unique=True, max_size=60)) if pairs else []
    return paint_of, np.array(chosen, dtype=np.int64).reshape(-1, 2)


@given(layered())
def test_a_run_has_one_paint_and_the_next_has_another(strokes: tuple[NDArray[np.int64], NDArray[np.int64]]) -> None:
    paint_of, overlaps = strokes
    found = runs(paint_of, ONE, overlaps)
    assert sorted(np.concatenate(found)) == list(range(len(paint_of)))
    paints = [set(paint_of[run].tolist()) for run in found]
    assert all(len(each) == 1 for each in paints)
    assert all(one != next_one for one, next_one in pairwise(paints))


@given(layered())
def test_what_lies_below_is_painted_in_an_earlier_run(strokes: tuple[NDArray[np.int64], NDArray[np.int64]]) -> None:
    paint_of, overlaps = strokes
    run_of = np.empty(len(paint_of), dtype=np.int64)
    for number, run in enumerate(runs(paint_of, ONE, overlaps)):
        run_of[run] = number
    assert (run_of[overlaps[:, 0]] < run_of[overlaps[:, 1]]).all()


@given(layered())
def test_paint_is_never_changed_more_often_than_before(strokes: tuple[NDArray[np.int64], NDArray[np.int64]]) -> None:
    paint_of, overlaps = strokes
    assert len(runs(paint_of, ONE, overlaps)) <= 1 + np.count_nonzero(np.diff(paint_of))


@given(layered(), st.lists(st.integers(0, 2), min_size=5, max_size=5).map(np.array))
def test_brushes_are_changed_no_more_often_than_before_and_what_lies_below_stays_there(
    strokes: tuple[NDArray[np.int64], NDArray[np.int64]], brushes: NDArray[np.int64]
) -> None:
    paint_of, overlaps = strokes
    found = runs(paint_of, brushes, overlaps)
    order = np.concatenate(found)
    assert sorted(order) == list(range(len(paint_of)))
    assert (np.argsort(order)[overlaps[:, 0]] < np.argsort(order)[overlaps[:, 1]]).all()
    changes = (np.count_nonzero(np.diff(brushes[paint_of[each]])) for each in (order, np.arange(len(paint_of))))
    assert next(changes) <= next(changes)
    without = runs(paint_of, ONE, overlaps)
    fewer = np.count_nonzero(np.diff(brushes[paint_of[order]])) < np.count_nonzero(
        np.diff(brushes[paint_of[np.concatenate(without)]])
    )
    assert fewer or len(found) <= len(without)


def test_a_brush_is_kept_in_hand_before_a_paint_is() -> None:
    found = runs(np.array([0, 2, 1, 3, 0, 2, 2]), np.array([0, 0, 1, 1]), np.array([[0, 2], [1, 3], [0, 5]]))
    assert [run.tolist() for run in found] == [[0, 4], [2], [1, 5, 6], [3]]


def test_strokes_that_lie_apart_need_each_paint_once() -> None:
    found = runs(np.array([2, 0, 2, 1, 0, 1, 2, 0]), ONE, np.zeros((0, 2), dtype=np.int64))
    assert sorted(run.tolist() for run in found) == [[0, 2, 6], [1, 4, 7], [3, 5]]


def test_the_paint_that_most_depends_on_comes_first() -> None:
    # Three strokes of paint 0 are free, but one of paint 1 lies under a stack: 1, 0, 1, 0.
    paint_of, overlaps = np.array([0, 0, 0, 1, 0, 1, 0]), np.array([[3, 4], [4, 5], [5, 6]])
    assert [run.tolist() for run in runs(paint_of, ONE, overlaps)] == [[3], [0, 1, 2, 4], [5], [6]]


def test_the_paints_are_taken_up_as_before_where_that_is_better() -> None:
    # Paint 2 could come first, and so could 0: to finish with 3 between them takes the one and the other again.
    paint_of, overlaps = np.array([2, 0, 0, 3, 2]), np.array([[0, 1], [0, 3], [2, 3], [3, 4]])
    assert [run.tolist() for run in runs(paint_of, ONE, overlaps)] == [[0], [1, 2], [3], [4]]
