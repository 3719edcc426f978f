import numpy as np
import pytest

from maulstick.storage.arrays import Floats
from maulstick.style.arrangement import Arrangement
from maulstick.style.arrangement.words import told
from maulstick.style.hand import Hand
from tests.support.drawn import as_strokes, hatching, line


def words(paths: Floats) -> str:
    arrangement = Hand.of(as_strokes(paths)).arrangement
    assert isinstance(arrangement, Arrangement)
    return told(arrangement)


def strokes(direction: float, count: int = 40, lengths: Floats | None = None) -> Floats:
    """Strokes 5 mm apart beside each other, 20 mm long, in a direction: radians, y down."""
    along, across = np.array([np.cos(direction), np.sin(direction)]), np.array([-np.sin(direction), np.cos(direction)])
    long = np.full(count, 0.02) if lengths is None else lengths
    starts = [0.005 * i * across for i in range(count)]
    return np.array([line(tuple(at), tuple(at + length * along)) for at, length in zip(starts, long, strict=True)])


@pytest.mark.parametrize(
    ("direction", "way"),
    [(0.0, "level"), (np.pi / 2, "upright"), (-np.pi / 4, "leaning right"), (np.pi / 4, "leaning left")],
)
def test_hatching_is_told_by_its_groups_direction_and_spacing(direction: float, way: str) -> None:
    assert words(strokes(direction)) == f"groups of 10 or more, parallel, {way}, 5.0 mm apart; cross rarely"


def test_the_spacing_of_fine_hatching_is_not_told_as_none() -> None:
    assert ", 0.04 mm apart" in words(0.008 * strokes(0.0, lengths=np.full(40, 0.2)))


@pytest.mark.parametrize(("apart", "said"), [(0.002, "2.0 mm"), (0.0005, "0.5 mm"), (0.0001, "0.1 mm")])
def test_the_spacing_of_long_strokes_is_told_as_it_is(apart: float, said: str) -> None:
    scale = apart / 0.005
    assert f", {said} apart" in words(scale * strokes(0.0, lengths=np.full(40, 0.15 / scale)))


def test_strokes_that_lie_on_one_another_are_not_apart() -> None:
    assert ", 0 mm apart" in words(strokes(0.0)[:1].repeat(30, axis=0))


def test_a_grid_goes_all_ways_and_crosses_often() -> None:
    grid = np.concatenate(
        [strokes(0.0, 20, np.full(20, 0.1)), np.array([0.1, 0.0]) + strokes(np.pi / 2, 20, np.full(20, 0.1))]
    )
    said = words(grid)
    assert "cross often" in said
    assert "level" not in said
    assert "upright" not in said


@pytest.mark.parametrize(
    ("steps", "said"),
    [
        ((0.7, 0.7), "; lap along a line"),
        ((1.0, 1.0), "; meet along a line"),
        ((1.3, 1.3), "; leave gaps along a line"),
        ((0.7, 1.3), "; lap here and leave gaps there along a line"),
    ],
)
def test_strokes_that_make_one_line_are_told_by_how_they_meet(steps: tuple[float, float], said: str) -> None:
    starts = np.insert(np.cumsum(np.tile(steps, 3)), 0, 0)
    along = 0.02 * (starts[:, None] + np.linspace(0, 1, 32))
    assert words(
        np.concatenate([np.stack([along, np.full_like(along, 0.04 * row)], axis=-1) for row in range(10)])
    ).endswith(said)


def test_nothing_is_told_of_lines_where_few_strokes_go_on_from_each_other() -> None:
    few = np.array([line((0.2, 0.0), (0.22, 0.0)), line((0.215, 0.0), (0.24, 0.0))])
    assert "line" not in words(np.concatenate([strokes(0.0), few]))


@pytest.mark.parametrize(("order", "said"), [(-1, "; long strokes first"), (1, "; short strokes first")])
def test_lengths_in_order_are_told(order: int, said: str) -> None:
    assert words(strokes(0.0, lengths=np.linspace(0.01, 0.03, 40)[::order])).endswith(said)


def test_patches_in_all_directions_lean_nowhere() -> None:
    assert "lean" not in words(hatching(12, seed=3))
