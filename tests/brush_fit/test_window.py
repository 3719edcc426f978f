from dataclasses import replace

import numpy as np
import pytest
from hypothesis import event, given, settings
from hypothesis import strategies as st
from scipy import ndimage

from maulstick.brush_fit.trials import Trial
from maulstick.brush_fit.window import Window, extent, look
from maulstick.errors import InputError
from maulstick.painting.brush import Brush
from tests.support.brush_fit.simulated_trials import CLEAN, SCALE, SHAPE, Faults, draw_darkness, draw_trials
from tests.support.tolerances import EVEN_LIGHT, MARK_EXTENT, MOVED_PX

MARKER = Brush(name="truth", source="a test", alpha=1e-3, beta=0.7e-3, falloff=0.9, opacity=0.9)
REACH = 4e-3
HEIGHT, WIDTH = SHAPE
SEED = 3


def one(faults: Faults = CLEAN) -> Trial:
    """The third stroke of a sheet."""
    return draw_trials(MARKER, 3, SEED, faults)[2]


def looked(trial: Trial) -> Window:
    return look(trial, SCALE, REACH)


def moved(trial: Trial, right: float, down: float) -> Trial:
    return replace(trial, after=ndimage.shift(trial.after, (down, right, 0), order=1, mode="nearest"))


def corner_px(window: Window) -> tuple[int, int]:
    left, top = (round(metres * SCALE) for metres in window.corner)
    return left, top


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**16),
    aside=st.tuples(st.floats(-0.06, 0.06), st.floats(-0.06, 0.06)),
    reach=st.floats(1e-3, 0.02),
    reduced=st.integers(1, 3),
)
def test_a_window_lies_inside_its_photograph_wherever_the_path_went(
    seed: int, aside: tuple[float, float], reach: float, reduced: int
) -> None:
    (trial,) = draw_darkness(MARKER, 1, seed)
    trial = replace(trial, path=trial.path + np.array([*aside, 0]))
    try:
        window = look(trial, SCALE, reach, reduced)
    except InputError as error:
        event(str(error))
        return
    left, top = corner_px(window)
    height, width = window.covered.shape
    cut = trial.after[top : top + height * reduced, left : left + width * reduced]
    assert left >= 0 <= top
    assert cut.shape == (height * reduced, width * reduced, 1)
    blocks = cut.reshape(height, reduced, width, reduced, 1).mean(axis=(1, 3))
    assert np.allclose(window.after, blocks, atol=1e-6)
    assert window.before.shape[:2] == window.weights.shape == window.covered.shape


def test_the_mark_is_covered_and_the_paper_beside_it_is_not() -> None:
    (trial,) = draw_darkness(MARKER, 1, SEED)
    window = looked(trial)
    assert np.array_equal(window.covered, window.after[..., 0] > 0.08)
    assert np.all(window.weights == 1)


def test_the_extent_of_a_stroke_is_about_its_half_width() -> None:
    alone = draw_trials(MARKER, 1, SEED, pressure=np.ones_like)[0]
    assert extent(looked(alone), SCALE) == pytest.approx(MARKER.widest, abs=MARK_EXTENT)


def test_light_that_differs_between_photographs_is_taken_out() -> None:
    lit, even = (looked(one(Faults(place=0, ink=0, noise=0, light=light))) for light in (0.1, 0.0))
    assert np.abs(one(Faults(place=0, ink=0, noise=0, light=0.1)).after - one().after).max() > 4 * EVEN_LIGHT
    gains = lit.before / even.before
    assert np.abs(lit.after / gains - even.after).max() < EVEN_LIGHT
    assert np.mean(lit.covered != even.covered) < 0.01


def test_specks_beside_the_stroke_have_no_weight_and_its_own_pixels_do() -> None:
    plain = one()
    speckled = plain.after.copy()
    free = ndimage.distance_transform_edt(np.abs(plain.after - plain.before).max(axis=2) < 0.01) > 12
    left, top = corner_px(looked(plain))
    height, width = looked(plain).covered.shape
    row, column = np.argwhere(free[top + 3 : top + height - 3, left + 3 : left + width - 3])[0] + 3
    speckled[top + row - 1 : top + row + 2, left + column - 1 : left + column + 2] = 0.2
    window = looked(replace(plain, after=speckled))
    speck = np.zeros(window.weights.shape, dtype=bool)
    speck[row - 1 : row + 2, column - 1 : column + 2] = True
    assert np.array_equal(window.weights == 0, ndimage.binary_dilation(speck))
    assert np.array_equal(window.covered, looked(plain).covered)


@pytest.mark.parametrize(("right", "down"), [(5, 0), (-3, 4), (12, -9), (0.0, 2.5)])
def test_a_camera_that_moved_is_told_by_how_many_pixels(right: float, down: float) -> None:
    trial = moved(one(Faults()), right, down)
    with pytest.raises(InputError, match=r"^stroke 3: the camera or the paper moved by [\d.]+ pixels") as caught:
        looked(trial)
    said = float(str(caught.value).split(" moved by ")[1].split()[0])
    assert said == pytest.approx(np.hypot(right, down), abs=MOVED_PX)
    assert "; fix both and draw it again" in str(caught.value)


@pytest.mark.parametrize("seed", range(4))
def test_a_camera_that_stands_still_is_never_said_to_have_moved(seed: int) -> None:
    for trial in draw_trials(MARKER, 8, seed, Faults(light=0.2, specks=4)):
        assert looked(trial).name == trial.name


def test_an_empty_sheet_tells_nothing_of_the_camera() -> None:
    first = draw_trials(MARKER, 1, SEED, Faults(noise=0.03))[0]
    assert looked(first).covered.any()
    assert looked(moved(first, 3, -2)).covered.any()


def test_a_photograph_that_cannot_be_used_is_told_by_its_fault() -> None:
    trial = one(Faults())
    for change, text in (
        ({"after": trial.before}, "stroke 3 left no mark that can be seen near its path; was the tip on the paper"),
        ({"after": np.ones_like(trial.after)}, "stroke 3 cannot be seen: its photograph after it is all white; was it"),
        ({"after": np.zeros_like(trial.after)}, "stroke 3 cannot be seen: its photograph after it is all black; light"),
        ({"before": np.zeros_like(trial.after)}, "stroke 3 cannot be seen: its photograph before it is all black;"),
        ({"path": trial.path + np.array([1, 0, 0])}, "stroke 3 lies beside its photographs; check the pixels"),
    ):
        with pytest.raises(InputError, match=f"^{text}") as caught:
            looked(replace(trial, **change))
        assert "\n" not in str(caught.value)
