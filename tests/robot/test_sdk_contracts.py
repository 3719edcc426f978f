"""What the arms' adapters call, as the installed libraries have it; the small replacements in tests keep to it, too.

An adapter that calls anything else, a library that takes anything else, and a replacement that does, all fail here.
"""

import ast
import inspect
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final

import pytest

from maulstick.robot.adapters import franka, ur, xarm
from tests.robot.test_ur import FakeUR
from tests.robot.test_xarm import FakeXArmAPI

XARM: Final = {
    "clean_error": "()",
    "clean_warn": "()",
    "disconnect": "()",
    "get_err_warn_code": "(show=False, lang='en')",
    "get_inverse_kinematics": ("(pose, input_is_radian=None, return_is_radian=None, limited=True, ref_angles=None)"),
    "get_position": "(is_radian=None)",
    "is_joint_limit": "(joint, is_radian=None)",
    "is_tcp_limit": "(pose, is_radian=None)",
    "motion_enable": "(enable=True, servo_id=None)",
    "set_mode": "(mode=0, detection_param=0)",
    "set_servo_cartesian": (
        "(mvpose, speed=None, mvacc=None, mvtime=0, is_radian=None, is_tool_coord=False, **kwargs)"
    ),
    "set_state": "(state=0)",
}
"""Methods of XArmAPI, which it states in Python."""

XARM_PROPERTIES: Final = {"axis", "device_type", "tcp_offset", "world_offset"}

UR_CONTROL: Final = {
    "RTDEControlInterface": ("hostname, frequency, flags, ur_cap_port, rt_priority", "None"),
    "disconnect": ("", "None"),
    "getTCPOffset": ("", "list[float]"),
    "isPoseWithinSafetyLimits": ("arg0", "bool"),
    "isProgramRunning": ("", "bool"),
    "reuploadScript": ("", "bool"),
    "servoL": ("arg0, arg1, arg2, arg3, arg4, arg5", "bool"),
    "servoStop": ("a", "bool"),
    "stopScript": ("", "None"),
}
UR_RECEIVE: Final = {
    "RTDEReceiveInterface": (
        "hostname, frequency, variables, verbose, use_upper_range_registers, rt_priority",
        "None",
    ),
    "disconnect": ("", "None"),
    "getActualTCPForce": ("", "list[float]"),
    "getActualTCPPose": ("", "list[float]"),
    "isConnected": ("", "bool"),
    "isEmergencyStopped": ("", "bool"),
    "isProtectiveStopped": ("", "bool"),
}
UR_BOARD: Final = {
    "DashboardClient": ("hostname, port, verbose", "None"),
    "connect": ("timeout_ms", "None"),
    "disconnect": ("", "None"),
    "getRobotModel": ("", "str"),
    "polyscopeVersion": ("", "str"),
}
"""Methods of ur-rtde's classes: parameters and what they return, out of the docstrings that C++ gives them."""

FRANKY: Final = {
    "Affine": ("translation, quaternion", "None"),
    "CartesianState": ("pose, velocity", "None"),
    "CartesianStopMotion": ("relative_dynamics_factor", "None"),
    "CartesianWaypoint": (
        "target, reference_type, relative_dynamics_factor, minimum_time, hold_target_duration, max_total_duration",
        "None",
    ),
    "CartesianWaypointMotion": ("waypoints, ee_frame, relative_dynamics_factor, return_when_finished", "None"),
    "Duration": ("arg0", "None"),
    "Twist": ("linear_velocity, angular_velocity", "None"),
}
FRANKY_ROBOT: Final = {
    "join_motion": ("timeout", "bool"),
    "move": ("motion, asynchronous, limit_rate, cutoff_frequency", "None"),
    "recover_from_errors": ("", "bool"),
    "stop": ("", "None"),
}
FRANKY_PROPERTIES: Final = {"current_pose", "has_errors", "is_in_control", "state"}
FRANKY_NAMES: Final = {
    "CommandException",
    "ControlException",
    "Exception",
    "NetworkException",
    "RealtimeConfig",
    "Robot",
}


def overloads(function: Any, name: str) -> list[tuple[str, str]]:
    """Return parameters, without self, and result of each overload that a docstring of pybind11 states."""
    stated = re.findall(rf"^(?:\d+\. )?{name}\((.*)\) -> (.+)$", inspect.getdoc(function) or "", re.MULTILINE)
    return [(", ".join(_names(parameters)), result) for parameters, result in stated]


def _names(parameters: str) -> Iterator[str]:
    depth, start = 0, 0
    for place, letter in enumerate(f"{parameters},"):
        depth += letter in "([<{"
        depth -= letter in ")]>}"
        if letter == "," and depth == 0:
            name = parameters[start:place].partition(":")[0].strip()
            start = place + 1
            if name != "self":
                yield name


def used(adapter: Any, *owners: str) -> set[str]:
    """Return the names that a module takes from what it calls so, as in ``self._arm.NAME`` or ``franky.NAME``."""
    assert adapter.__file__
    tree = ast.parse(Path(adapter.__file__).read_text())
    return {
        node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute) and ast.unparse(node.value) in owners
    }


def assert_fits(replacement: Callable[..., Any], parameters: list[str], *, named: bool) -> None:
    """Check that a replacement takes a part of the parameters, the first ones or by their names."""
    own = list(inspect.signature(replacement).parameters)
    if not named:
        assert len(own) <= len(parameters)
        return
    places = [parameters.index(name) for name in own]
    assert places == sorted(places)


@pytest.mark.parametrize("name", XARM)
def test_xarm_python_sdk_takes_what_the_adapter_gives_it(name: str) -> None:
    api = pytest.importorskip("xarm.wrapper", reason="xarm-python-sdk is not installed").XArmAPI
    signature = inspect.signature(getattr(api, name))
    own = list(signature.parameters.values())[1:]
    assert str(signature.replace(parameters=own)) == XARM[name]
    assert_fits(getattr(FakeXArmAPI(""), name), [parameter.name for parameter in own], named=True)


def test_xarm_python_sdk_has_the_properties_and_opens_by_the_address_alone() -> None:
    api = pytest.importorskip("xarm.wrapper", reason="xarm-python-sdk is not installed").XArmAPI
    assert all(isinstance(inspect.getattr_static(api, name), property) for name in XARM_PROPERTIES)
    inspect.signature(api).bind("192.168.1.2")
    assert_fits(FakeXArmAPI, list(inspect.signature(api).parameters), named=True)


def test_the_xarm_adapter_calls_nothing_else() -> None:
    assert used(xarm, "self._arm") == {*XARM, *XARM_PROPERTIES}


@pytest.mark.parametrize(
    ("module", "calls"), [("rtde_control", UR_CONTROL), ("rtde_receive", UR_RECEIVE), ("dashboard_client", UR_BOARD)]
)
def test_ur_rtde_takes_what_the_adapter_gives_it(module: str, calls: dict[str, tuple[str, str]]) -> None:
    library = pytest.importorskip(module, reason="ur-rtde is not installed")
    kind = getattr(library, next(iter(calls)))
    for name, stated in calls.items():
        function, called = (kind.__init__, "__init__") if name == kind.__name__ else (getattr(kind, name), name)
        assert overloads(function, called) == [stated], name
        if called == name:
            parameters = [part for part in stated[0].split(", ") if part]
            assert_fits(getattr(FakeUR(), name), parameters, named="arg0" not in parameters)


def test_the_ur_adapter_calls_nothing_else() -> None:
    classes = {"RTDEControlInterface", "RTDEReceiveInterface", "DashboardClient"}
    assert used(ur, "self._control", "control") == set(UR_CONTROL) - classes
    assert used(ur, "self._receive", "receive") == set(UR_RECEIVE) - classes
    assert used(ur, "board") == set(UR_BOARD) - classes


@pytest.mark.parametrize("name", FRANKY)
def test_franky_makes_what_the_adapter_asks_it_for(name: str) -> None:
    library = pytest.importorskip("franky", reason="franky-control is not installed")
    assert FRANKY[name] in overloads(getattr(library, name).__init__, "__init__")


@pytest.mark.parametrize("name", FRANKY_ROBOT)
def test_franky_s_robot_takes_what_the_adapter_gives_it(name: str) -> None:
    library = pytest.importorskip("franky", reason="franky-control is not installed")
    assert set(overloads(getattr(library.Robot, name), name)) == {FRANKY_ROBOT[name]}


def test_franky_has_the_names_and_counts_in_milliseconds_and_in_quaternions_with_w_last() -> None:
    library = pytest.importorskip("franky", reason="franky-control is not installed")
    assert set(dir(library)) >= FRANKY_NAMES
    assert set(dir(library.Robot)) >= FRANKY_PROPERTIES
    assert library.Duration(1500).to_sec() == 1.5
    turned = library.Affine([0.1, 0.2, 0.3], [0.0, 0.0, 1.0, 0.0])  # half a turn about z
    assert turned.matrix[:3].round(9).tolist() == [[-1, 0, 0, 0.1], [0, -1, 0, 0.2], [0, 0, 1, 0.3]]


def test_the_franka_adapter_calls_nothing_else() -> None:
    assert used(franka, "franky") == {*FRANKY, *FRANKY_NAMES}
    assert used(franka, "self._arm") == {*FRANKY_ROBOT, *FRANKY_PROPERTIES}
