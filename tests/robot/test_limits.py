from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from maulstick.errors import InputError
from maulstick.robot.limits import Limits

LIMITS = Limits(
    lower=(0, -0.2, -0.01), upper=(0.3, 0, 0.05), speed=0.1, climb=0.05, acceleration=1, varies_pressure=True
)
places = st.tuples(*[st.floats(-0.5, 0.5)] * 3)


def fault(path: Any) -> str:
    with pytest.raises(InputError) as caught:
        LIMITS.check_path(path)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@given(st.lists(places, min_size=1, max_size=4))
def test_a_path_passes_if_and_only_if_all_of_it_lies_inside(path: list[tuple[float, float, float]]) -> None:
    if np.all(np.less_equal(LIMITS.lower, path) & np.less_equal(path, LIMITS.upper)):
        LIMITS.check_path(np.array(path))
    else:
        beyond = np.maximum(np.subtract(LIMITS.lower, path), np.subtract(path, LIMITS.upper)).max()
        if beyond > 2e-9:
            fault(path)


def test_the_corners_of_the_workspace_are_inside_it() -> None:
    LIMITS.check_path(np.array([LIMITS.lower, LIMITS.upper]))


@pytest.mark.parametrize(
    ("point", "message"),
    [
        ((0.35, 0, 0), "the machine's x is 350 mm; it must be 0 to 300 mm: 50 mm less far"),
        ((0, -0.2005, 0), "the machine's y is -200.5 mm; it must be -200 to 0 mm: 0.5 mm less far"),
        ((0.1, -0.1, -0.02), "the machine's z is -20 mm; it must be -10 to 50 mm: 10 mm less far"),
    ],
)
def test_a_point_outside_is_refused_with_the_axis_and_by_how_much(point: tuple[float, ...], message: str) -> None:
    assert fault([(0.1, -0.1, 0.0), point]) == message


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_place_that_is_no_number_is_refused(bad: float) -> None:
    assert fault([(0.1, -0.1, 0.0), (0.1, bad, 0.0)]) == "a point of the path is not a finite number"


@pytest.mark.parametrize("shape", [(), (3,), (0, 3), (4, 2), (2, 2, 3)])
def test_what_is_not_a_path_is_refused(shape: tuple[int, ...]) -> None:
    assert fault(np.zeros(shape)) == f"a path has shape {shape}; it must be (n, 3) with n of at least 1"


@pytest.mark.parametrize("speed", [0.0, -0.1, np.nan, np.inf, 0.1001])
def test_a_speed_that_is_not_above_0_and_at_most_the_machines_is_refused(speed: float) -> None:
    LIMITS.check_speed(np.array([0.1, 1e-6]))
    with pytest.raises(InputError, match=r"must be above 0 and at most 100 mm/s$"):
        LIMITS.check_speed(np.array([0.05, speed]))


@pytest.mark.parametrize(
    "change",
    [
        {"lower": (0.3, -0.2, 0)},
        {"upper": (np.nan, 0, 0)},
        {"lower": (-np.inf, -1, -1)},
        {"speed": 0},
        {"climb": np.inf},
        {"acceleration": -1},
        {"deviation": -1e-3},
        {"height": 1},
    ],
)
def test_limits_without_room_or_motion_are_refused(change: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        Limits.model_validate({**LIMITS.model_dump(), **change})


def test_narrowed_limits_are_the_stricter_ones_in_everything() -> None:
    other = Limits(
        lower=(-1, -0.1, -0.1),
        upper=(0.2, 1, 0.01),
        speed=1,
        climb=0.01,
        acceleration=9,
        varies_pressure=False,
        lifting=0.3,
    )
    narrow = LIMITS.narrowed(other)
    assert narrow == other.narrowed(LIMITS)
    assert (narrow.lower, narrow.upper) == ((0, -0.1, -0.01), (0.2, 0, 0.01))
    assert (narrow.speed, narrow.climb, narrow.acceleration) == (0.1, 0.01, 1)
    assert (narrow.varies_pressure, narrow.lifting) == (False, 0.3)


def test_limits_that_do_not_say_how_corners_are_passed_leave_that_to_the_machine() -> None:
    machine, wider, tighter = (LIMITS.model_copy(update={"deviation": each}) for each in (1e-4, 1e-3, 1e-5))
    assert [machine.narrowed(each).deviation for each in (LIMITS, wider, tighter)] == [1e-4, 1e-4, 1e-5]
    assert LIMITS.narrowed(LIMITS).deviation is None


def test_limits_with_no_place_in_common_are_refused_in_a_sentence() -> None:
    elsewhere = LIMITS.model_copy(update={"lower": (0.3, -0.2, 0.0), "upper": (0.5, 0.0, 0.1)})
    with pytest.raises(InputError, match=r"have no place in common; mend the limits in the easel's file$"):
        LIMITS.narrowed(elsewhere)
