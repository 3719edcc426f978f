"""What a hand draws next, learned from the order that it drew in."""

import numpy as np
import pytest

from maulstick.ordering.succession import Outlines
from maulstick.painting.succession import Succession
from maulstick.storage.arrays import Floats
from maulstick.style.arrangement.order import succession_of
from tests.support.drawn import hatching, line, scattered

ALIKE = 1e-6  # of weights: the same drawing at another size
FOUND = 0.35  # of weights: from 400 choices


def drawn_by_chance(succession: Succession, paths: Floats, seed: int) -> Floats:
    """The strokes in an order drawn from the chances of the succession."""
    outlines, rng = Outlines.of(paths), np.random.default_rng(seed)
    order, left = [0], np.arange(1, len(paths))
    while len(left):
        jumps = outlines.jumps(np.array(2 * order[-1]), 2 * left)
        near = left[np.argsort(jumps)[:50]]
        values = outlines.numbers(np.full(len(near), 2 * order[-1]), 2 * near) @ succession.weights
        order.append(int(near[np.argmax(values + rng.gumbel(size=len(near)))]))
        left = left[left != order[-1]]
    return paths[order]


def test_the_succession_that_strokes_were_drawn_by_is_found_again() -> None:
    by = Succession(jump=-1.0, distance=-0.8, along=0.7, parallel=1.0, same_way=0.8, unlike=-1.2)
    found = succession_of(drawn_by_chance(by, scattered(400, seed=0), seed=0))
    assert found.weights == pytest.approx(by.weights, abs=FOUND)


def test_who_draws_all_level_strokes_before_the_upright_ones_across_them_goes_on_parallel() -> None:
    rng = np.random.default_rng(0)
    at = rng.uniform(0, 6, (60, 2))
    level, upright = (np.array([line(tuple(xy), tuple(xy + to)) for xy in at]) for to in ((1.0, 0.0), (0.0, 1.0)))
    both = np.concatenate([level, upright])
    assert succession_of(both).parallel > 0.5
    assert abs(succession_of(rng.permutation(both)).parallel) < 0.2


def test_who_hatches_goes_on_near() -> None:
    assert succession_of(hatching(12, seed=0)).distance < -1


def test_who_draws_rows_of_dashes_goes_on_end_to_end_and_who_draws_columns_side_by_side() -> None:
    dashes = np.array([[line((1.3 * i, 1.3 * k), (1.3 * i + 1, 1.3 * k)) for i in range(8)] for k in range(8)])
    rows, columns = (each.reshape(64, 32, 2) for each in (dashes, dashes.swapaxes(0, 1)))
    assert succession_of(rows).along > 0.5
    assert succession_of(columns).along < -0.5


def test_a_drawing_that_is_half_as_large_and_turned_has_the_same_succession() -> None:
    drawn = hatching(6, seed=0)
    turned = 0.5 * drawn @ np.array([[0.6, 0.8], [-0.8, 0.6]])
    assert succession_of(turned).weights == pytest.approx(succession_of(drawn).weights, abs=1e3 * ALIKE)


def test_strokes_that_all_follow_alike_teach_no_endless_weights() -> None:
    ladder = np.array([line((0, 0.1 * i), (1, 0.1 * i)) for i in range(30)])
    assert np.isfinite(succession_of(ladder).weights).all()
