import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from maulstick.robot.limits import Limits
from maulstick.robot.timing import Profile
from maulstick.storage.arrays import Floats
from tests.support.tolerances import FLOAT64_METRES_NEAR, PROFILE_ACCELERATION, PROFILE_SECONDS, PROFILE_STEPPED

LIMITS = Limits(
    lower=(-1, -1, -1), upper=(1, 1, 1), speed=0.2, climb=0.05, acceleration=2.0, deviation=1e-4, varies_pressure=True
)
coordinates = st.integers(-20, 20).map(lambda number: number / 200)
speeds = st.floats(1e-3, 0.5)


@st.composite
def motions(draw: st.DrawFn) -> tuple[Floats, Floats, Limits]:
    """Draw up to six points of a coarse grid, so that some are repeated and some lines go back; speeds; limits."""
    points = draw(st.lists(st.tuples(coordinates, coordinates, coordinates), min_size=1, max_size=6))
    changes = {
        "speed": draw(speeds),
        "climb": draw(speeds),
        "acceleration": draw(st.floats(0.05, 50)),
        "deviation": draw(st.sampled_from([0.0, 1e-5, 1e-3])),
    }
    given_speeds = draw(st.lists(speeds, min_size=len(points), max_size=len(points)))
    return np.array(points, dtype=np.float64), np.array(given_speeds), LIMITS.model_copy(update=changes)


def highest_speed(start: Floats, end: Floats, speed: float, limits: Limits) -> float:
    """Return the highest speed along a segment, by each of its limits in turn."""
    rise = abs(end[2] - start[2]) / np.linalg.norm(end - start)
    return float(min(speed, limits.speed, limits.climb / rise if rise > 0 else np.inf))


def corner_speed(before: Floats, after: Floats, limits: Limits) -> float:
    """Return the speed of Grbl's junction deviation, from the angle between two steps."""
    cosine = before @ after / np.linalg.norm(before) / np.linalg.norm(after)
    half = (np.pi - np.arccos(np.clip(cosine, -1, 1))) / 2
    if np.sin(half) > 1 - 1e-9:
        return np.inf
    return float(np.sqrt(limits.acceleration * limits.deviation * np.sin(half) / (1 - np.sin(half))))


def seconds_in_small_steps(points: Floats, speed: Floats, limits: Limits, parts: int = 400) -> float:
    """Return the fastest motion, from the highest speed at each of many places that acceleration allows."""
    moves = np.flatnonzero(np.abs(np.diff(points, axis=0)).max(axis=1) > 0)
    if len(moves) == 0:
        return 0.0
    squares, steps = [np.zeros(1)], []
    for number, i in enumerate(moves):
        allowed = highest_speed(points[i], points[i + 1], min(speed[i], speed[i + 1]), limits)
        end = 0.0
        if number + 1 < len(moves):
            j = moves[number + 1]
            following = highest_speed(points[j], points[j + 1], min(speed[j], speed[j + 1]), limits)
            between = speed[i + 1 : j + 1].min()
            corner = corner_speed(points[i + 1] - points[i], points[j + 1] - points[j], limits)
            end = min(allowed, following, corner, between)
        squares.append(np.append(np.full(parts - 1, allowed**2), end**2))
        shares = np.diff((1 - np.cos(np.linspace(0, np.pi, parts + 1))) / 2)  # finer where it speeds up and brakes
        steps.append(shares * np.linalg.norm(points[i + 1] - points[i]))
    square, step = np.concatenate(squares), np.concatenate(steps)
    for k in range(len(step)):
        square[k + 1] = min(square[k + 1], square[k] + 2 * limits.acceleration * step[k])
    for k in range(len(step) - 1, -1, -1):
        square[k] = min(square[k], square[k + 1] + 2 * limits.acceleration * step[k])
    fastness = np.sqrt(square)
    return float((2 * step / (fastness[:-1] + fastness[1:])).sum())


@settings(max_examples=60, deadline=None)
@given(motions())
def test_it_takes_as_long_as_the_same_motion_in_small_steps(motion: tuple[Floats, Floats, Limits]) -> None:
    points, speed, limits = motion
    expected = seconds_in_small_steps(points, speed, limits)
    assert Profile.of(points, speed, limits).seconds == pytest.approx(expected, rel=PROFILE_STEPPED)


@settings(max_examples=60, deadline=None)
@given(motions())
def test_it_is_never_too_fast_and_never_speeds_up_or_brakes_too_hard(motion: tuple[Floats, Floats, Limits]) -> None:
    points, speed, limits = motion
    profile = Profile.of(points, speed, limits)
    ticks = np.linspace(0, profile.seconds, 2001)
    tick = ticks[1] - ticks[0]
    if tick == 0:
        return
    along = profile.distance(ticks)
    assert along[0] == 0
    assert along[-1] == pytest.approx(profile.along[-1])
    fastness = np.diff(along) / tick
    noise = 4 * np.spacing(1.0) / tick
    assert fastness.min() >= -noise
    in_segment = np.interp(along, profile.along, np.arange(len(points)))
    first, last = np.floor(in_segment[:-1] + 1e-9).astype(int), np.ceil(in_segment[1:] - 1e-9).astype(int)
    highest = np.array([speed[max(a, 0) : b + 1].max() for a, b in zip(first, np.maximum(last, first), strict=True)])
    assert np.all(fastness <= np.minimum(highest, limits.speed) * (1 + PROFILE_ACCELERATION) + noise)
    harder = np.abs(np.diff(fastness)) / tick
    assert harder.max() <= limits.acceleration * (1 + PROFILE_ACCELERATION) + noise / tick
    assert max(fastness[0], fastness[-1]) <= limits.acceleration * tick * (1 + PROFILE_ACCELERATION) + noise
    climbing = np.abs(np.diff(profile.at(ticks)[:, 2])) / tick
    assert climbing.max() <= limits.climb * (1 + PROFILE_ACCELERATION) + noise


@given(motions())
def test_it_passes_all_its_points_at_their_times(motion: tuple[Floats, Floats, Limits]) -> None:
    profile = Profile.of(*motion)
    assert np.all(np.diff(profile.times) >= 0)
    assert np.abs(profile.at(profile.times) - motion[0]).max() < FLOAT64_METRES_NEAR
    outside = profile.at(np.array([-1.0, profile.seconds + 9]))
    assert np.abs(outside - motion[0][[0, -1]]).max() < FLOAT64_METRES_NEAR


def seconds_of(*points: tuple[float, float, float], speed: float = 1.0, **changes: float) -> float:
    return Profile.of(np.array(points), np.full(len(points), speed), LIMITS.model_copy(update=changes)).seconds


def test_a_long_line_is_a_trapezium() -> None:
    # 0.2 m/s after 0.1 s and 10 mm; 80 mm at that speed
    assert seconds_of((0, 0, 0), (0.1, 0, 0)) == pytest.approx(0.1 + 0.08 / 0.2 + 0.1, rel=PROFILE_SECONDS)


def test_a_short_line_is_a_triangle() -> None:
    assert seconds_of((0, 0, 0), (0.01, 0, 0)) == pytest.approx(2 * np.sqrt(0.01 / 2), rel=PROFILE_SECONDS)


def test_points_on_a_line_change_nothing() -> None:
    through = [(x, 0.0, 0.0) for x in (0, 0.02, 0.02, 0.05, 0.1)]
    assert seconds_of(*through) == pytest.approx(seconds_of(through[0], through[-1]), rel=PROFILE_SECONDS)


def test_without_deviation_it_stands_still_at_a_corner() -> None:
    two = 2 * seconds_of((0, 0, 0), (0.05, 0, 0))
    there = (0, 0, 0), (0.05, 0, 0), (0.05, 0.05, 0)
    assert seconds_of(*there, deviation=0) == pytest.approx(two, rel=PROFILE_SECONDS)
    assert seconds_of(*there) < two - 0.005


def test_a_point_that_is_repeated_hides_no_corner() -> None:
    corner = (0.0, 0.0, 0.0), (0.05, 0.0, 0.0), (0.05, 0.05, 0.0)
    twice = (corner[0], corner[0], corner[1], corner[1], corner[1], corner[2], corner[2])
    assert seconds_of(*twice) == pytest.approx(seconds_of(*corner), rel=PROFILE_SECONDS)


def test_it_stands_still_where_it_turns_back() -> None:
    there_and_back = seconds_of((0, 0, 0), (0.05, 0, 0), (0, 0, 0))
    assert there_and_back == pytest.approx(2 * seconds_of((0, 0, 0), (0.05, 0, 0)), rel=PROFILE_SECONDS)


def test_a_corner_is_as_fast_as_grbl_takes_it() -> None:
    square = np.array([(0, 0, 0), (0.05, 0, 0), (0.05, 0.05, 0)], dtype=np.float64)
    half = np.sin(np.pi / 4)
    assert Profile.of(square, np.ones(3), LIMITS).speeds[1] == pytest.approx(np.sqrt(2 * 1e-4 * half / (1 - half)))


def test_climbing_keeps_to_its_own_limit() -> None:
    assert seconds_of((0, 0, 0), (0, 0, 0.1), acceleration=1e6) == pytest.approx(0.1 / 0.05, rel=PROFILE_STEPPED)
    slope = seconds_of((0, 0, 0), (0.1, 0, 0.1), acceleration=1e6)
    assert slope == pytest.approx(0.1 / 0.05, rel=PROFILE_STEPPED)


@pytest.mark.parametrize("number", [1, 2, 5])
def test_staying_in_one_place_takes_no_time(number: int) -> None:
    profile = Profile.of(np.full((number, 3), 0.1), np.ones(number), LIMITS)
    assert profile.seconds == 0
    assert np.allclose(profile.at(np.array([0.0, 1.0])), 0.1, atol=FLOAT64_METRES_NEAR)


def test_a_slower_point_slows_both_its_segments_down() -> None:
    line = np.array([(0, 0, 0), (0.1, 0, 0), (0.2, 0, 0), (0.3, 0, 0)], dtype=np.float64)
    profile = Profile.of(line, np.array([0.2, 0.05, 0.2, 0.2]), LIMITS)
    assert np.allclose(profile.cruise, [0.05, 0.05, 0.2])
