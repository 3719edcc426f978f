"""Soft edges of regions."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.planning.soft_edges import softened

ALL = np.ones(3, dtype=bool)
NOISE = np.random.default_rng(5).random((200, 100))


def halves() -> np.ndarray:
    labels = np.zeros((200, 100), dtype=np.int64)
    labels[:, 50:] = 1
    return labels


def test_shares_change_evenly_over_the_width_and_not_beyond() -> None:
    soft = softened(halves(), 1, 20, ALL, NOISE)
    shares = soft.mean(axis=0)
    assert not soft[:, :39].any()
    assert soft[:, 61:].all()
    assert shares[45] == pytest.approx(0.275, abs=0.1)
    assert shares[49:51].mean() == pytest.approx(0.5, abs=0.08)
    assert shares[55] == pytest.approx(0.775, abs=0.1)


@given(width=st.floats(0, 300), closed=st.booleans())
def test_nothing_mingles_with_a_region_that_is_closed(width: float, closed: bool) -> None:
    labels = halves()
    labels[:60] = 2
    open_to = np.array([True, True, not closed])
    soft = softened(labels, 1, width, open_to, NOISE)
    if closed:
        assert ((soft == 2) == (labels == 2)).all()
    assert set(np.unique(soft)) <= {0, 1, 2}


@pytest.mark.parametrize("labels", [np.zeros((200, 100), dtype=np.int64), np.ones((200, 100), dtype=np.int64)])
def test_a_region_that_is_nowhere_or_everywhere_has_no_edge(labels: np.ndarray) -> None:
    assert (softened(labels, 1, 20, ALL, NOISE) == labels).all()
