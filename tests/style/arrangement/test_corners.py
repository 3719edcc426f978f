import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import cdist

from maulstick.storage.arrays import Floats, Ints
from maulstick.style.arrangement import _neighbourhoods

CORNERS = 16


def nearest(lines: Floats, corners: int = CORNERS // 2) -> Ints:
    found = np.empty((len(lines), corners), dtype=np.int64)
    _neighbourhoods.nearest(lines, found)
    return found


def check(lines: Floats, corners: int = CORNERS // 2) -> None:
    """Compare with looking at all pairs."""
    count, each, _ = lines.shape
    points = lines.reshape(-1, 2)
    ours = lines[:, :: each // corners].reshape(-1, 2)
    apart = cdist(ours, points, "sqeuclidean")
    own = np.arange(count).repeat(corners)[:, None] == np.arange(count).repeat(each)
    apart[own] = np.inf
    found = nearest(lines, corners).ravel()
    chosen = apart[np.arange(len(ours)), found]
    assert chosen == pytest.approx(apart.min(axis=1), rel=1e-12, abs=0)


@settings(max_examples=60, deadline=None)
@given(
    count=st.integers(2, 40),
    seed=st.integers(0, 2**32 - 1),
    spread=st.sampled_from([1e-4, 0.01, 1.0]),
    corners=st.sampled_from([1, 2, 8, 16]),
    across=st.sampled_from([0.0, 1e-9, 1.0]),
)
def test_the_nearest_corner_of_another_line_is_found(
    count: int, seed: int, spread: float, corners: int, across: float
) -> None:
    rng = np.random.default_rng(seed)
    lines = rng.random((count, 1, 2)) + spread * rng.normal(size=(count, CORNERS, 2)).cumsum(axis=1)
    lines[..., 1] *= across
    check(lines, corners)


def test_two_heaps_far_apart_are_searched_as_one_is() -> None:
    rng = np.random.default_rng(0)
    lines = 1e-3 * rng.random((200, CORNERS, 2))
    lines[:2] += 5.0
    check(lines)


@pytest.mark.parametrize("where", [0.0, -3.0])
def test_lines_that_are_one_point_have_each_other(where: float) -> None:
    found = nearest(np.full((3, CORNERS, 2), where))
    assert found // CORNERS == pytest.approx(np.array([1, 0, 0])[:, None].repeat(CORNERS // 2, axis=1))


@pytest.mark.parametrize("where", [np.nan, np.inf])
def test_a_corner_that_is_nowhere_is_refused(where: float) -> None:
    lines = np.random.default_rng(0).random((3, CORNERS, 2))
    lines[1, 7, 1] = where
    with pytest.raises(ValueError, match="a corner of a line is nowhere"):
        nearest(lines)
