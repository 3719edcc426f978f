import numpy as np
import pytest

from maulstick.strokes.strokes import Strokes
from maulstick.style.arrangement import Arrangement
from maulstick.style.hand import Hand
from tests.support.drawn import as_strokes, hatching, scattered


def learned(strokes: Strokes) -> Arrangement | None:
    return Hand.of(strokes).arrangement


def test_a_patch_of_hatching_is_a_group() -> None:
    arrangement = learned(as_strokes(hatching(6, seed=0)))
    assert arrangement is not None
    assert [rows.tolist() for rows in arrangement.groups] == np.arange(48).reshape(6, 8).tolist()


def test_a_long_run_of_near_strokes_is_parted_into_groups_of_ten() -> None:
    arrangement = learned(as_strokes(hatching(2, seed=0, each=24)))
    assert arrangement is not None
    assert [len(rows) for rows in arrangement.groups] == [10, 10, 4, 10, 10, 4]


def test_strokes_lie_where_they_were_drawn() -> None:
    drawn = hatching(6, seed=0)
    arrangement = learned(as_strokes(drawn))
    assert arrangement is not None
    assert arrangement.paths == pytest.approx(drawn)


def test_dots_between_strokes_move_none_of_them() -> None:
    drawn = hatching(6, seed=0)
    with_dots = np.insert(drawn, [3, 20], 1e-3 * drawn[:2], axis=0)
    arrangement = learned(as_strokes(with_dots))
    assert arrangement is not None
    assert arrangement.paths == pytest.approx(drawn)


def test_few_strokes_have_no_arrangement_and_thirty_have() -> None:
    strokes = as_strokes(hatching(6, seed=0))
    assert learned(strokes[:29]) is None
    assert learned(strokes[:30]) is not None


def test_strokes_that_are_strewn_have_no_arrangement() -> None:
    strewn = scattered(60, seed=0) + 10 * np.random.default_rng(0).random((60, 1, 2))
    assert learned(as_strokes(strewn)) is None


def test_strokes_of_unknown_places_have_no_arrangement() -> None:
    hand = Hand.of(as_strokes(hatching(6, seed=0)))
    assert Hand(hand.paths, hand.pressure, hand.speeds).arrangement is None


def test_a_hand_that_draws_half_as_large_is_arranged_the_same() -> None:
    hand = Hand.of(as_strokes(hatching(6, seed=0)))
    half = hand.scaled(0.5)
    assert hand.arrangement is not None
    assert half.arrangement is not None
    assert half.arrangement.paths == pytest.approx(0.5 * hand.arrangement.paths)
    assert len(half.arrangement.groups) == len(hand.arrangement.groups)


def test_a_hand_leans_as_its_strokes_do_and_turned_by_a_quarter_the_other_way() -> None:
    level = np.zeros((40, 32, 2))
    level[..., 0], level[..., 1] = np.linspace(0, 0.02, 32), 0.002 * np.arange(40)[:, None]
    for drawn, leaning in ((level, 1), (level[..., ::-1], -1)):
        arrangement = learned(as_strokes(drawn))
        assert arrangement is not None
        assert arrangement.leaning == pytest.approx(leaning)
        assert arrangement.directions == pytest.approx(np.full(40, 0.02 * leaning))


def test_strokes_along_their_group_are_aligned_and_one_across_it_is_not() -> None:
    drawn = hatching(6, seed=0)
    middle = drawn[3].mean(axis=0)
    drawn[3] = middle + (drawn[3] - middle) @ np.array([[0, 1], [-1, 0]])
    arrangement = learned(as_strokes(drawn))
    assert arrangement is not None
    assert arrangement.alignments[3] < -0.8
    assert np.delete(arrangement.alignments, 3).min() > 0.8
