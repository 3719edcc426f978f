"""Sheets that kinds of machines reach, beside their own limits and reaches."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.errors import InputError
from maulstick.painting.raster import parse_size
from maulstick.robot.adapters.axidraw import AxiDraw
from maulstick.robot.adapters.franka import FRANKA_LIMITS
from maulstick.robot.adapters.reaches import FRANKA_REACH, UFACTORY_REACHES
from maulstick.robot.adapters.xarm import LITE6
from maulstick.robot.limits import Limits
from maulstick.robot.sheet_reach import is_beyond, sheet_fault

SIDES = st.floats(0.01, 1.5)
HELD = {
    "lite6": (LITE6, UFACTORY_REACHES[6, 9]),
    "franka": (FRANKA_LIMITS, FRANKA_REACH),
}


@given(SIDES, SIDES)
def test_an_axidraw_is_said_to_reach_the_sheets_that_it_takes(width: float, height: float) -> None:
    robot = AxiDraw()
    corners = np.array([(0, 0, 0), (width, height, 0)])
    try:
        robot.limits.check_path(robot.easel(width, height).canvas_to_machine(corners))
    except InputError:
        assert sheet_fault("axidraw:/dev/ttyACM0", width, height)
    else:
        assert not sheet_fault("axidraw", width, height)


def places_of(width: float, height: float, x: float, y: float, turn: float) -> np.ndarray:
    """Return places (n, 3) all over a sheet whose middle is there, turned by an angle."""
    across, down = np.meshgrid(np.linspace(-0.5, 0.5, 9) * width, np.linspace(-0.5, 0.5, 9) * height)
    cos, sin = np.cos(turn), np.sin(turn)
    return np.stack([x + cos * across - sin * down, y + sin * across + cos * down, 0 * across], axis=-1).reshape(-1, 3)


def lies_somewhere(kind: str, width: float, height: float) -> bool:
    """Return whether a sheet is reached at one of many places, also aslant."""
    limits, reach = HELD[kind]
    held: Limits = limits.model_copy(
        update={"reach": reach.holding(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, 0.12]))}
    )
    middles = [(x, y) for x in np.arange(limits.lower[0], limits.upper[0], 0.01) for y in (-0.05, 0.0, 0.05)]
    turns = np.linspace(0, np.pi / 2, 10)
    return any(held.holds(places_of(width, height, x, y, turn)) for x, y in middles for turn in turns)


@pytest.mark.parametrize("kind", ["lite6", "franka"])
@pytest.mark.parametrize("size", ["A5", "A4", "A3", "A2", "160x160mm", "400x400mm"])
def test_an_arm_is_said_to_reach_the_sheets_that_it_reaches_somewhere(kind: str, size: str) -> None:
    width, height = parse_size(size)
    assert is_beyond(kind, width, height) != lies_somewhere(kind, width, height)


@pytest.mark.parametrize("kind", ["axidraw", "lite6", "xarm", "franka", "ur"])
@given(width=SIDES, height=SIDES)
def test_a_sheet_of_the_shape_that_is_said_to_be_reached_is(kind: str, width: float, height: float) -> None:
    fault = sheet_fault(kind, width, height)
    assert bool(fault) or not is_beyond(kind, width, height)
    if "largest of its shape" in fault:
        *_, across, _, down, _ = fault.split()
        shrunk = (0.999 * int(across) - 1, 0.999 * int(down) - 1)  # what is said is rounded
        if min(shrunk) > 0:
            assert not is_beyond(kind, *(1e-3 * side for side in shrunk))


@pytest.mark.parametrize(
    ("kind", "size", "fault"),
    [
        ("axidraw", "A4", "this sheet, 210 by 297 mm, is reached by the machine only if it lies"),
        (
            "axidraw",
            "A3",
            "this sheet, 297 by 420 mm, is larger than the machine reaches; the largest of its shape is 300 by 212 mm",
        ),
        ("grbl:/dev/ttyUSB0", "900x900mm", ""),
        ("hpgl", "900x900mm", ""),
        ("sim:real", "900x900mm", ""),
        ("", "900x900mm", ""),
    ],
)
def test_what_is_not_reached_is_said_and_nothing_of_machines_that_nobody_knows(
    kind: str, size: str, fault: str
) -> None:
    assert sheet_fault(kind, *parse_size(size)) == fault
