import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from maulstick.errors import InputError
from maulstick.strokes import POINTS, Floats, path_lengths, place, resample, standardise
from tests.tolerances import FLOAT64_METRES

metres = st.floats(-1, 1, allow_subnormal=False)
polylines = st.integers(1, 12).flatmap(lambda m: arrays(np.float64, (m, 3), elements=metres))
stacks = st.tuples(st.integers(1, 4), st.integers(2, 9)).flatmap(
    lambda shape: arrays(np.float64, (*shape, 2), elements=metres)
)
poses_of_four = arrays(np.float64, (4, 3), elements=st.floats(-4, 4))


def along(path: Floats) -> Floats:
    """Distance from the start, (m,), at each point of a path (m, 2 or more)."""
    lengths = np.linalg.norm(path[1:, :2] - path[:-1, :2], axis=1)
    return np.array([lengths[:i].sum() for i in range(len(path))])


@given(polylines, st.integers(2, 40))
def test_a_resampled_path_keeps_its_ends_and_has_points_at_equal_distances_along_it(path: Floats, n: int) -> None:
    path[:, 2] = along(path)
    assume(path[-1, 2] > 1e-6)
    before = path.copy()
    resampled = resample(path, n)
    assert resampled.shape == (n, 3)
    assert np.array_equal(resampled[[0, -1], :2], path[[0, -1], :2])
    assert resampled[:, 2] == pytest.approx(np.linspace(0, path[-1, 2], n), abs=FLOAT64_METRES)
    assert np.array_equal(path, before), "an argument was changed"


@given(polylines)
def test_resampled_points_lie_on_the_path(path: Floats) -> None:
    u, v = path[:-1, :2], path[1:, :2]
    for point in resample(path, 9)[:, :2]:
        if len(path) == 1:
            assert np.array_equal(point, path[0, :2])
            continue
        squared = ((v - u) ** 2).sum(1)
        t = np.clip(((point - u) * (v - u)).sum(1) / np.where(squared > 0, squared, 1), 0, 1)
        assert np.linalg.norm(u + t[:, None] * (v - u) - point, axis=1).min() <= 1e-9


def test_resampling_a_straight_path_gives_equal_steps_and_carries_press_along() -> None:
    path = np.array([[0.0, 0.0, 0.0], [0.003, 0.004, 0.1], [0.06, 0.08, 1.0]])
    resampled = resample(path)
    assert len(resampled) == POINTS == 32
    assert np.linalg.norm(np.diff(resampled[:, :2], axis=0), axis=1) == pytest.approx(0.1 / 31, rel=1e-12)
    assert np.interp(0.05, along(resampled), resampled[:, 2]) == pytest.approx(0.1 + 0.9 * 0.045 / 0.095, rel=1e-12)


@pytest.mark.parametrize("points", [1, 5])
def test_a_path_without_length_becomes_its_first_point_many_times(points: int) -> None:
    path = np.tile([[0.2, 0.3]], (points, 1))
    assert np.array_equal(resample(path, 4), np.tile([[0.2, 0.3]], (4, 1)))


def test_a_pause_within_a_path_does_not_stop_its_resampling() -> None:
    path = np.array([[0.0, 0.0], [0.1, 0.0], [0.1, 0.0], [0.1, 0.0], [0.2, 0.0]])
    assert resample(path, 5)[:, 0] == pytest.approx([0, 0.05, 0.1, 0.15, 0.2], abs=FLOAT64_METRES)


@pytest.mark.parametrize("shape", [(0, 2), (5,), (4, 1), (2, 3, 2)])
def test_what_is_no_path_is_refused_by_its_shape(shape: tuple[int, ...]) -> None:
    with pytest.raises(InputError) as caught:
        resample(np.zeros(shape))
    assert str(caught.value) == f"a path has shape {shape}; it must be (m, 2 or more) with m of at least 1"


def is_open(paths: Floats) -> Floats:
    return np.linalg.norm(paths[:, -1] - paths[:, 0], axis=1) >= 0.02 * path_lengths(paths)


@given(stacks.filter(lambda paths: is_open(paths).all()))
def test_a_standardised_path_starts_at_the_origin_and_ends_on_the_positive_x_axis(paths: Floats) -> None:
    standard, poses = standardise(paths)
    assert poses.shape == (len(paths), 3)
    assert np.array_equal(standard[:, 0], np.zeros((len(paths), 2)))
    assert standard[:, -1, 1] == pytest.approx(0, abs=FLOAT64_METRES)
    chord = np.linalg.norm(paths[:, -1] - paths[:, 0], axis=1)
    assert standard[:, -1, 0] == pytest.approx(chord, abs=FLOAT64_METRES)
    assert (standard[:, -1, 0] >= 0).all()


@given(stacks)
def test_standardising_and_placing_is_a_round_trip(paths: Floats) -> None:
    before = paths.copy()
    assert place(*standardise(paths)) == pytest.approx(paths, abs=FLOAT64_METRES)
    assert np.array_equal(paths, before), "an argument was changed"


@given(stacks)
def test_standardising_keeps_every_distance(paths: Floats) -> None:
    standard, _ = standardise(paths)
    for a, b in ((0, -1), (0, 1), (-1, 1)):
        expected = np.linalg.norm(paths[:, a] - paths[:, b], axis=1)
        assert np.linalg.norm(standard[:, a] - standard[:, b], axis=1) == pytest.approx(expected, abs=FLOAT64_METRES)


@given(stacks.filter(lambda paths: np.linalg.norm(paths[:, -1] - paths[:, 0], axis=1).min() > 1e-3), poses_of_four)
def test_placing_and_standardising_is_a_round_trip(paths: Floats, poses: Floats) -> None:
    standard, _ = standardise(paths)
    poses = poses[: len(paths)]
    again, found = standardise(place(standard, poses))
    assert again == pytest.approx(standard, abs=1e-11), "an angle is known less well over a chord of a millimetre"
    assert found[:, :2] == pytest.approx(poses[:, :2], abs=FLOAT64_METRES)
    assert np.cos(found[:, 2] - poses[:, 2]) == pytest.approx(1, abs=1e-12)


@given(stacks)
def test_a_closed_stroke_has_the_mean_of_its_points_on_the_positive_x_axis(paths: Floats) -> None:
    paths[:, -1] = paths[:, 0]
    standard, _ = standardise(paths)
    mean = standard.mean(axis=1)
    assert mean[:, 1] == pytest.approx(0, abs=FLOAT64_METRES)
    assert (mean[:, 0] >= -FLOAT64_METRES).all()


def test_placing_turns_from_x_towards_y_and_then_moves() -> None:
    path = np.array([[[0.0, 0.0], [0.02, 0.01]]])
    placed = place(path, np.array([[0.1, 0.2, np.pi / 2]]))
    assert placed == pytest.approx(np.array([[[0.1, 0.2], [0.09, 0.22]]]), abs=FLOAT64_METRES)
