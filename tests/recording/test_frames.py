from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from maulstick.errors import InputError
from maulstick.recording.mocap.frames import CORNERS, CanvasPath, canvas_path
from maulstick.recording.mocap.take import Take
from maulstick.storage.arrays import Floats
from tests.support.recording.simulated_take import NONE, RATE, SHEET, Faults, loops_and_lines, simulate
from tests.support.tolerances import FRAME_METRES, FRAME_METRES_NOISY

PLACES = np.array([(0.0, 0.0, 0.0), (0.24, 0.0, 0.0), (0.05, 0.15, 0.0), (0.1, 0.1, -0.2)])
PEN = np.array([0.1, 0.1, -0.14])


def take_of(places: Floats, frames: int = 100, seed: int = 0, pen: Floats = PEN) -> tuple[Take, Rotation, Floats]:
    """A take of markers at these places (3, 3) of the canvas, and where it put the canvas."""
    turn, away = Rotation.random(random_state=seed), np.random.default_rng(seed).uniform(-2, 2, 3)
    markers = np.tile(turn.apply(places) + away, (frames, 1, 1))
    body = np.tile(turn.apply(pen) + away, (frames, 1))
    nothing = np.zeros((frames, 0, 3))
    return Take(np.arange(frames) / RATE, body, np.full((frames, 4), np.nan), nothing, markers), turn, away


def corners(width: float, height: float, corner: int) -> Floats:
    """The markers (3, 3) around one corner, itself in the middle."""
    all_four = np.array([(0, 0, 0), (width, 0, 0), (width, height, 0), (0, height, 0)], dtype=float)
    return all_four[np.arange(corner - 1, corner + 2) % 4]


def wrong(canvas: CanvasPath, turn: Rotation, away: Floats) -> float:
    """How far, at most, a place on or over the canvas comes out wrong."""
    errors = [
        canvas.capture_to_canvas(np.tile(turn.apply(place) + away, (len(canvas.origins), 1))) - place
        for place in PLACES
    ]
    return float(np.abs(errors).max())


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(range(4)),
    st.permutations(range(3)),
    st.floats(0.05, 2),
    st.floats(0.05, 2),
    st.integers(0, 1000),
)
def test_any_corner_of_any_sheet_may_have_the_right_angle_and_its_marker_any_name(
    corner: int, names: list[int], width: float, height: float, seed: int
) -> None:
    take, turn, away = take_of(corners(width, height, corner)[names], 10, seed)
    canvas = canvas_path(take, CORNERS[corner])
    assert canvas.size == pytest.approx((width, height), abs=FRAME_METRES)
    assert wrong(canvas, turn, away) < 100 * FRAME_METRES
    assert np.allclose(np.linalg.det(canvas.rotations), 1)


def test_the_names_of_markers_may_change_from_frame_to_frame() -> None:
    take, turn, away = take_of(corners(*SHEET, 0))
    rng = np.random.default_rng(1)
    mixed = np.array([triangle[rng.permutation(3)] for triangle in take.canvas_markers])
    canvas = canvas_path(replace(take, canvas_markers=mixed))
    assert wrong(canvas, turn, away) < FRAME_METRES
    assert canvas.swapped > 50


def test_z_points_away_from_the_pen_on_whichever_side_it_is() -> None:
    take, turn, _ = take_of(corners(*SHEET, 0))
    assert np.allclose(canvas_path(take).rotations[:, :, 2], turn.apply([0, 0, 1]))
    take, turn, _ = take_of(corners(*SHEET, 0), pen=PEN * (1, 1, -1))
    assert np.allclose(canvas_path(take).rotations[:, :, 2], turn.apply([0, 0, -1]))


def test_a_pen_that_lies_beside_the_board_for_long_does_not_turn_the_canvas_over() -> None:
    take, turn, away = take_of(corners(*SHEET, 0))
    take.pen_positions[:70] = turn.apply([0.9, 0.1, 0.05]) + away
    assert wrong(canvas_path(take), turn, away) < FRAME_METRES


def test_the_side_is_told_by_the_pens_markers_where_its_rigid_body_sits_at_the_tip() -> None:
    take, turn, away = take_of(corners(*SHEET, 0), pen=PEN * (1, 1, 0) + (0, 0, 1e-3))
    markers = np.tile(turn.apply(PEN + np.eye(3) * 0.02) + away, (len(take), 1, 1))
    markers[:, 2] = np.nan  # one is never seen
    assert wrong(canvas_path(replace(take, pen_markers=markers)), turn, away) < FRAME_METRES


def test_a_corner_that_is_nearly_square_shares_its_error_between_the_axes() -> None:
    places = corners(*SHEET, 0)
    places[0] = (0.19 * np.sin(0.04), 0.19 * np.cos(0.04), 0)
    canvas = canvas_path(take_of(places)[0])
    assert canvas.skew == pytest.approx(-0.04)
    assert canvas.size == pytest.approx((0.24, 0.19))


def test_noise_is_smoothed_to_less_than_it_was() -> None:
    take, turn, away = take_of(corners(*SHEET, 0), 2000)
    take.canvas_markers[:] += np.random.default_rng(0).normal(0, 1e-4, take.canvas_markers.shape)
    canvas = canvas_path(take)
    assert wrong(canvas, turn, away) < FRAME_METRES_NOISY
    assert canvas.size == pytest.approx(SHEET, abs=2e-5)


def test_a_frame_with_two_markers_takes_the_third_from_before_and_after() -> None:
    take, turn, away = take_of(corners(*SHEET, 0))
    for marker in range(3):
        take.canvas_markers[10 + 30 * marker : 35 + 30 * marker, marker] = np.nan
    canvas = canvas_path(take)
    assert wrong(canvas, turn, away) < FRAME_METRES
    assert (canvas.mended, canvas.guessed) == (75, 0)


def test_a_reflection_is_not_taken_for_a_marker() -> None:
    take, turn, away = take_of(corners(*SHEET, 0))
    take.canvas_markers[20:40, 1] += 0.05
    canvas = canvas_path(take)
    assert wrong(canvas, turn, away) < FRAME_METRES
    assert canvas.mended == 20


def test_a_board_that_is_pushed_while_a_marker_is_lost_is_followed() -> None:
    take, turn, away = take_of(corners(*SHEET, 0), 400)
    push = np.linspace(0, 0.02, 60)[:, None, None] * np.array([0.6, 0.8, 0.0])
    take.canvas_markers[170:230] += push
    take.canvas_markers[230:] += push[-1]
    take.canvas_markers[150:250, 2] = np.nan
    canvas = canvas_path(take)
    assert canvas.mended == 100
    after = canvas.capture_to_canvas(np.tile(turn.apply(PLACES[2]) + push[-1, 0] + away, (400, 1)))
    assert np.abs(after[260:] - PLACES[2]).max() < FRAME_METRES
    origins = turn.apply(np.zeros(3)) + push[:, 0] + away
    assert np.abs(canvas.origins[170:230] - origins).max() < 2e-3  # smoothing rounds the sudden start and stop
    assert np.abs(canvas.origins[185:215] - origins[15:45]).max() < 5e-4


@pytest.mark.parametrize(("shift", "known"), [(0.0, True), (0.001, True), (0.01, False)])
def test_a_canvas_out_of_sight_is_where_it_was_unless_it_moved_meanwhile(shift: float, known: bool) -> None:
    take, _, _ = take_of(corners(*SHEET, 0))
    take.canvas_markers[60:] += (shift, 0, 0)
    take.canvas_markers[30:60] = np.nan
    canvas = canvas_path(take)
    assert np.isfinite(canvas.origins[40:50]).all() == known
    assert canvas.guessed == (30 if known else 0)
    assert np.isfinite(canvas.origins[:30]).all()
    assert np.isfinite(canvas.origins[60:]).all()


def test_a_canvas_that_is_seen_late_and_lost_early_is_taken_not_to_have_moved() -> None:
    take, turn, away = take_of(corners(*SHEET, 0))
    take.canvas_markers[:40], take.canvas_markers[60:] = np.nan, np.nan
    assert wrong(canvas_path(take), turn, away) < FRAME_METRES


def test_a_single_frame_is_enough_for_a_canvas() -> None:
    take, turn, away = take_of(corners(*SHEET, 0), 1)
    assert wrong(canvas_path(take), turn, away) < FRAME_METRES


def test_a_simulated_canvas_with_all_its_faults_is_found() -> None:
    strokes = loops_and_lines()
    exact, faulty = (simulate(strokes, 4, faults, bump=0.004).take for faults in (NONE, Faults(0, 0, 0, 30, 30)))
    true, found = canvas_path(exact), canvas_path(faulty)
    assert np.abs(found.origins - true.origins).max() < 1e-4
    assert found.swapped > 0
    assert found.mended > 0


Damage = Callable[[Floats], Floats]


@pytest.mark.parametrize(
    ("places", "text"),
    [
        (
            [(0, 0, 0), (0.2, 0, 0), (0.1, 0.173, 0)],
            "make angles of 60, 60 and 60 degrees; one must be a right angle, within 5 degrees: put them at three",
        ),
        ([(0, 0, 0), (0.1, 0, 0), (0.2, 0, 0)], "make angles of 180, 0 and 0 degrees; one must be a right angle"),
        ([(0, 0, 0), (0, 0, 0), (0.2, 0, 0)], "are 0 to 0.2 m apart; they must be 2 cm to 20 m apart"),
        ([(0, 0, 0), (240, 0, 0), (0, 190, 0)], "are 190 to 306.1 m apart; they must be 2 cm to 20 m apart"),
        (
            [(0, 0, 0), (0.2, 0, 0), (-0.02, 0.19, 0)],
            "make angles of 96, 41 and 43 degrees; one must be a right angle",
        ),
    ],
)
def test_markers_that_make_no_sheet_are_refused(places: list[tuple[float, float, float]], text: str) -> None:
    with pytest.raises(InputError) as caught:
        canvas_path(take_of(np.array(places, dtype=float))[0])
    assert text in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_take_without_canvas_or_pen_is_refused() -> None:
    take, _, _ = take_of(corners(*SHEET, 0))
    for hidden, text in (
        (
            {"canvas_markers": take.canvas_markers * [[[1], [1], [np.nan]]]},
            "three markers of the canvas are never seen",
        ),
        ({"pen_positions": take.pen_positions * np.nan}, "the pen and the canvas are never seen together"),
    ):
        with pytest.raises(InputError, match=text):
            canvas_path(replace(take, **hidden))


def test_markers_that_move_against_each_other_are_refused() -> None:
    take, _, _ = take_of(corners(*SHEET, 0))
    take.canvas_markers[:, 0] += np.linspace(0, 0.5, 100)[:, None] * (
        take.canvas_markers[0, 0] - take.canvas_markers[0, 1]
    )
    with pytest.raises(InputError, match="move against each other; fasten them to it"):
        canvas_path(take)


def test_a_corner_that_no_sheet_has_is_refused() -> None:
    with pytest.raises(InputError, match="there is no corner 'middle'; there are: lower-left, lower-right, upper-left"):
        canvas_path(take_of(corners(*SHEET, 0))[0], "middle")
