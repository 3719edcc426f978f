"""The Franka, end to end: franky drives a simulated arm through libfranka's own protocol."""

import os
import re
import sys
import threading
import time
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from maulstick.errors import InputError, MachineError, how_to_add
from maulstick.robot.adapters.franka import FRANKA_LIMITS, Franka
from maulstick.robot.check import check_robot
from maulstick.robot.easel import Easel
from maulstick.robot.force import FeelsForce
from maulstick.robot.robot import StoppedError
from maulstick.storage.arrays import Floats
from tests.support import tolerances
from tests.support.robot.franka_simulator import SECONDS_PER_STEP, FrankaSimulator

EASEL = Easel(corner=(0.5, 0.05, 0.5), right=(1, 0, 0), down=(0, -1, 0))
START = np.array([0.53, 0.0, 0.5])
ABOVE = START + np.array([0, 0, 5e-3])
END = START + np.array([0, -0.1, 0])
AT_ONCE = 0.2  # seconds


@pytest.fixture(scope="module")
def simulator() -> Iterator[FrankaSimulator]:
    with FrankaSimulator() as running:
        yield running


def wave(start: Floats) -> Floats:
    """Curve of 32 points and about 60 mm, 3 mm deeper in its middle."""
    along = np.linspace(0, 1, 32)
    return start + np.stack([0.05 * along, 0.01 * np.sin(6 * along), -3e-3 * np.sin(np.pi * along)], axis=1)


def beside(path: Floats, places: Floats) -> Floats:
    """Return the distance (k,) of each place (k, 3) to the nearest point of the path, metres."""
    nearest = np.full(len(places), np.inf)
    for start, step in zip(path[:-1], np.diff(path, axis=0), strict=True):
        share = ((places - start) @ step / (step @ step)).clip(0, 1)
        nearest = np.minimum(nearest, np.linalg.norm(places - start - share[:, None] * step, axis=1))
    return nearest


def test_it_keeps_every_promise_of_a_robot(simulator: FrankaSimulator) -> None:
    checks = check_robot(Franka(simulator.address), EASEL, (0.03, 0.05))
    # "at once" is by the clock on the wall, which a simulator on a busy computer does not keep; see below.
    assert [check for check in checks if not check.passed and check.name != "it stops at once"] == []


def test_it_leaves_the_thread_that_drives_it_no_more_urgent_than_before(simulator: FrankaSimulator) -> None:
    before = os.sched_getscheduler(0)
    with Franka(simulator.address) as robot:
        assert len(robot.place) == 3
    assert os.sched_getscheduler(0) == before


def test_a_stroke_follows_its_path(simulator: FrankaSimulator) -> None:
    path = wave(START)
    with Franka(simulator.address) as robot:
        robot.move(ABOVE)
        simulator.path()
        np.testing.assert_array_equal(robot.stroke(path, np.full(32, 0.1)), path)
        went = simulator.path()
        lifted = robot.lift(START[2] + 5e-3)
        rose = simulator.path()
    lowering = np.stack([ABOVE, START])
    assert np.minimum(beside(path, went), beside(lowering, went)).max() < tolerances.ARM_PATH
    missed = np.linalg.norm(went[:, None] - path, axis=2).min(axis=0)
    assert missed.max() < tolerances.ARM_PATH, "it went all the way"
    assert np.linalg.norm(rose[-1] - lifted) < tolerances.ARM_SETTLED


def on_the_way(simulator: FrankaSimulator, act: Callable[[], None]) -> list[Floats]:
    """Act, in a thread, when the tip is a third of the way from START to END; returns its path until then.

    By the simulator's clock: it runs as fast as the computer lets it, and not as clocks on the wall.
    """
    went = [simulator.path()]

    def watch() -> None:
        while len(went[-1]) == 0 or went[-1][-1, 1] > START[1] + (END - START)[1] / 3:
            time.sleep(0.005)
            went.append(simulator.path())
        act()

    threading.Thread(target=watch, daemon=True).start()
    return went


def test_stop_from_another_thread_ends_a_stroke_within_a_fifth_of_a_second_and_lifts(
    simulator: FrankaSimulator,
) -> None:
    with Franka(simulator.address) as robot:
        robot.move(ABOVE)
        went = on_the_way(simulator, robot.stop)
        with pytest.raises(StoppedError):
            robot.stroke(np.stack([START, END]), np.full(2, 0.1))
        since = simulator.path()
    moving = np.abs(np.diff(since[:, 1])) > 0.1 * np.abs(np.diff(np.concatenate(went)[:, 1])).max()
    assert np.flatnonzero(moving)[-1] * SECONDS_PER_STEP < AT_ONCE
    assert 0.03 < START[1] - since[-1, 1] < 0.095, "it was stopped in the middle"
    assert since[-1, 2] - START[2] > 5e-3, "it is lifted"


def test_it_lifts_after_an_error_of_the_arm_names_it_and_can_be_entered_again(simulator: FrankaSimulator) -> None:
    with Franka(simulator.address) as robot:
        robot.move(ABOVE)
        on_the_way(simulator, lambda: robot._arm.stop())  # as when somebody stops it in Desk
        with pytest.raises(MachineError, match="the Franka stopped: Move command preempted"):
            robot.stroke(np.stack([START, END]), np.full(2, 0.05))
        assert robot._where()[2] > START[2] + 5e-3
    with Franka(simulator.address) as robot:
        robot.move(ABOVE)
        assert np.linalg.norm(robot._where() - ABOVE) < tolerances.ARM_SETTLED


def test_it_feels_a_force_and_holds_its_tool_as_it_was_turned(simulator: FrankaSimulator) -> None:
    with Franka(simulator.address) as robot:
        assert isinstance(robot, FeelsForce)
        assert np.isfinite(robot.force())
        before = robot._arm.current_pose.end_effector_pose.matrix[:3, :3]
        robot.move(ABOVE + 0.02)
        after = robot._arm.current_pose.end_effector_pose.matrix[:3, :3]
    np.testing.assert_allclose(after, before, atol=tolerances.ARM_TURNED)


def test_its_reach_is_known_with_the_wrist_above_the_tool_that_is_set_in_it(simulator: FrankaSimulator) -> None:
    robot = Franka(simulator.address)
    with robot.connected():
        reach = robot.limits.reach
        assert reach is not None
        pose = robot._arm.current_pose.end_effector_pose.matrix
        tool = robot._arm.state.F_T_EE.matrix
    flange = pose @ np.linalg.inv(tool)
    wrist = flange @ [0.0, 0.0, -reach.flange, 1.0]  # above the flange, where the last two axes cross
    np.testing.assert_allclose(pose[:3, 3] + reach.wrist, wrist[:3], atol=1e-9)
    assert not robot.knows_its_reach, "franky has no inverse kinematics"


def test_an_arm_that_stands_outside_its_workspace_is_not_moved(simulator: FrankaSimulator) -> None:
    narrow = FRANKA_LIMITS.model_copy(update={"upper": (0.7, 0.35, 0.3)})
    simulator.path()
    with pytest.raises(MachineError, match=r"the tip stands at .* outside the workspace .* guide the arm back by hand"):
        Franka(simulator.address, narrow).__enter__()


def test_a_simulator_that_vanishes_in_a_stroke_is_a_lost_arm() -> None:
    with FrankaSimulator() as vanishing, Franka(vanishing.address) as robot:
        robot.move(ABOVE)
        other = threading.Timer(0.5, vanishing.vanish)
        other.start()
        with pytest.raises(MachineError, match=r"does not answer .*; check the cable"):
            robot.stroke(np.stack([START, END]), np.full(2, 0.02))
        other.join()


def test_an_address_where_no_arm_is_says_what_to_check() -> None:
    with pytest.raises(MachineError, match=r"the Franka at 127\.9\.9\.9 does not answer .* FCI"):
        Franka("127.9.9.9").__enter__()


def test_without_franky_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "franky", None)
    with pytest.raises(InputError, match=re.escape(how_to_add("franka"))):
        Franka("127.0.0.1").__enter__()


def test_it_says_that_it_must_be_told_where_the_sheet_lies() -> None:
    with pytest.raises(InputError, match="run: maulstick calibrate touch --robot"):
        Franka("127.0.0.1").easel(0.2, 0.1)
