from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from maulstick.errors import InputError, OutputError
from maulstick.storage.arrays import write_arrays
from maulstick.strokes.ink import Ink
from maulstick.strokes.strokes import (
    POINTS,
    Floats,
    Strokes,
    path_lengths,
    place,
    read_strokes,
    resample,
    standardise,
    write_strokes,
)
from tests.support.tolerances import FLOAT64_METRES

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


def test_resampling_a_straight_path_gives_equal_steps_and_carries_pressure_along() -> None:
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


samples = st.integers(1, 9).flatmap(
    lambda m: arrays(np.float64, (m, 4), elements=st.floats(0, 1, allow_subnormal=False))
)


def as_recorded(stroke: Floats) -> Floats:
    """A stroke with rising times."""
    return np.column_stack([np.sort(stroke[:, 0]), stroke[:, 1:]])


inks = st.lists(samples.map(as_recorded), max_size=5).map(lambda strokes: Ink.of(strokes, (1.0, 1.0)))


@settings(max_examples=60)
@given(inks, st.integers(2, 40))
def test_placed_strokes_are_the_resampled_ink(ink: Ink, n: int) -> None:
    strokes = Strokes.of(ink, n)
    assert len(strokes) == len(ink)
    assert strokes.placed().shape == (len(ink), n, 3)
    for stroke, placed, times in zip(ink.strokes(), strokes.placed(), strokes.times, strict=True):
        assert placed == pytest.approx(resample(stroke[:, 1:], n), abs=FLOAT64_METRES)
        assert times == pytest.approx(resample(stroke[:, [1, 2, 0]], n)[:, 2] - stroke[0, 0], abs=1e-12)


@given(inks)
def test_times_of_a_stroke_begin_at_zero_and_never_fall(ink: Ink) -> None:
    times = Strokes.of(ink).times
    assert np.array_equal(times[:, 0], np.zeros(len(ink)))
    assert (np.diff(times, axis=1) >= 0).all()


@given(inks)
def test_the_length_of_a_stroke_is_no_more_than_that_of_its_ink(ink: Ink) -> None:
    lengths = np.array([along(stroke[:, 1:])[-1] for stroke in ink.strokes()])
    strokes = Strokes.of(ink)
    assert (strokes.lengths <= lengths + 1e-12).all()
    assert strokes.lengths == pytest.approx(path_lengths(strokes.placed()[..., :2]), abs=1e-12)


def test_what_was_not_recorded_stays_unknown() -> None:
    stroke = np.array([[np.nan, 0.1, 0.1, np.nan], [np.nan, 0.2, 0.1, np.nan]])
    pressed = np.array([[3.0, 0.1, 0.1, 0.25], [4.0, 0.2, 0.1, 0.75]])
    strokes = Strokes.of(Ink.of([stroke, pressed], (1, 1)), 3)
    assert np.isnan(strokes.times[0]).all()
    assert np.isnan(strokes.trajectories[0, :, 2]).all()
    assert strokes.times[1] == pytest.approx([0, 0.5, 1])
    assert strokes.trajectories[1, :, 2] == pytest.approx([0.25, 0.5, 0.75])


def test_a_dot_becomes_a_stroke_without_length_at_its_place() -> None:
    strokes = Strokes.of(Ink.of([np.array([[7.0, 0.1, 0.2, 0.5]])], (1, 1)))
    assert np.array_equal(strokes.trajectories, np.tile([0, 0, 0.5], (1, POINTS, 1)))
    assert strokes.poses.tolist() == [[0.1, 0.2, 0.0]]
    assert strokes.lengths.tolist() == [0.0]
    assert np.array_equal(strokes.placed()[0], np.tile([0.1, 0.2, 0.5], (POINTS, 1)))


@pytest.mark.parametrize(("gap", "closed"), [(0.0, True), (0.019, True), (0.021, False)])
def test_a_stroke_whose_ends_nearly_meet_lies_with_its_mean_to_the_right(gap: float, closed: bool) -> None:
    angles = np.linspace(0, 2 * np.pi, 2001)
    ring = np.column_stack([np.cos(angles), np.sin(angles)]) * 0.01  # starts at the right, so its mean is to the left
    ring[:, 0] += np.linspace(0, gap * 2 * np.pi * 0.01, len(angles))
    samples = np.pad(ring, ((0, 0), (1, 1)), constant_values=np.nan)
    (standard,) = Strokes.of(Ink.of([samples], (1, 1)), 400).trajectories[..., :2]
    mean, end = standard.mean(axis=0), standard[-1]
    assert (abs(mean[1]) < 1e-12 < mean[0]) == closed
    assert closed or (abs(end[1]) < 1e-12 < end[0])


def test_no_ink_gives_no_strokes(tmp_path: Path) -> None:
    strokes = Strokes.of(Ink.of([], (1, 1)), 8)
    assert (len(strokes), strokes.trajectories.shape, strokes.times.shape) == (0, (0, 8, 3), (0, 8))
    assert strokes.placed().shape == (0, 8, 3)
    write_strokes(strokes, tmp_path / "none.strokes.npz")
    assert len(read_strokes(tmp_path / "none.strokes.npz")) == 0


def test_some_strokes_are_taken_by_number_mask_or_slice() -> None:
    lines = [np.array([[0, 0, 0, 0], [1, length, 0, 1]]) for length in (0.1, 0.2, 0.3)]
    strokes = Strokes.of(Ink.of(lines, (1, 1)))
    for rows in (np.array([2, 0]), np.array([True, False, True]), slice(None, None, 2)):
        assert sorted(strokes[rows].lengths) == pytest.approx([0.1, 0.3])
    assert strokes[np.array([2, 0])].lengths == pytest.approx([0.3, 0.1])


@settings(max_examples=40, deadline=None)
@given(inks)
def test_strokes_are_equal_to_those_in_their_file(tmp_path_factory: pytest.TempPathFactory, ink: Ink) -> None:
    path = tmp_path_factory.getbasetemp() / "cat.strokes.npz"
    strokes = Strokes.of(ink)
    write_strokes(strokes, path)
    again = read_strokes(path)
    for name in ("trajectories", "times", "poses"):
        assert np.array_equal(getattr(again, name), getattr(strokes, name), equal_nan=True)


def some_strokes() -> dict[str, Floats]:
    return {"trajectories": np.zeros((2, 5, 3)), "times": np.zeros((2, 5)), "poses": np.zeros((2, 3))}


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"trajectories": np.zeros((2, 5))}, "trajectories have shape (2, 5); it must be (N, n, 3) with n of at least"),
        ({"trajectories": np.zeros((2, 1, 3))}, "trajectories have shape (2, 1, 3); it must be (N, n, 3) with n of at"),
        ({"times": np.zeros((2, 4))}, "times have shape (2, 4) and poses (2, 3) for (2, 5, 3) trajectories"),
        ({"poses": np.zeros((3, 3))}, "times have shape (2, 5) and poses (3, 3) for (2, 5, 3) trajectories"),
        ({"poses": np.full((2, 3), np.nan)}, "a point or a pose of a stroke is not a finite number"),
        ({"trajectories": np.full((2, 5, 3), np.inf)}, "a point or a pose of a stroke is not a finite number"),
        ({"trajectories": np.tile([0, 0, 1.5], (2, 5, 1))}, "pressure is 1.5 to 1.5; it must be in [0, 1]"),
        ({"trajectories": np.full((2, 5, 3), 0.5)}, "a stroke does not begin at the origin; standardise it, and put"),
        ({"times": np.tile([0, 1, np.nan, 3, 4], (2, 1))}, "the times of a stroke must be known at all of its points"),
        ({"times": np.full((2, 5), np.inf)}, "the times of a stroke must be known at all of its points, or NaN at all"),
        ({"trajectories": np.pad([[np.nan], [0.5]], ((0, 3), (2, 0)))[None].repeat(2, 0)}, "the pressure of a stroke"),
        ({"poses": np.array(["a"])}, "could not convert string to float: "),
    ],
)
def test_strokes_with_a_fault_are_refused(tmp_path: Path, change: dict[str, Any], text: str) -> None:
    path = tmp_path / "cat.strokes.npz"
    write_arrays(path, "strokes", {**some_strokes(), **change})
    with pytest.raises(InputError) as caught:
        read_strokes(path)
    assert str(caught.value).startswith(f"{path} is not a file of strokes: {text}")
    assert "\n" not in str(caught.value)


def test_strokes_are_not_read_from_ink_nor_written_into_nothing(tmp_path: Path) -> None:
    write_arrays(tmp_path / "cat.npz", "ink", {})
    with pytest.raises(InputError, match="holds ink; it must be a file of strokes"):
        read_strokes(tmp_path / "cat.npz")
    with pytest.raises(OutputError, match="its folder does not exist; make the folder first"):
        write_strokes(Strokes(**some_strokes()), tmp_path / "none" / "cat.strokes.npz")
