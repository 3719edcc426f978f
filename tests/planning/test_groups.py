import numpy as np
import pytest

from maulstick.planning import groups
from maulstick.planning.directions import directions
from maulstick.planning.groups import choose_groups, place_groups, without
from maulstick.planning.placement import Places
from maulstick.planning.tracing import lay_along
from maulstick.storage.arrays import Floats, Ints
from maulstick.style.arrangement import Arrangement
from maulstick.style.hand import Hand
from tests.support.drawn import as_strokes, hatching

SIZE = (60, 90)  # pixels
SCALE = 500.0  # pixels per metre: a patch of 20 mm strokes is 10 pixels


def arranged() -> Arrangement:
    arrangement = Hand.of(as_strokes(hatching(6, seed=0))).arrangement
    assert arrangement is not None
    return arrangement


def placed(
    count: int = 96, density: Floats | None = None, target: Floats | None = None, seed: int = 0
) -> tuple[Places, Ints]:
    density = np.ones(SIZE) if density is None else density
    target = np.ones((3, *SIZE)) if target is None else target
    room = (SIZE[0] * SIZE[1] / count) ** 0.5
    lines = directions(target, room, arranged().leaning)
    rng = np.random.default_rng(seed)
    chosen = choose_groups(arranged(), count, rng)
    return place_groups(target, lines, density, arranged(), chosen, room, SCALE, rng)


def test_every_group_lies_as_the_hand_drew_it() -> None:
    (places, rows), arrangement = placed(), arranged()
    each = {group[0]: group for group in arrangement.groups}
    first = 0
    while first < len(rows):
        mine = slice(first, first + len(each[rows[first]]))
        assert rows[mine].tolist() == each[rows[first]].tolist()
        turns = places.angles[mine] - arrangement.angles[rows[mine]]
        assert turns == pytest.approx(turns[0])
        drawn = SCALE * arrangement.paths[rows[mine]].mean(axis=1)
        apart = [np.linalg.norm(where[:, None] - where, axis=-1) for where in (drawn, places.centres[mine])]
        assert apart[0] == pytest.approx(apart[1])
        first = mine.stop


def test_all_groups_are_used_before_one_is_used_again() -> None:
    uses = np.bincount(placed(96)[1], minlength=48)
    assert uses.tolist() == [2] * 48


@pytest.mark.parametrize("count", [1, 5, 8, 50, 301])
def test_any_number_of_strokes_is_placed(count: int) -> None:
    places, rows = placed(count)
    assert len(rows) == len(places.centres) == len(places.colours) == count


def test_groups_lie_where_ink_is_wanted() -> None:
    density = np.zeros(SIZE)
    density[:, :30] = 1
    assert (placed(48, density)[0].centres[:, 0] < 35).mean() > 0.95


def test_fewer_strokes_lie_where_no_ink_is_wanted_than_if_that_cost_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    rows, columns = np.indices(SIZE) // 18
    density = ((rows + columns) % 2 == 0).astype(float)

    def astray() -> float:
        x, y = placed(384, density)[0].centres.astype(int).T
        return float((density[y.clip(0, SIZE[0] - 1), x.clip(0, SIZE[1] - 1)] == 0).mean())

    usual = astray()
    monkeypatch.setattr(groups, "_MISPLACED", 0.0)
    assert usual < 0.8 * astray()


def test_three_times_the_ink_has_about_three_times_the_strokes() -> None:
    density = np.ones(SIZE)
    density[:, 45:] = 3
    dark = (placed(192, density)[0].centres[:, 0] > 45).mean()
    assert dark == pytest.approx(0.75, abs=0.06)


def test_an_empty_density_is_an_even_one() -> None:
    left = (placed(density=np.zeros(SIZE))[0].centres[:, 0] < 45).mean()
    assert left == pytest.approx(0.5, abs=0.12)


@pytest.mark.parametrize("angle", [0.0, 0.6, 1.5])
def test_groups_follow_the_stripes_of_a_picture(angle: float) -> None:
    y, x = np.mgrid[: SIZE[0], : SIZE[1]]
    stripes = np.tile(0.5 + 0.5 * np.sin((y * np.cos(angle) - x * np.sin(angle)) * 0.8), (3, 1, 1))
    off = placed(target=stripes)[0].angles - angle
    assert (np.cos(2 * off) > 0.9).mean() > 0.8


def test_where_there_is_no_edge_groups_keep_the_direction_of_the_hand() -> None:
    places, rows = placed()
    assert places.angles == pytest.approx(arranged().angles[rows], abs=1e-3)


def test_no_group_is_turned_by_more_than_a_quarter_so_that_it_is_drawn_the_hands_way() -> None:
    upright = np.tile(np.arange(SIZE[1]) // 3 % 2 * 1.0, (3, SIZE[0], 1))
    places, rows = placed(target=upright)
    turns = places.angles - arranged().angles[rows]
    assert np.abs(turns).max() <= np.pi / 2 + 1e-9
    assert np.abs(turns).max() > 0.5


def test_a_seed_repeats_the_groups_to_the_bit_and_another_seed_does_not() -> None:
    one, same, other = (placed(seed=seed)[0].centres for seed in (1, 1, 2))
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)


def test_a_group_loses_the_strokes_that_lie_elsewhere_as_often_as_they_do() -> None:
    chosen = [np.array([4, 5, 6]), np.array([7]), np.array([4, 5, 6]), np.array([4, 5, 6])]
    left = without(chosen, np.array([5, 7, 5, 4]))
    assert [rows.tolist() for rows in left] == [[6], [4, 6], [4, 5, 6]]
    assert [rows.tolist() for rows in without(chosen, np.array([], dtype=np.int64))] == [
        rows.tolist() for rows in chosen
    ]


def test_groups_fill_what_strokes_along_lines_leave_blank() -> None:
    paths, upright = SCALE * arranged().paths, np.stack([np.full(60, 20.0), np.arange(60.0)], axis=1)
    chosen = choose_groups(arranged(), 96, np.random.default_rng(0))
    along = lay_along([upright + np.array([step, 0]) for step in range(-15, 16, 3)], paths, np.full(len(paths), 2))
    rest = without(chosen, along.rows)
    places, rows = place_groups(
        np.ones((3, *SIZE)), np.zeros(SIZE, dtype=complex), np.ones(SIZE), arranged(), rest, 7.5, SCALE,
        np.random.default_rng(0), along,
    )  # fmt: skip
    first = len(along.rows)
    assert first > 30
    assert sorted(rows.tolist()) == sorted(np.concatenate(chosen).tolist())
    assert places.centres[:first] == pytest.approx(along.paths.mean(axis=1))
    assert places.angles[:first] == pytest.approx(arranged().angles[along.rows] + along.turns)
    assert (places.centres[first:, 0] > 40).mean() > 0.8
