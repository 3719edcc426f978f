from dataclasses import replace

import numpy as np
import pytest

from maulstick.errors import InputError
from maulstick.recording.mocap.frames import canvas_path
from maulstick.recording.mocap.take import Take
from maulstick.recording.mocap.tip import TipPath, steady, tip_path
from maulstick.storage.arrays import Floats
from tests.support.recording.simulated_take import NONE, RATE, TIP, Faults, loops_and_lines, simulate, way_of
from tests.support.tolerances import TIP_METRES_NOISY

NOISE = Faults(pen_lost=0, pen_swapped=0, canvas_lost=0, canvas_swapped=0)
STROKES = loops_and_lines(6)


def path_of(take: Take) -> TipPath:
    return tip_path(take, TIP, canvas_path(take))


def errors(path: TipPath, seed: int) -> Floats:
    """(F,) metres in the plane; NaN where the tip is not known."""
    off: Floats = np.linalg.norm(path.places - way_of(STROKES, seed)[:, :2], axis=1)
    return off


def test_a_take_without_faults_is_followed_nearly_exactly() -> None:
    path = path_of(simulate(STROKES, 1, NONE).take)
    assert np.nanmax(errors(path, 1)) < 0.4e-3  # the sharpest corners of the travel between strokes
    assert np.nanmedian(errors(path, 1)) < 1e-6
    assert (path.bridged, path.lost) == (path.rejected, 0)


@pytest.mark.parametrize("seed", range(3))
def test_the_noise_of_the_markers_is_found_and_mostly_gone(seed: int) -> None:
    path = path_of(simulate(STROKES, seed, NOISE).take)
    assert path.noise[0] == pytest.approx(0.35e-3, rel=0.15)  # at the tip, 0.1 mm at each marker
    assert path.noise[1] < path.noise[0]
    assert np.percentile(errors(path, seed), 95) < TIP_METRES_NOISY
    assert np.std(path.heights + way_of(STROKES, seed)[:, 2]) < 0.15e-3


@pytest.mark.parametrize("seed", range(3))
def test_dropouts_and_swapped_markers_leave_the_path_where_it_was(seed: int) -> None:
    path = path_of(simulate(STROKES, seed, Faults(pen_lost=40, pen_swapped=40)).take)
    assert path.rejected > 0
    assert path.bridged > path.rejected
    assert path.lost == 0
    assert np.percentile(errors(path, seed), 95) < 2 * TIP_METRES_NOISY


def test_a_pen_that_is_lost_for_long_is_lost() -> None:
    take = simulate(STROKES, 2, NOISE).take
    take.pen_positions[300:400] = np.nan
    take.pen_rotations[500:530] = np.nan
    path = path_of(take)
    assert np.isnan(path.heights[300:400]).all()
    assert np.isnan(path.places[300:400]).all()
    assert np.isfinite(path.heights[500:530]).all()
    assert (path.lost, path.bridged, path.rejected) == (100, 30, 0)


def test_a_lift_that_is_seen_to_begin_and_to_end_is_bridged_by_a_lift() -> None:
    take, true = simulate(STROKES, 2, NOISE).take, -way_of(STROKES, 2)[:, 2]
    touching = np.flatnonzero(true == 0)
    start = touching[np.argmax(np.diff(touching) > 1)]  # the first lift begins here
    peak = start + int(np.argmax(true[start : start + 60]))
    take.pen_positions[peak - 8 : peak + 8] = np.nan
    assert path_of(take).heights[peak] > 0.8 * true[peak] > 1e-3


def test_a_frame_without_all_of_its_rotation_counts_as_not_seen() -> None:
    take = simulate(STROKES, 2, NOISE).take
    take.pen_rotations[500:510, 3] = np.nan
    assert path_of(take).bridged == 10


def test_a_pen_that_is_never_seen_for_long_is_refused() -> None:
    take = simulate(STROKES, 2, NOISE).take
    blinking = np.where(np.arange(len(take))[:, None] % 100 == 0, take.pen_positions, np.nan)
    with pytest.raises(InputError, match="the pen and the canvas are never seen together for long; let the cameras"):
        path_of(replace(take, pen_positions=blinking))


def test_a_pose_that_jumps_and_comes_back_is_left_out_with_its_neighbours() -> None:
    offsets = np.tile(TIP, (600, 1)) + np.random.default_rng(0).normal(0, 3e-4, (600, 3))
    offsets[200:260] += 0.03
    kept = steady(np.arange(600) / RATE, offsets)
    assert not kept[200:260].any()
    assert kept[:197].all()
    assert kept[263:].all()


def test_a_pose_may_lean_far_while_it_is_out_of_sight() -> None:
    times = np.concatenate([np.arange(300), np.arange(400, 700)]) / RATE
    offsets = np.tile(TIP, (600, 1))
    offsets[300:] += (0.05, 0, 0)
    assert steady(times, offsets)[310:].all()
    at_once = steady(np.arange(600) / RATE, offsets)
    assert at_once[:297].all()
    assert not at_once[297:].any()
