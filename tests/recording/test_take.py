from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from maulstick.errors import InputError
from maulstick.recording.mocap.motive import read_motive
from maulstick.recording.mocap.take import Take, is_unit, read_take, write_take
from maulstick.storage.arrays import write_arrays


@pytest.fixture
def take() -> Take:
    rng = np.random.default_rng(0)
    positions, rotations, pen, canvas = (rng.normal(size=(9, *shape)) for shape in ((3,), (4,), (2, 3), (3, 3)))
    positions[3:5] = rotations[3:5] = np.nan
    return Take(np.arange(9) / 240, positions, rotations / np.linalg.norm(rotations, axis=1)[:, None], pen, canvas)


def test_a_take_is_the_same_after_writing_and_reading_it(take: Take, tmp_path: Path) -> None:
    write_take(take, tmp_path / "a.take.npz")
    for read in (read_take, read_motive):
        for name, values in vars(read(tmp_path / "a.take.npz")).items():
            np.testing.assert_array_equal(values, vars(take)[name])


RISE = "the times of a take must rise from frame to frame"
UNIT = "a quaternion of a take is not of length 1; it must be, or NaN where it was not seen"
FAULTS = [
    ("times", np.zeros(9), RISE),
    ("times", np.arange(9) * -1.0, RISE),
    ("times", np.full(9, np.nan), RISE),
    ("times", np.float64(1), "the times of a take have shape (); it must be (1,)"),
    ("pen_positions", np.zeros((9, 2)), "the pen_positions of a take have shape (9, 2); it must be (9, 3)"),
    ("pen_rotations", np.zeros((9, 3)), "the pen_rotations of a take have shape (9, 3); it must be (9, 4)"),
    ("pen_rotations", np.zeros((9, 4)), UNIT),
    ("pen_rotations", np.full((9, 4), 0.51), UNIT),
    ("pen_markers", np.zeros((9, 2, 2)), "the pen_markers of a take have shape (9, 2, 2); it must be (9, 2, 3)"),
    ("pen_markers", np.zeros(9), "the pen_markers of a take have shape (9,); it must be (9, 3)"),
    ("canvas_markers", np.zeros((8, 3, 3)), "the canvas_markers of a take have shape (8, 3, 3); it must be (9, 3, 3)"),
]


@pytest.mark.parametrize(("name", "values", "text"), FAULTS)
def test_a_take_with_a_fault_is_none(take: Take, name: str, values: np.ndarray, text: str) -> None:
    with pytest.raises(InputError) as caught:
        replace(take, **{name: np.asarray(values)})
    assert str(caught.value) == text


@pytest.mark.parametrize(
    ("name", "values", "text"),
    [*FAULTS[:1], ("pen_positions", np.full((9, 3), "a"), "could not convert string to float: ")],
)
def test_a_file_with_a_fault_is_no_take(take: Take, tmp_path: Path, name: str, values: np.ndarray, text: str) -> None:
    path = tmp_path / "a.take.npz"
    write_arrays(path, "take", {**vars(take), name: values})
    with pytest.raises(InputError) as caught:
        read_take(path)
    assert str(caught.value).startswith(f"{path} is not a file of take: {text}")


def test_a_long_pause_between_frames_becomes_one_that_shows_nothing(take: Take) -> None:
    frames = len(take)
    late = replace(take, times=take.times + np.where(np.arange(frames) < 2, 0.0, 1.0))
    whole = late.interrupted(0.5)
    assert len(whole) == frames + 1
    assert late.times[1] < whole.times[2] < late.times[2]
    assert all(np.isnan(values[2]).all() for name, values in vars(whole).items() if name != "times")
    for name, values in vars(late).items():
        assert np.array_equal(np.delete(getattr(whole, name), 2, axis=0), values, equal_nan=True)
    assert len(take.interrupted(0.5)) == frames


def test_a_take_has_a_frame_at_least(take: Take) -> None:
    with pytest.raises(InputError, match=RISE):
        Take(*(values[:0] for values in vars(take).values()))


def test_a_quaternion_of_length_1_is_one_within_a_hundredth() -> None:
    lengths = np.array([0.98, 0.995, 1.0, 1.005, 1.02, np.nan, np.inf, 1e200])
    assert is_unit(lengths[:, None] * 0.5 * np.ones(4)).tolist() == [False, True, True, True] + [False] * 4


def test_a_file_of_another_kind_is_no_take(take: Take, tmp_path: Path) -> None:
    write_arrays(tmp_path / "ink.npz", "ink", vars(take))
    with pytest.raises(InputError, match="holds ink; it must be a file of take"):
        read_take(tmp_path / "ink.npz")
