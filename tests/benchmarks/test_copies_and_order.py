"""Groups that are copies, and orders that can be foretold (benchmarks/copies.py, benchmarks/succession.py)."""

from typing import Any

import numpy as np
import pytest

from tests.support.drawn import hatching, line, rotation, scattered


def test_runs_end_at_a_long_jump_and_after_ten_strokes(bench: Any) -> None:
    rows = [*range(12), *range(15, 18), 40]
    paths = np.array([line((0, 0.5 * i), (1, 0.5 * i)) for i in rows])
    assert [len(group) for group in bench.copies.groups(paths)] == [10, 2, 3, 1]


def test_a_group_moved_turned_shuffled_and_drawn_backwards_is_a_copy(bench: Any) -> None:
    learned, rng = scattered(40, seed=4), np.random.default_rng(5)
    group = learned[7:13] @ rotation(2.2) + np.array([0.3, 0.1])
    group = rng.permutation(group)
    group[::2] = group[::2, ::-1]
    close = 0.05 * np.std(group.reshape(-1, 2), axis=0).mean()
    learned, exact, shaken = (
        bench.copies.as_complex(each) for each in (learned, group, group + rng.normal(0, close, group.shape))
    )
    assert bench.copies.is_copy(exact, learned)
    assert bench.copies.is_copy(shaken, learned)


def test_a_mirrored_group_other_places_and_another_hand_are_no_copies(bench: Any) -> None:
    learned = scattered(40, seed=4)
    group = learned[7:13]
    moved = group + np.random.default_rng(6).uniform(-0.05, 0.05, (6, 1, 2))
    learned, *others = (
        bench.copies.as_complex(each) for each in (learned, group * (1, -1), moved, scattered(6, seed=7))
    )
    assert not any(bench.copies.is_copy(other, learned) for other in others)


def test_the_share_of_copied_groups_counts_groups_of_three_and_more(bench: Any) -> None:
    learned = hatching(6, seed=8)
    fan = np.array([line((0, 0), 0.02 * np.array([np.cos(angle), np.sin(angle)])) for angle in (0, 1, 2)])
    lone, shift = np.array([line((-9, -9), (-9, -8.98))]), np.array([9, 9])
    assert bench.copies.copied_share(learned, learned) == 1
    drawing = np.concatenate([learned[:8] + shift, lone, learned[8:16] - shift, 2 * lone, fan])
    assert bench.copies.copied_share(drawing, learned) == pytest.approx(2 / 3)
    assert bench.copies.copied_share(lone.repeat(2, axis=0), learned) == 0


def test_thrown_groups_are_copies_anywhere_on_the_sheet(bench: Any) -> None:
    learned = hatching(6, seed=8)
    thrown = bench.arrangement.thrown(bench.copies.groups(learned), np.random.default_rng(0))
    middles = thrown.reshape(-1, 8, 32, 2).mean(axis=(1, 2))
    assert len(thrown) == 800
    assert bench.copies.copied_share(thrown, learned) > 0.8
    assert middles.mean(axis=0) == pytest.approx((0.12, 0.08), abs=0.02)
    assert np.ptp(middles, axis=0) == pytest.approx((0.24, 0.16), abs=0.02)


def test_an_order_that_was_drawn_foretells_its_like_and_not_another(bench: Any) -> None:
    succession = bench.succession.Succession.of(hatching(10, seed=10))
    other = hatching(10, seed=11)
    shuffled = np.random.default_rng(0).permutation(other)
    assert succession.foretold(other) > 0.7
    assert succession.nats(other) < 1
    assert succession.nats(shuffled) > 3 * succession.nats(other)
    assert bench.succession.travel(shuffled) > 2 * bench.succession.travel(other)


def test_an_order_at_random_is_as_hard_to_foretell_as_a_choice_at_random(bench: Any) -> None:
    succession = bench.succession.Succession.of(scattered(60, seed=12))
    left = np.minimum(
        np.arange(199, 1, -1), bench.succession.CHOICES
    )  # the next, and 49 others while there are so many
    assert succession.nats(scattered(200, seed=13)) == pytest.approx(np.log(left).mean(), abs=0.3)


def test_travel_is_the_mean_way_between_strokes_in_median_lengths(bench: Any) -> None:
    paths = np.array([line((0, 0), (2, 0)), line((2, 1), (4, 1)), line((4, 4), (6, 4))])
    assert bench.succession.travel(paths) == pytest.approx((1 + 3) / 2 / 2)
