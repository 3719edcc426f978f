"""The xArm's adapter against a fake of its SDK: what is sent, and how codes are handled. No real arm is involved."""

import re
import sys
import threading
from collections.abc import Callable
from types import ModuleType

import numpy as np
import pytest

from maulstick.errors import InputError, MachineError, how_to_add
from maulstick.robot.adapters.xarm import LITE6, XARM, XArm
from maulstick.robot.robot import StoppedError
from tests.support import tolerances

TURNED = [3.1, 0.02, -0.5]
START = np.array([0.3, 0.0, 0.1])


class FakeXArmAPI:
    """Arm that moves at once to each set-point, and returns the codes that a test gives it."""

    axis, device_type = 6, 6
    tcp_offset = (0.0, 0.0, 120.0, 0.0, 0.0, 0.0)
    world_offset = (0.0,) * 6
    start = (300.0, 0.0, 100.0)
    latest: "FakeXArmAPI"

    def __init__(self, port: str | None = None) -> None:
        assert port is not None
        if port == "nowhere":
            raise Exception("connect socket failed")
        FakeXArmAPI.latest = self
        self.pose = [*self.start, *TURNED]
        self.sent: list[list[float]] = []
        self.done: list[tuple[str, object]] = []
        self.codes: list[int] = []
        self.error = 0
        self.stuck = False
        self.connected = True
        self.unreachable: Callable[[list[float]], bool] = lambda pose: False
        self.beyond_joints = self.beyond_boundary = False
        self.asked: list[list[float]] = []

    def clean_error(self) -> int:
        self.done.append(("clean_error", None))
        if self.error != 1:  # the emergency stop stays pressed
            self.error = 0
        return 0

    def clean_warn(self) -> int:
        return 0

    def motion_enable(self, enable: bool = True) -> int:
        return 0

    def set_mode(self, mode: int = 0) -> int:
        self.done.append(("mode", mode))
        return 0

    def set_state(self, state: int = 0) -> int:
        self.done.append(("state", state))
        return 0

    def get_err_warn_code(self) -> tuple[int, list[int] | str]:
        return (0, [self.error, 0]) if self.connected else (-1, "xArm is not connect")

    def get_position(self, is_radian: bool | None = None) -> tuple[int, list[float] | str]:
        assert is_radian
        return (0, list(self.pose)) if self.connected else (-1, "xArm is not connect")

    def get_inverse_kinematics(
        self, pose: list[float], input_is_radian: bool | None = None, return_is_radian: bool | None = None
    ) -> tuple[int, list[float]]:
        assert input_is_radian
        assert return_is_radian
        self.asked.append(pose)
        return (10, []) if self.unreachable(pose) else (0, [0.1] * 7)

    def is_joint_limit(self, joint: list[float], is_radian: bool | None = None) -> tuple[int, bool]:
        assert is_radian
        assert joint == [0.1] * 7
        return 0, self.beyond_joints

    def is_tcp_limit(self, pose: list[float], is_radian: bool | None = None) -> tuple[int, bool]:
        assert is_radian
        return 0, self.beyond_boundary

    def set_servo_cartesian(self, mvpose: list[float], is_radian: bool | None = None) -> int:
        assert is_radian
        if not self.connected:
            return -1
        code = self.codes.pop(0) if self.codes else 0
        if code == 0:
            self.sent.append(list(mvpose))
            self.pose = self.pose if self.stuck else list(mvpose)
        return code

    def disconnect(self) -> None:
        self.done.append(("disconnect", None))


@pytest.fixture
def api(monkeypatch: pytest.MonkeyPatch) -> type[FakeXArmAPI]:
    pytest.importorskip("xarm.core.config.x_code")  # its table of errors is the real one
    module = ModuleType("xarm.wrapper")
    module.XArmAPI = FakeXArmAPI  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "xarm.wrapper", module)
    monkeypatch.setattr("maulstick.robot.adapters.xarm._TOLD", 0.0)
    return FakeXArmAPI


def test_set_points_are_millimetres_along_the_path_with_the_tool_turned_as_it_was(api: type[FakeXArmAPI]) -> None:
    path = np.stack([START, START + np.array([0.02, 0, 0]), START + np.array([0.02, 0.01, -0.002])])
    with XArm("192.168.1.2") as robot:
        assert ("mode", 1) in api.latest.done
        robot.move(START + np.array([0, 0, 5e-3]))
        np.testing.assert_array_equal(robot.stroke(path, np.full(3, 0.1)), path)
        sent = np.array(api.latest.sent)
    np.testing.assert_allclose(sent[-1, :3] / 1e3, path[-1], atol=tolerances.SET_POINT)
    np.testing.assert_array_equal(sent[:, 3:], np.tile(TURNED, (len(sent), 1)))
    assert np.linalg.norm(np.diff(sent[:, :3], axis=0), axis=1).max() < 6.1  # 3 periods at 0.2 m/s at most
    assert ("disconnect", None) in api.latest.done


def test_it_rises_when_it_is_entered_but_not_above_its_workspace(
    api: type[FakeXArmAPI], monkeypatch: pytest.MonkeyPatch
) -> None:
    with XArm("192.168.1.2") as robot:
        np.testing.assert_allclose(robot.place, START + np.array([0, 0, 0.01]), atol=tolerances.SET_POINT)
    monkeypatch.setattr(api, "start", (300.0, 0.0, 445.0))
    with XArm("192.168.1.2") as robot:
        assert robot.place[2] == pytest.approx(XARM.upper[2])


def test_stop_from_another_thread_brakes_lifts_and_sends_nothing_more(api: type[FakeXArmAPI]) -> None:
    with XArm("192.168.1.2") as robot:
        robot.move(START)
        other = threading.Timer(0.3, robot.stop)
        other.start()
        with pytest.raises(StoppedError):
            robot.stroke(np.stack([START, START + np.array([0, 0.2, 0])]), np.full(2, 0.05))
        sent = np.array(api.latest.sent)
    assert 5 < sent[-1, 1] < 100, "it was stopped in the middle"
    assert sent[-1, 2] == pytest.approx(110)


@pytest.mark.parametrize(
    ("code", "error", "sentence"),
    [
        (1, 24, "the xArm stopped with error 24, Speed"),
        (9, 0, "the xArm refuses: it is not ready to move; it was stopped from elsewhere"),
        (-1, 0, "the xArm refuses: it is not connected; check the cable"),
        (77, 0, "the SDK returned code 77"),
    ],
)
def test_a_code_becomes_a_sentence_of_one_line(api: type[FakeXArmAPI], code: int, error: int, sentence: str) -> None:
    with XArm("192.168.1.2") as robot:
        api.latest.codes, api.latest.error = [0, 0, code], error
        with pytest.raises(MachineError) as failed:
            robot.move(START)
        assert sentence in str(failed.value)
        assert "\n" not in str(failed.value)
        assert api.latest.error == 0, "it recovered"


def test_an_arm_that_has_hit_something_moves_no_more_until_a_person_has_cleared_that(
    api: type[FakeXArmAPI], monkeypatch: pytest.MonkeyPatch
) -> None:
    with XArm("192.168.1.2") as robot:
        api.latest.codes, api.latest.error = [0, 0, 1], 31
        with pytest.raises(MachineError, match="the xArm stopped with error 31, Collision"):
            robot.move(START)
        sent = len(api.latest.sent)
    assert (len(api.latest.sent), api.latest.error, robot.lifted) == (sent, 31, False)
    monkeypatch.setattr(api, "get_err_warn_code", lambda self: (0, [31, 0]))
    with pytest.raises(MachineError, match="see that it is free, clear the error at the arm, and start again"):
        XArm("192.168.1.2").__enter__()
    assert api.latest.sent == []


def test_a_pressed_emergency_stop_is_named_before_anything_moves(
    api: type[FakeXArmAPI], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(api, "get_err_warn_code", lambda self: (0, [1, 0]))
    with pytest.raises(MachineError, match="error 1, The Emergency Stop Button"):
        XArm("192.168.1.2").__enter__()
    assert api.latest.sent == []


def test_an_arm_that_does_not_arrive_is_noticed(api: type[FakeXArmAPI], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("maulstick.robot.adapters.streaming._PATIENCE", 0.1)
    with XArm("192.168.1.2") as robot:
        api.latest.stuck = True
        with pytest.raises(MachineError, match="mm beside where it was sent"):
            robot.move(START + np.array([0.01, 0, 0]))


def test_a_lite_6_is_not_driven_within_the_limits_of_a_larger_arm(
    api: type[FakeXArmAPI], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(api, "device_type", 9)
    monkeypatch.setattr(api, "tcp_offset", (0.0,) * 6)
    with pytest.raises(InputError, match="this arm is a Lite 6"):
        XArm("192.168.1.2").__enter__()
    with XArm("192.168.1.2", LITE6) as robot:
        assert robot.limits.narrowed(LITE6) == robot.limits


def test_an_address_where_no_arm_is_says_what_to_check(api: type[FakeXArmAPI]) -> None:
    with pytest.raises(MachineError, match=r"no xArm answers at nowhere \(connect socket failed\); check its power"):
        XArm("nowhere").__enter__()


def test_without_the_sdk_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "xarm.wrapper", None)
    with pytest.raises(InputError, match=re.escape(how_to_add("xarm"))):
        XArm("192.168.1.2").__enter__()


def test_a_line_that_breaks_is_a_sentence_and_not_an_answer_that_cannot_be_read(api: type[FakeXArmAPI]) -> None:
    with XArm("192.168.1.2") as robot:
        api.latest.connected = False
        with pytest.raises(MachineError, match="the xArm refuses: it is not connected; check the cable"):
            robot.move(START)


@pytest.mark.parametrize(
    ("axis", "kind", "model"), [(5, 5, "xArm 5"), (6, 6, "xArm 6"), (7, 7, "xArm 7"), (6, 12, "UFACTORY 850")]
)
def test_its_model_says_its_reach_and_the_tool_set_in_it_how_far_the_wrist_is_above(
    api: type[FakeXArmAPI], monkeypatch: pytest.MonkeyPatch, axis: int, kind: int, model: str
) -> None:
    monkeypatch.setattr(api, "axis", axis)
    monkeypatch.setattr(api, "device_type", kind)
    monkeypatch.setattr(sys.modules[__name__], "TURNED", [np.pi, 0.0, 0.5])
    robot = XArm("192.168.1.2")
    with robot.connected():
        reach = robot.limits.reach
        assert reach is not None
        assert reach.model == model
        np.testing.assert_allclose(reach.wrist, (0, 0, 0.12 + reach.flange), atol=tolerances.SET_POINT)
        assert not robot.limits.holds(np.array([[0.6, 0.39, 0.0]])) or model == "UFACTORY 850"
    assert api.latest.sent == [], "nothing moved"


@pytest.mark.parametrize(("what", "value"), [("device_type", 99), ("world_offset", (0.0, 0.0, 50.0, 0.0, 0.0, 0.0))])
def test_an_unknown_model_and_one_that_counts_from_elsewhere_have_no_reach_but_their_own_kinematics(
    api: type[FakeXArmAPI], monkeypatch: pytest.MonkeyPatch, what: str, value: object
) -> None:
    monkeypatch.setattr(api, what, value)
    robot = XArm("192.168.1.2")
    with robot.connected():
        assert robot.limits.reach is None
        assert robot.knows_its_reach


def test_it_asks_the_controller_in_millimetres_and_radians_for_kinematics_joints_and_boundary(
    api: type[FakeXArmAPI],
) -> None:
    robot = XArm("192.168.1.2")
    with robot.connected():
        arm = api.latest
        assert robot.accepts(START)
        assert arm.asked == [[300.0, 0.0, 100.0, *TURNED]]
        arm.beyond_joints = True
        assert not robot.accepts(START)
        arm.beyond_joints, arm.beyond_boundary = False, True
        assert not robot.accepts(START)
        arm.beyond_boundary = False
        arm.unreachable = lambda pose: pose[0] > 250
        assert not robot.accepts(START)
        assert robot.accepts(START - np.array([0.1, 0, 0]))


def test_a_line_that_breaks_while_it_is_asked_is_no_verdict_about_the_place(
    api: type[FakeXArmAPI], monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = XArm("192.168.1.2")
    with robot.connected():
        monkeypatch.setattr(api, "get_inverse_kinematics", lambda *_, **__: (3, []))
        with pytest.raises(MachineError, match="it did not answer in time"):
            robot.accepts(START)
