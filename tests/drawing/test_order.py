from collections import Counter
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from maulstick.drawing import order
from maulstick.drawing.order import joined
from maulstick.storage.arrays import Floats

GAP = 1e-4
GRID = 1e-3  # metres, far above the gap


def line(*points: tuple[float, float]) -> Floats:
    return np.array(points)


def steps(lines: list[Floats]) -> Counter[tuple[tuple[float, ...], ...]]:
    """The steps of lines, whichever way they go."""
    return Counter(tuple(sorted((tuple(a), tuple(b)))) for each in lines for a, b in pairwise(each))


def test_lines_whose_ends_meet_are_one_whichever_way_they_were_drawn() -> None:
    middle, turned, before = line((1, 0), (2, 1)), line((3, 0), (2, 1)), line((1, 0), (0, 0))
    (one,) = joined([middle, turned, before], GAP)
    assert one.tolist() == [[0, 0], [1, 0], [2, 1], [3, 0]]


def test_a_gap_up_to_the_one_that_is_asked_for_is_drawn_and_a_wider_one_is_not() -> None:
    lines = [line((0, 0), (1, 0)), line((1 + 0.9 * GAP, 0), (2, 0)), line((2 + 1.1 * GAP, 0), (3, 0))]
    found = joined(lines, GAP)
    assert [len(each) for each in found] == [4, 2]
    assert found[0][:, 0].tolist() == [0, 1, 1 + 0.9 * GAP, 2]


def test_a_line_goes_on_with_the_nearest_end() -> None:
    first, near, far = line((0, 0), (1, 0)), line((1 + 0.2 * GAP, 0), (2, 0)), line((1 + 0.1 * GAP, GAP / 2), (2, 1))
    assert [len(each) for each in joined([first, far, near], GAP)] == [4, 2]


@pytest.mark.parametrize("apart", [0.0, 1e-17, 1e-9])
def test_lines_that_meet_in_one_place_or_nearly_are_joined_by_looking_at_a_few_ends_each(
    apart: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    looked = 0

    class Counting:
        def __init__(self, places: Floats) -> None:
            self._tree = cKDTree(places)

        def query(self, place: Floats, count: int, **how: Any) -> Any:
            nonlocal looked
            looked += count
            return self._tree.query(place, count, **how)

        def query_ball_point(self, place: Floats, distance: float) -> Any:
            nonlocal looked
            near = self._tree.query_ball_point(place, distance)
            looked += len(near)
            return near

    monkeypatch.setattr(order, "cKDTree", Counting)
    many, rng = 1000, np.random.default_rng(0)
    starts = rng.normal(0, apart, (many, 2))
    found = joined([line(tuple(start), (1, number)) for number, start in enumerate(starts)], GAP)
    assert looked < 30 * many
    assert len(found) == many // 2
    if apart == 0:
        ends = [[[1, number + 1], [0, 0], [1, number]] for number in range(0, many, 2)]
        assert [each[:: 1 if each[0, 1] > each[-1, 1] else -1].tolist() for each in found] == ends


def test_closed_lines_and_dots_stay_alone_and_each_line_keeps_its_place() -> None:
    ring, dot, ends = line((1, 0), (2, 0), (2, 1), (1, 0)), line((1, 0), (1, 0)), [line((0, 0), (1, 0))]
    found = joined([ring, *ends, dot, line((1, 0), (5, 5))], GAP)
    assert [len(each) for each in found] == [4, 3, 2]
    assert joined([], GAP) == []


@given(
    st.lists(
        st.lists(st.tuples(st.integers(0, 3), st.integers(0, 3)), min_size=2, max_size=4).filter(
            lambda places: all(a != b for a, b in pairwise(places))
        ),
        max_size=12,
    )
)
def test_what_is_joined_draws_every_step_once_and_leaves_no_two_ends_together(
    places: list[list[tuple[int, int]]],
) -> None:
    lines = [GRID * np.array(each, dtype=np.float64) for each in places]
    found = joined(lines, GAP)
    assert steps(found) == steps(lines)
    ends = [tuple(end) for each in found if (each[0] != each[-1]).any() for end in each[[0, -1]].tolist()]
    assert len(set(ends)) == len(ends)


@pytest.mark.parametrize("seed", range(3))
def test_pieces_of_one_path_are_joined_to_that_path_as_by_vpype(seed: int) -> None:
    import vpype

    rng = np.random.default_rng(seed)
    path = np.cumsum(rng.uniform(GRID, 2 * GRID, size=(60, 2)), axis=0)
    pieces = [path[start : start + 4][:: rng.choice([1, -1])] for start in range(0, 57, 3)]
    shuffled = [pieces[i] for i in rng.permutation(len(pieces))]
    theirs = vpype.LineCollection([each[:, 0] + 1j * each[:, 1] for each in shuffled])
    theirs.merge(GAP)
    (found,) = joined(shuffled, GAP)
    assert len(theirs) == 1
    assert found[:: 1 if found[0, 0] < found[-1, 0] else -1].tolist() == path[: 57 + 1].tolist()
