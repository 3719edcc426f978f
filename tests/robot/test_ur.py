"""The UR's adapter against a fake of ur-rtde: what is sent, and how stops are handled. No real arm is involved."""

import re
import sys
import threading
from types import ModuleType

import numpy as np
import pytest

from maulstick.errors import InputError, MachineError, how_to_add
from maulstick.robot.adapters.ur import UR
from maulstick.robot.force import FeelsForce
from maulstick.robot.robot import StoppedError
from tests.support import tolerances

TURNED = [2.2, -2.2, 0.1]
START = np.array([0.4, -0.1, 0.2])


class FakeUR:
    """Both interfaces of one arm, which moves at once to each set-point until something stops it."""

    def __init__(self) -> None:
        self.model, self.version = "UR5", "5.11.1.108318"
        self.unreachable = False
        self.asked: list[list[float]] = []
        self.pose = [*START, *TURNED]
        self.sent: list[list[float]] = []
        self.done: list[str] = []
        self.protective = self.emergency = self.lost = False
        self.running = True
        self.fails_after = 10**9

    def getActualTCPPose(self) -> list[float]:  # noqa: N802
        return list(self.pose)

    def getActualTCPForce(self) -> list[float]:  # noqa: N802
        if self.lost:
            raise RuntimeError("End of file\n")
        return [0.0, 0.0, 4.5, 0.0, 0.0, 0.0]

    def isConnected(self) -> bool:  # noqa: N802
        return not self.lost

    def isProtectiveStopped(self) -> bool:  # noqa: N802
        return self.protective

    def isEmergencyStopped(self) -> bool:  # noqa: N802
        return self.emergency

    def isProgramRunning(self) -> bool:  # noqa: N802
        return self.running

    def reuploadScript(self) -> bool:  # noqa: N802
        self.done.append("upload")
        self.running = True
        return True

    def servoL(  # noqa: N802
        self, pose: list[float], speed: float, acceleration: float, time: float, lookahead_time: float, gain: float
    ) -> bool:
        assert 0.03 <= lookahead_time <= 0.2
        assert 100 <= gain <= 2000
        if len(self.sent) >= self.fails_after or self.protective or self.emergency or self.lost or not self.running:
            return False
        self.sent.append(list(pose))
        self.pose = list(pose)
        return True

    def getTCPOffset(self) -> list[float]:  # noqa: N802
        return [0.0, 0.0, 0.12, 0.0, 0.0, 0.0]

    def isPoseWithinSafetyLimits(self, pose: list[float]) -> bool:  # noqa: N802
        self.asked.append(pose)
        return not (self.unreachable or self.lost or not self.running)

    def connect(self) -> None:
        if not self.model:
            raise RuntimeError("Timeout connecting to UR dashboard server.")

    def getRobotModel(self) -> str:  # noqa: N802
        return f"{self.model}\n"

    def polyscopeVersion(self) -> str:  # noqa: N802
        return self.version

    def servoStop(self, a: float = 10.0) -> bool:  # noqa: N802
        self.done.append("servoStop")
        return True

    def stopScript(self) -> None:  # noqa: N802
        self.done.append("stopScript")

    def disconnect(self) -> None:
        self.done.append("disconnect")


@pytest.fixture
def arm(monkeypatch: pytest.MonkeyPatch) -> FakeUR:
    fake = FakeUR()

    def interface(hostname: str) -> FakeUR:
        if hostname == "nowhere":
            raise RuntimeError("Error: Could not connect to: nowhere at 30004,\nverify the IP")
        return fake

    for name, call in (
        ("rtde_control", "RTDEControlInterface"),
        ("rtde_receive", "RTDEReceiveInterface"),
        ("dashboard_client", "DashboardClient"),
    ):
        module = ModuleType(name)
        setattr(module, call, interface)
        monkeypatch.setitem(sys.modules, name, module)
    return fake


def test_set_points_are_metres_along_the_path_with_the_tool_turned_as_it_was(arm: FakeUR) -> None:
    path = np.stack([START, START + np.array([0.02, 0, 0]), START + np.array([0.02, 0.01, -0.002])])
    with UR("192.168.1.3") as robot:
        robot.move(START)
        np.testing.assert_array_equal(robot.stroke(path, np.full(3, 0.1)), path)
        sent = np.array(arm.sent)
    np.testing.assert_allclose(sent[-1, :3], path[-1], atol=tolerances.SET_POINT)
    np.testing.assert_array_equal(sent[:, 3:], np.tile(TURNED, (len(sent), 1)))
    assert arm.done[-3:] == ["stopScript", "disconnect", "disconnect"]


def test_stop_from_another_thread_brakes_and_lifts(arm: FakeUR) -> None:
    with UR("192.168.1.3") as robot:
        robot.move(START)
        other = threading.Timer(0.3, robot.stop)
        other.start()
        with pytest.raises(StoppedError):
            robot.stroke(np.stack([START, START + np.array([0, 0.2, 0])]), np.full(2, 0.05))
        assert 0.005 < arm.sent[-1][1] - START[1] < 0.1, "it was stopped in the middle"
        assert arm.sent[-1][2] == pytest.approx(START[2] + 0.01)


@pytest.mark.parametrize(
    ("what", "sentence"),
    [
        ("protective", "in a protective stop; see what it hit, and release it at its pendant"),
        ("emergency", "emergency stop is pressed"),
        ("lost", "the connection to the UR at 192.168.1.3 is lost; check the cable"),
    ],
)
def test_a_stop_of_the_arm_itself_is_named_and_left_to_a_person(arm: FakeUR, what: str, sentence: str) -> None:
    with UR("192.168.1.3") as robot:
        robot.move(START)
        setattr(arm, what, True)
        sent = len(arm.sent)
        with pytest.raises(MachineError, match=sentence):
            robot.stroke(np.stack([START, START + np.array([0.01, 0, 0])]), np.full(2, 0.05))
        assert len(arm.sent) == sent
    with pytest.raises(MachineError, match=sentence):
        UR("192.168.1.3").__enter__()


def test_a_program_that_ended_is_sent_again_to_lift_the_pen(arm: FakeUR) -> None:
    with UR("192.168.1.3") as robot:
        robot.move(START)
        arm.running = False
        with pytest.raises(MachineError, match="no longer follows"):
            robot.stroke(np.stack([START, START + np.array([0.01, 0, 0])]), np.full(2, 0.05))
        assert "upload" in arm.done
        assert arm.pose[2] == pytest.approx(START[2] + 0.01)


def test_it_feels_a_force_and_names_a_line_that_breaks_meanwhile(arm: FakeUR) -> None:
    with UR("192.168.1.3") as robot:
        assert isinstance(robot, FeelsForce)
        assert robot.force() == 4.5
        arm.lost = True
        with pytest.raises(MachineError, match=r"is lost \(End of file\); check the cable"):
            robot.force()


def test_an_address_where_no_arm_is_says_what_to_check_in_one_line(arm: FakeUR) -> None:
    with pytest.raises(MachineError, match=r"no UR can be driven at nowhere .* remote control") as failed:
        UR("nowhere").__enter__()
    assert "\n" not in str(failed.value)


def test_without_the_library_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "rtde_control", None)
    with pytest.raises(InputError, match=re.escape(how_to_add("ur"))):
        UR("192.168.1.3").__enter__()


@pytest.mark.parametrize(
    ("model", "version", "known"),
    [
        ("UR3", "3.15.8", "UR3"),
        ("UR3", "5.11.1.108318", "UR3e"),
        ("UR5", "URSoftware 5.9.4", "UR5e"),
        ("UR16", "5.11", "UR16e"),
        ("UR20", "5.14", "UR20"),
        ("UR30", "5.15", "UR30"),
        ("UR99", "5.15", None),
        ("", "", None),
    ],
)
def test_its_reach_is_that_of_the_model_that_the_controller_tells_and_no_other(
    arm: FakeUR, model: str, version: str, known: str | None
) -> None:
    arm.model, arm.version = model, version
    robot = UR("192.168.1.3")
    with robot.connected():
        reach = robot.limits.reach
    assert (None if reach is None else reach.model) == known
    assert arm.sent == [], "nothing moved"


def test_its_wrist_is_above_the_tip_by_the_tool_that_is_set_in_it(arm: FakeUR) -> None:
    arm.pose[3:] = [np.pi, 0.0, 0.0]  # downwards
    robot = UR("192.168.1.3")
    with robot.connected():
        assert robot.limits.reach is not None
        np.testing.assert_allclose(robot.limits.reach.wrist, (0, 0, 0.12 + 0.0996), atol=tolerances.SET_POINT)


def test_a_flange_that_points_aside_has_no_reach_but_the_controllers(arm: FakeUR) -> None:
    arm.pose[3:] = [np.pi / 2, 0.0, 0.0]
    robot = UR("192.168.1.3")
    with robot.connected():
        assert robot.limits.reach is None
        assert robot.accepts(START)


def test_it_asks_the_controller_which_places_are_within_reach_and_safety_limits(arm: FakeUR) -> None:
    robot = UR("192.168.1.3")
    with robot.connected():
        assert robot.knows_its_reach
        assert robot.accepts(START)
        assert arm.asked == [[*START, *TURNED]]
        arm.unreachable = True
        assert not robot.accepts(START)


@pytest.mark.parametrize(("what", "sentence"), [("lost", "is lost; check the cable"), ("running", "does not answer")])
def test_a_controller_that_does_not_answer_gives_no_verdict_about_a_place(
    arm: FakeUR, what: str, sentence: str
) -> None:
    robot = UR("192.168.1.3")
    with robot.connected():
        setattr(arm, what, what == "lost")
        with pytest.raises(MachineError, match=sentence):
            robot.accepts(START)
