from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from maulstick.errors import InputError
from maulstick.recording.mocap.pivot import calibrate_pivot
from maulstick.recording.mocap.take import Take
from tests.support.recording.simulated_take import NONE, TIP, pivot_take
from tests.support.tolerances import PIVOT_METRES, PIVOT_METRES_NOISY


@settings(max_examples=40, deadline=None)
@given(st.tuples(*[st.floats(-0.5, 0.5)] * 3), st.integers(0, 1000))
def test_any_tip_is_found_from_poses_without_noise(tip: tuple[float, float, float], seed: int) -> None:
    turns = Rotation.random(60, random_state=seed)
    positions = np.array([0.3, -1.2, 0.9]) - turns.apply(tip)
    take = Take(np.arange(60.0), positions, turns.as_quat(), np.zeros((60, 0, 3)), np.zeros((60, 3, 3)))
    found = calibrate_pivot(take)
    assert np.abs(found.tip - tip).max() < PIVOT_METRES
    assert found.residual < PIVOT_METRES


@pytest.mark.parametrize("seed", range(5))
def test_the_tip_is_found_despite_noise_swapped_markers_and_lost_frames(seed: int) -> None:
    take = pivot_take(seed)
    found = calibrate_pivot(take)
    assert np.abs(found.tip - TIP).max() < PIVOT_METRES_NOISY
    assert 0.3e-3 < found.residual < 0.8e-3  # 0.35 mm across the pen on two axes, and little along it


def test_swapped_markers_are_left_out() -> None:
    take = pivot_take(1, faults=NONE)
    take.pen_rotations[100:120] = np.roll(take.pen_rotations[100:120], 1, axis=1)
    found = calibrate_pivot(take)
    assert found.rejected == 20
    assert np.abs(found.tip - TIP).max() < PIVOT_METRES


def test_a_pen_that_was_hardly_turned_is_refused() -> None:
    with pytest.raises(InputError) as caught:
        calibrate_pivot(pivot_take(0, lean=3.0))
    assert str(caught.value).startswith(("the pen was turned by 1.", "the pen was turned by 2."))
    assert "degrees (RMS) in the pivot take; it must be 8 at least about every axis" in str(caught.value)


def test_a_pen_that_was_only_spun_about_itself_is_refused() -> None:
    turns = Rotation.from_euler("y", np.linspace(0, 6, 300)[:, None])
    take = Take(np.arange(300.0), np.zeros((300, 3)), turns.as_quat(), np.zeros((300, 0, 3)), np.zeros((300, 3, 3)))
    with pytest.raises(InputError, match=r"was turned by 0\.0 degrees"):
        calibrate_pivot(take)


def test_a_tip_that_moved_is_refused() -> None:
    take = pivot_take(0)
    moving = take.pen_positions + np.linspace(0, 0.05, len(take))[:, None] * (1, 0, 0)
    with pytest.raises(InputError, match=r"the tip strays 1\d\.\d mm \(RMS\) from one place .* at most 2 mm: stand"):
        calibrate_pivot(replace(take, pen_positions=moving))


def test_a_pen_that_was_hardly_seen_is_refused() -> None:
    take = pivot_take(0)
    take.pen_positions[40:] = np.nan
    with pytest.raises(InputError, match=r"the pen can be followed in \d+ frames of the pivot take; it must be 50"):
        calibrate_pivot(take)


def test_a_pen_that_was_never_seen_is_refused() -> None:
    take = pivot_take(0)
    take.pen_positions[:] = np.nan
    with pytest.raises(InputError, match="the pen can be followed in 0 frames"):
        calibrate_pivot(take)
