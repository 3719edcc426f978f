import numpy as np
import pytest

from maulstick.planning.directions import directions
from maulstick.storage.arrays import Floats

SIZE = (80, 120)  # pixels
LEVEL, LEANING = 1 + 0j, 0.5 * np.exp(2j * 0.7)


def striped(angle: float, over: slice = slice(None)) -> Floats:
    """A grey picture with stripes at this angle in some of its columns."""
    y, x = np.mgrid[: SIZE[0], : SIZE[1]]
    stripes = 0.5 + 0.5 * np.sin((y * np.cos(angle) - x * np.sin(angle)) * 0.8)
    picture = np.full(SIZE, 0.5)
    picture[:, over] = stripes[:, over]
    return np.tile(picture, (3, 1, 1))


@pytest.mark.parametrize("angle", [0.0, 0.6, 1.5, 2.4])
def test_lines_follow_the_stripes_of_a_picture_and_are_sure_of_it(angle: float) -> None:
    found = directions(striped(angle), 6.0, LEANING)[10:-10, 10:-10]
    assert (found * np.exp(-2j * angle)).real.min() > 0.8


def test_a_flat_place_goes_with_the_edge_beside_it() -> None:
    halves = np.tile((np.arange(SIZE[1]) > 60).astype(float), (3, SIZE[0], 1))
    found = directions(halves, 6.0, LEVEL)
    assert found[30:50, 66:76].real.max() < -0.5
    assert found[30:50, 115:].real.min() > 0.5


def test_far_from_every_edge_lines_lean_as_the_hand_does() -> None:
    far = directions(striped(1.5, slice(8)), 3.0, LEANING)[20:60, 90:]
    assert far / np.abs(far) == pytest.approx(np.full(far.shape, np.exp(2j * 0.7)), abs=0.05)


def test_a_hand_that_leans_no_way_leaves_a_flat_place_without_a_direction() -> None:
    far = directions(striped(1.5, slice(8)), 3.0, 0j)[20:60, 90:]
    assert np.abs(far).max() < 0.05


def test_a_picture_without_any_edge_has_no_direction() -> None:
    assert np.abs(directions(np.full((3, *SIZE), 0.7), 6.0, LEANING)).max() == pytest.approx(0)


@pytest.mark.parametrize("size", [(1, 1), (1, 9), (7, 3), (65, 2)])
def test_a_picture_of_any_size_has_directions_no_surer_than_one(size: tuple[int, int]) -> None:
    found = directions(np.random.default_rng(0).random((3, *size)), 5.0, LEVEL)
    assert found.shape == size
    assert np.isfinite(found).all()
    assert np.abs(found).max() <= 1 + 1e-9
