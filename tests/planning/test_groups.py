import numpy as np
import pytest
import torch

from maulstick.planning.groups import Placed, least_groups, place_groups
from maulstick.storage.arrays import Floats
from maulstick.style.arrangement import Arrangement
from maulstick.style.hand import Hand
from tests.support.drawn import as_strokes, hatching

SIZE = (60, 90)  # pixels
SCALE = 500.0  # pixels per metre: a patch of 20 mm strokes is 10 pixels


def arranged() -> Arrangement:
    arrangement = Hand.of(as_strokes(hatching(6, seed=0))).arrangement
    assert arrangement is not None
    return arrangement


def placed(count: int = 96, density: Floats | None = None, target: Floats | None = None, seed: int = 0) -> Placed:
    density = np.ones(SIZE) if density is None else density
    target = np.ones((3, *SIZE)) if target is None else target
    room = (SIZE[0] * SIZE[1] / count) ** 0.5
    return place_groups(target, density, count, arranged(), room, SCALE, np.random.default_rng(seed))


def test_every_group_lies_as_the_hand_drew_it() -> None:
    found, arrangement = placed(), arranged()
    for group in np.unique(found.groups):
        mine = np.flatnonzero(found.groups == group)
        assert any(np.array_equal(found.rows[mine], rows) for rows in arrangement.groups)
        turns = found.places.angles[mine] - arrangement.angles[found.rows[mine]]
        assert turns == pytest.approx(turns[0])
        drawn = SCALE * arrangement.paths[found.rows[mine]].mean(axis=1)
        apart = [np.linalg.norm(each[:, None] - each, axis=-1) for each in (drawn, found.places.centres[mine])]
        assert apart[0] == pytest.approx(apart[1])


def test_all_groups_are_used_before_one_is_used_again() -> None:
    uses = np.bincount(placed(96).rows, minlength=48)
    assert uses.tolist() == [2] * 48


@pytest.mark.parametrize("count", [1, 5, 8, 50, 301])
def test_any_number_of_strokes_is_placed(count: int) -> None:
    found = placed(count)
    assert len(found.rows) == len(found.groups) == len(found.places.centres) == len(found.places.colours) == count
    assert np.bincount(found.groups).min() >= 1


def test_groups_lie_where_ink_is_wanted() -> None:
    density = np.zeros(SIZE)
    density[:, :30] = 1
    assert (placed(48, density).places.centres[:, 0] < 35).mean() > 0.95


def test_three_times_the_ink_has_about_three_times_the_strokes() -> None:
    density = np.ones(SIZE)
    density[:, 45:] = 3
    dark = (placed(192, density).places.centres[:, 0] > 45).mean()
    assert dark == pytest.approx(0.75, abs=0.06)


def test_an_empty_density_is_an_even_one() -> None:
    left = (placed(density=np.zeros(SIZE)).places.centres[:, 0] < 45).mean()
    assert left == pytest.approx(0.5, abs=0.12)


@pytest.mark.parametrize("angle", [0.0, 0.6, 1.5])
def test_groups_follow_the_stripes_of_a_picture(angle: float) -> None:
    y, x = np.mgrid[: SIZE[0], : SIZE[1]]
    stripes = np.tile(0.5 + 0.5 * np.sin((y * np.cos(angle) - x * np.sin(angle)) * 0.8), (3, 1, 1))
    off = placed(target=stripes).places.angles - angle
    assert (np.cos(2 * off) > 0.9).mean() > 0.8


def test_where_there_is_no_edge_groups_keep_the_direction_of_the_hand() -> None:
    found, arrangement = placed(), arranged()
    assert found.places.angles == pytest.approx(arrangement.angles[found.rows], abs=1e-3)


def test_no_group_is_turned_by_more_than_a_quarter_so_that_it_is_drawn_the_hands_way() -> None:
    upright = np.tile(np.arange(SIZE[1]) // 3 % 2 * 1.0, (3, SIZE[0], 1))
    found = placed(target=upright)
    turns = found.places.angles - arranged().angles[found.rows]
    assert np.abs(turns).max() <= np.pi / 2 + 1e-9
    assert np.abs(turns).max() > 0.5


def test_a_seed_repeats_the_groups_to_the_bit_and_another_seed_does_not() -> None:
    one, same, other = placed(seed=1), placed(seed=1), placed(seed=2)
    assert np.array_equal(one.places.centres, same.places.centres)
    assert not np.array_equal(one.places.centres, other.places.centres)


def test_whole_groups_that_are_missed_least_on_average_move() -> None:
    groups = torch.tensor([4, 4, 7, 9, 9, 9])
    costs = torch.tensor([0.0, 4.0, 1.0, 3.0, 3.0, 3.0])
    assert least_groups(costs, groups, 1).tolist() == [2]
    assert least_groups(costs, groups, 2).tolist() == [0, 1, 2]
    assert least_groups(costs, groups, 4).tolist() == [0, 1, 2, 3, 4, 5]
