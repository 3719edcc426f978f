from pathlib import Path

import numpy as np
import pytest

from maulstick.arrays import write_arrays
from maulstick.errors import InputError
from maulstick.recording.motive import read_motive
from maulstick.recording.take import Take
from maulstick.recording.take_file import read_take, write_take


@pytest.fixture
def take() -> Take:
    chance = np.random.default_rng(0)
    shapes = [(9, 3), (9, 4), (9, 2, 3), (9, 3, 3)]
    take = Take(np.arange(9) / 240, *(chance.uniform(-1, 1, shape) for shape in shapes))
    take.pen_positions[3:5] = np.nan
    return take


def test_a_take_is_the_same_after_writing_and_reading_it(take: Take, tmp_path: Path) -> None:
    write_take(take, tmp_path / "a.take.npz")
    for read in (read_take, read_motive):
        for name, values in vars(read(tmp_path / "a.take.npz")).items():
            np.testing.assert_array_equal(values, vars(take)[name])


@pytest.mark.parametrize(
    ("name", "values", "text"),
    [
        ("times", np.zeros(9), "its times do not rise from frame to frame"),
        ("times", np.float64(1), "its times have shape ()"),
        ("times", np.full(9, np.nan), "its times do not rise from frame to frame"),
        ("pen_rotations", np.zeros((9, 3)), "its pen_rotations have shape (9, 3)"),
        ("canvas_markers", np.zeros((8, 3, 3)), "its canvas_markers have shape (8, 3, 3)"),
        ("pen_markers", np.zeros((9, 2, 2)), "its pen_markers have shape (9, 2, 2)"),
        ("pen_positions", np.full((9, 3), "a"), "its pen_positions are not float64"),
    ],
)
def test_a_file_with_a_fault_is_no_take(take: Take, tmp_path: Path, name: str, values: np.ndarray, text: str) -> None:
    path = tmp_path / "a.take.npz"
    write_arrays(path, "take", {**vars(take), name: np.asarray(values)})
    with pytest.raises(InputError) as caught:
        read_take(path)
    assert str(caught.value) == f"{path} is not a file of take: {text}"


def test_a_file_of_another_kind_is_no_take(take: Take, tmp_path: Path) -> None:
    write_arrays(tmp_path / "ink.npz", "ink", vars(take))
    with pytest.raises(InputError, match="holds ink; it must be a file of take"):
        read_take(tmp_path / "ink.npz")
