import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.painting.painting_file import write_painting
from maulstick.robot.adapters.grbl import Grbl
from maulstick.robot.duration import seconds_of
from maulstick.robot.execute import PaintProgress, execute
from maulstick.robot.journal import Journal, journal_of
from maulstick.robot.limits import Limits
from maulstick.robot.pace import Pace
from maulstick.robot.routine import Draw, Prompt, routine
from tests.support.robot.fake_grbl import FakeGrbl
from tests.support.robot.recorder import EASEL, LIMITS, Recorder
from tests.support.robot.small_paintings import line, painting_of

TEN = painting_of(line(i, (0.01, 0.003 * i), (0.05, 0.003 * i)) for i in range(1, 11))
"""Ten strokes of 40 mm of one paint."""
FAR = np.array([0.15, 0.1, 0.005])


class Noting(Recorder):
    """Recorder that notes the highest speed of each stroke."""

    def __init__(self) -> None:
        super().__init__()
        self.speeds: list[float] = []

    def _stroke(self, path: np.ndarray, speed: np.ndarray) -> np.ndarray:  # type: ignore[type-arg]
        self.speeds.append(float(speed.max()))
        return super()._stroke(path, speed)


@given(st.lists(st.integers(-30, 30), max_size=10))
def test_a_pace_stays_from_10_to_200_per_cent_and_no_stroke_leaves_the_limits(steps: list[int]) -> None:
    pace = Pace(Recorder())
    for step in steps:
        pace.change(step)
        assert 10 <= pace.percent <= 200
        assert pace.percent % 10 == 0
        for action in routine(TEN, EASEL, LIMITS):
            assert isinstance(action, Draw)
            LIMITS.check_speed(pace.paced(action.motion).speed)


def test_strokes_are_drawn_at_the_pace_from_the_next_one_on_and_what_is_left_follows(tmp_path: Path) -> None:
    write_painting(TEN, tmp_path / "painting.json")
    robot = Noting()
    pace = Pace(robot)
    seen: list[float] = []

    def watch(progress: PaintProgress) -> None:
        seen.append(progress.left)
        if len(seen) == 4:
            pace.change(-5)

    with Journal.open(journal_of(tmp_path / "painting.json")) as journal, robot:
        actions = routine(TEN, EASEL, LIMITS, speed=0.02)
        place = robot.place
        execute(actions, robot, journal, lambda ask: None, watch, pace=pace)
    assert robot.speeds == pytest.approx([0.02] * 3 + [0.01] * 7)
    planned = np.cumsum(seconds_of(actions, LIMITS, place)[::-1])[::-1]
    assert seen[:4] == pytest.approx(planned[:4].tolist())
    halved = seconds_of(routine(TEN, EASEL, LIMITS, speed=0.01), LIMITS, place)
    assert seen[4] == pytest.approx(halved[4:].sum(), rel=1e-6)
    assert seen[-1] == 0


def test_a_pen_that_is_changed_aside_is_counted_from_there_at_any_pace() -> None:
    far = (0.2, 0.1, 0.03)
    (planned, *_), (halved, *_) = (routine(TEN, EASEL, LIMITS, speed=speed) for speed in (0.02, 0.01))
    actions = [planned, Prompt("change the pen", 0, aside=far), planned]
    seconds = seconds_of(actions, LIMITS, np.array(far))
    pace = Pace(Recorder())
    pace.change(-5)
    slower = float(seconds_of([halved], LIMITS, np.array(far))[0])
    assert pace.share_of_time(actions, seconds, 2) == pytest.approx(slower / seconds[2])


def until(override: int, device: FakeGrbl, robot: Grbl) -> None:
    """Move to and fro until the machine has that override; Grbl takes one step at every other report."""
    patience = time.monotonic() + 60
    while device.override != override:
        assert time.monotonic() < patience, device.overrides
        robot.move(FAR)
        robot.move(FAR - 0.05 * np.array([1, 1, 0]))


def test_a_grbl_changes_its_speed_by_its_own_overrides_one_step_at_a_time() -> None:
    with FakeGrbl(pace=20.0) as device, Grbl(device.port) as robot:
        pace = Pace(robot)
        pace.change(-3)
        until(70, device, robot)
        assert device.overrides == [b"\x92"] * 3
        pace.change(1)
        until(80, device, robot)
        pace.change(2)
        until(100, device, robot)
        assert device.overrides[3:] == [b"\x91", b"\x90"]
        (action, *_) = routine(TEN, robot.easel(0.06, 0.04).model_copy(update={"deepest": 0.002}), robot.limits)
        assert isinstance(action, Draw)
        assert pace.paced(action.motion) is action.motion, "Grbl scales what it is sent"


def test_a_step_that_a_grbl_missed_is_made_again() -> None:
    with FakeGrbl(pace=20.0) as device, Grbl(device.port) as robot:
        Pace(robot).change(-2)
        until(90, device, robot)
        device.override = 100
        until(80, device, robot)


def test_a_grbl_that_is_left_moves_as_fast_as_commanded_again() -> None:
    with FakeGrbl(pace=20.0) as device:
        with Grbl(device.port) as robot:
            Pace(robot).change(2)
            until(120, device, robot)
        patience = time.monotonic() + 60
        while device.override != 100:
            assert time.monotonic() < patience, device.overrides
            time.sleep(0.01)


def test_a_grbl_with_narrower_limits_draws_no_faster_than_they_say() -> None:
    with FakeGrbl() as device:
        narrow = Limits.model_validate({**LIMITS.model_dump(), "lower": (0, 0, -0.01), "speed": 0.01})
        with Grbl(device.port, limits=narrow) as robot:
            pace = Pace(robot)
            pace.change(5)
            assert pace.percent == 100


def test_what_is_left_of_a_grbl_counts_its_travel_too() -> None:
    with FakeGrbl() as device, Grbl(device.port) as robot:
        easel = robot.easel(0.06, 0.04).model_copy(update={"deepest": 0.002})
        actions = routine(TEN, easel, robot.limits, speed=0.02)
        seconds = seconds_of(actions, robot.limits, actions[0].motion.start)  # type: ignore[union-attr]
        pace = Pace(robot)
        assert pace.share_of_time(actions, seconds, 0) == 1
        pace.change(-5)
        assert 1.7 < pace.share_of_time(actions, seconds, 0) < 2
        pace.change(10)
        assert 0.6 < pace.share_of_time(actions, seconds, 0) < 1
