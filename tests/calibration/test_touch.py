"""The paper as a plane through touched points, keys that move a tip, and a tip that feels the paper."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from maulstick.calibration.touch import KEYS, Jog, easel_from_touches, probe_by_force, with_deepest
from maulstick.errors import InputError, MachineError
from maulstick.robot.easel import Easel
from maulstick.robot.limits import Limits
from maulstick.storage.arrays import Floats
from tests.support import tolerances
from tests.support.robot.obedient_robot import LIMITS, Feeling

A4 = np.array([[0, 0], [0.297, 0], [0.297, 0.21], [0, 0.21]])


def easel(turn: float, lean: float, about: float, corner: tuple[float, float, float] = (0.4, 0.1, 0.02)) -> Easel:
    """Return an easel turned about z, and tilted by `lean` about a level axis in the direction `about`."""
    tilted = Rotation.from_rotvec(lean * np.array([np.cos(about), np.sin(about), 0])) * Rotation.from_euler("z", turn)
    right, down = tilted.apply([[1, 0, 0], [0, -1, 0]]).tolist()
    return Easel(corner=corner, right=right, down=down)


def touches(truth: Easel, places: Floats) -> Floats:
    return truth.canvas_to_machine(np.c_[places, np.zeros(len(places))])


angles = st.floats(-np.pi, np.pi)
sheets = st.builds(easel, turn=angles, lean=st.floats(0, 0.5), about=angles)


@given(sheets, st.integers(3, 4))
def test_three_or_more_true_touches_give_back_the_easel(truth: Easel, count: int) -> None:
    found = easel_from_touches(touches(truth, A4[:count]), A4[:count], deepest=3e-3, travel=0.01)
    np.testing.assert_allclose(touches(found, A4), touches(truth, A4), atol=tolerances.TOUCH)
    assert found.error < tolerances.TOUCH
    assert (found.deepest, found.travel) == (3e-3, 0.01)


@given(sheets, st.integers(0, 2**32 - 1))
def test_touches_with_noise_give_the_sheet_to_within_a_few_times_the_noise(truth: Easel, seed: int) -> None:
    noise = 1e-4 * np.random.default_rng(seed).standard_normal((4, 3))
    found = easel_from_touches(touches(truth, A4) + noise, A4)
    assert np.linalg.norm(touches(found, A4) - touches(truth, A4), axis=1).max() < tolerances.TOUCH_NOISY
    assert found.error < tolerances.TOUCH_NOISY


@given(angles, st.floats(0.01, 0.5), angles)
def test_the_tilt_is_the_angle_by_which_the_sheet_leans(turn: float, lean: float, about: float) -> None:
    found = easel_from_touches(touches(easel(turn, lean, about), A4), A4)
    assert found.tilt == pytest.approx(lean, abs=1e-6)


def test_the_error_is_the_root_mean_square_of_what_a_plane_leaves() -> None:
    raised = touches(easel(0, 0, 0), A4)
    raised[:, 2] += [1e-4, -1e-4, 1e-4, -1e-4]  # a saddle: no plane is nearer than the flat one
    assert easel_from_touches(raised, A4).error == pytest.approx(1e-4, rel=1e-6)


def test_two_touches_are_too_few() -> None:
    with pytest.raises(InputError, match="2 points are touched; a plane needs at least 3"):
        easel_from_touches(touches(easel(0, 0, 0), A4)[:2], A4[:2])


def test_touches_on_a_line_are_refused() -> None:
    line = np.array([[0, 0], [0.1, 0.001], [0.2, 0], [0.29, 0]])
    with pytest.raises(InputError, match=r"lie within .* mm of a line; touch corners"):
        easel_from_touches(touches(easel(0, 0, 0), line), line)


def test_one_bad_touch_is_refused_by_its_number() -> None:
    wrong = touches(easel(0.3, 0.1, 1), A4)
    wrong[2] += [0.004, 0.003, 0.006]
    with pytest.raises(InputError, match=r"at most 1 mm, and point 3 is farthest off; touch them again"):
        easel_from_touches(wrong, A4)


def test_corners_touched_the_wrong_way_round_are_refused() -> None:
    mirrored = touches(easel(0, 0, 0), A4)[[1, 0, 3, 2]]
    with pytest.raises(InputError, match="the paper faces away"):
        easel_from_touches(mirrored, A4)


def test_touches_without_their_places_are_refused() -> None:
    with pytest.raises(InputError, match=r"must be \(k, 3\) and \(k, 2\)"):
        easel_from_touches(np.zeros((3, 2)), np.zeros((3, 2)))


@given(sheets, st.floats(1e-4, 0.0199))
def test_the_deepest_pressure_is_how_far_the_tip_is_below_the_paper(truth: Easel, depth: float) -> None:
    pressed = truth.canvas_to_machine(np.array([0.1, 0.1, -depth]))
    assert with_deepest(truth, pressed).deepest == pytest.approx(depth, abs=tolerances.TOUCH)


@pytest.mark.parametrize("height", [0.001, -0.05])
def test_a_tip_in_the_air_or_far_below_the_paper_is_no_deepest_pressure(height: float) -> None:
    truth = easel(0, 0, 0)
    with pytest.raises(InputError, match=r"the greatest depth is .* mm; it must be above 0 and at most 20 mm"):
        with_deepest(truth, truth.canvas_to_machine(np.array([0.1, 0.1, height])))


@given(st.lists(st.sampled_from([*KEYS, "q", "escape"]), max_size=60))
def test_no_keys_jog_the_tip_out_of_its_limits(keys: list[str]) -> None:
    narrow = LIMITS.narrowed(Limits.model_validate({**LIMITS.model_dump(), "upper": (0.325, 0.02, 0.035)}))
    jog = Jog((0.3, 0.0, 0.03), narrow)
    for key in keys:
        jog = jog.pressed(key)
        narrow.check_path(np.array([jog.place]))


def test_keys_step_the_tip_by_the_step_that_was_chosen() -> None:
    jog = Jog((0.3, 0.0, 0.05), LIMITS)
    for key in ("1", "left", "2", "up", "3", "pagedown"):
        jog = jog.pressed(key)
    np.testing.assert_allclose(jog.place, [0.29, 0.001, 0.0499], atol=1e-12)


def test_enter_takes_the_place_and_other_keys_do_nothing() -> None:
    jog = Jog((0.3, 0.0, 0.05), LIMITS)
    assert jog.pressed("x") is jog
    assert jog.pressed("enter").taken
    assert not jog.pressed("enter").pressed("up").taken


def test_a_tip_that_feels_finds_the_paper_to_within_a_step_and_rises_again() -> None:
    above = np.array([0.3, 0.0, 0.03])
    with Feeling(paper=0.0203) as robot:
        touched = probe_by_force(robot, above, lowest=0.01)
        assert 0.0203 - touched[2] < 4e-4
        np.testing.assert_array_equal(robot.place, above)


def test_a_tip_that_feels_nothing_says_so_and_never_goes_below_the_lowest_height() -> None:
    above = np.array([0.3, 0.0, 0.03])
    with Feeling(paper=0.0) as robot:
        with pytest.raises(MachineError, match="nothing was felt down to 20 mm"):
            probe_by_force(robot, above, lowest=0.02)
        assert robot.lowest >= 0.02
        np.testing.assert_array_equal(robot.place, above)


def test_a_lowest_height_outside_the_limits_is_refused_before_anything_moves() -> None:
    with Feeling(paper=0.0) as robot:
        before = robot.place
        with pytest.raises(InputError, match="the machine's z is"):
            probe_by_force(robot, np.array([0.3, 0.0, 0.03]), lowest=-1.0)
        np.testing.assert_array_equal(robot.place, before)
