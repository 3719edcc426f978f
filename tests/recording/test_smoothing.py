import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from maulstick.recording.mocap.smoothing import smooth
from maulstick.storage.arrays import Floats

RATE = 240.0
GAP = 0.1
TIMES = np.arange(2400) / RATE


def circle(hertz: float, radius: float = 5e-3) -> Floats:
    """A hand going round, (2400, 2)."""
    angles = 2 * np.pi * hertz * TIMES
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def noisy(values: Floats, noise: float, seed: int = 0) -> Floats:
    return values + np.random.default_rng(seed).normal(0, noise, values.shape)


def rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))


@settings(max_examples=30, deadline=None)
@given(st.tuples(*[st.floats(-1, 1)] * 3), st.lists(st.integers(1, 298), max_size=150, unique=True))
def test_a_parabola_stays_as_it_is_whatever_is_missing(factors: tuple[float, float, float], missing: list[int]) -> None:
    times = TIMES[:300]
    values = np.polynomial.polynomial.polyval(times, factors)[:, None]
    seen = values.copy()
    seen[missing] = np.nan
    smoothed = smooth(times, seen, 10.0).values
    assert np.abs(smoothed - values).max() < 1e-6


@pytest.mark.parametrize(("hertz", "noise"), [(1, 0.35e-3), (4, 0.35e-3), (8, 0.35e-3), (2, 0.05e-3)])
def test_most_of_the_noise_goes_and_the_movement_stays(hertz: float, noise: float) -> None:
    true = circle(hertz)
    smoothed = smooth(TIMES, noisy(true, noise), GAP)
    assert rms(smoothed.values - true) < 0.6 * noise
    assert smoothed.noise == pytest.approx(noise, rel=0.1)


def test_a_fast_hand_is_smoothed_less_than_a_slow_one_and_less_where_there_is_less_noise() -> None:
    slow, fast = (smooth(TIMES, noisy(circle(hertz), 3e-4), GAP) for hertz in (1, 10))
    assert slow.hertz < fast.hertz
    quiet = smooth(TIMES, noisy(circle(4), 3e-5), GAP)
    assert quiet.hertz > smooth(TIMES, noisy(circle(4), 1e-3), GAP).hertz


def test_the_first_and_last_places_are_not_rounded_off() -> None:
    true = circle(3)
    errors = [smooth(TIMES, noisy(true, 3e-4, seed), GAP).values - true for seed in range(40)]
    assert np.abs(np.mean(errors, axis=0)[[0, -1]]).max() < 2e-4  # no pull inwards: 40 runs average out


def test_gaps_are_bridged_up_to_the_longest_that_may_be() -> None:
    true = circle(1)
    seen = noisy(true, 1e-4)
    seen[500:522] = np.nan  # 24 steps of 1/240 s are 0.1 s
    seen[1000:1024] = np.nan
    smoothed = smooth(TIMES, seen, GAP)
    assert np.abs(smoothed.values[500:522] - true[500:522]).max() < 1e-3
    assert np.isnan(smoothed.values[1000:1024]).all()
    assert np.isfinite(np.delete(smoothed.values, np.s_[1000:1024], axis=0)).all()
    assert not smoothed.used[500:522].any()
    assert smoothed.used.sum() > 2340


def test_what_lies_before_a_gap_does_not_pull_what_lies_after() -> None:
    seen = noisy(circle(2), 1e-4)
    seen[1000:1100] = np.nan
    alone = smooth(TIMES[1100:], seen[1100:], GAP)
    both = smooth(TIMES, np.concatenate([seen[:1000] + 0.5, seen[1000:]]), GAP)
    assert np.abs(alone.values - both.values[1100:]).max() < 1e-4


def test_frames_that_were_never_written_do_not_bend_the_path() -> None:
    true = circle(2)
    kept = np.random.default_rng(0).random(len(TIMES)) > 0.2
    smoothed = smooth(TIMES[kept], noisy(true, 3e-4)[kept], GAP)
    assert rms(smoothed.values - true[kept]) < 0.2e-3


def test_outliers_are_left_out() -> None:
    true = circle(2)
    seen = noisy(true, 1e-4)
    out = np.arange(50, 2350, 100)
    seen[out] += 0.01
    smoothed = smooth(TIMES, seen, GAP)
    assert not smoothed.used[out].any()
    assert smoothed.used.sum() > 2400 - 3 * len(out)
    assert np.abs(smoothed.values - true).max() < 1e-3


def test_too_few_sightings_say_nothing() -> None:
    seen = np.full((100, 2), np.nan)
    seen[[3, 4, 5, 6, 7, 50, 99]] = 0.1
    smoothed = smooth(TIMES[:100], seen, GAP)
    assert np.isnan(smoothed.values).all()
    assert not smoothed.used.any()


def test_what_came_is_not_changed() -> None:
    seen = noisy(circle(2), 1e-4)
    seen[10] += 1
    before = seen.copy()
    smooth(TIMES, seen, GAP)
    assert np.array_equal(seen, before)
