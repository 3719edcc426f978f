import sys
import threading
from collections.abc import Callable
from types import FrameType
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.errors import InputError, MachineError
from maulstick.robot.robot import StoppedError
from maulstick.storage.arrays import Floats
from tests.support.robot.recorder import LIMITS, Recorder

HIGH = (0.0, 0.0, 0.05)
PATH = np.array([[0.0, 0.0, 0.0], [0.01, 0.0, 0.0], [0.02, 0.0, 0.0]])
SLOW = np.full(3, 0.1)
numbers = st.floats(-0.3, 0.3) | st.sampled_from([np.nan, np.inf, -np.inf])
commands = st.one_of(
    st.tuples(st.just("move"), st.lists(numbers, min_size=3, max_size=3)),
    st.tuples(st.just("stroke"), st.lists(st.tuples(numbers, numbers, numbers), min_size=1, max_size=3)),
    st.tuples(st.just("stroke here"), st.lists(st.tuples(numbers, numbers, numbers), min_size=0, max_size=2)),
    st.tuples(st.just("lift"), numbers),
)


@given(st.lists(st.tuples(commands, numbers), max_size=8))
def test_nothing_outside_the_limits_ever_reaches_a_machine(calls: list[Any]) -> None:
    robot = Recorder()
    with robot:
        for (what, value), speed in calls:
            try:
                if what == "move":
                    robot.move(value)
                elif what == "lift":
                    robot.lift(value)
                else:
                    path = value if what == "stroke" else [robot.place, *value]
                    robot.stroke(np.array(path), np.full(len(path), speed))
            except InputError:
                pass
    for _, path in robot.commands:
        assert np.isfinite(path).all()
        assert np.all(path >= np.array(LIMITS.lower) - 2e-9)
        assert np.all(path <= np.array(LIMITS.upper) + 2e-9)


def draw(robot: Recorder) -> None:
    robot.move(np.array(HIGH))
    robot.stroke(PATH, SLOW)
    robot.lift(0.05)


def refused(call: Callable[[Recorder], object], place: tuple[float, float, float] = HIGH) -> str:
    """Return the error of a call that the machine above the path's start refuses, and that reaches nothing."""
    robot = Recorder()
    with robot:
        robot.move(np.array(place))
        with pytest.raises(InputError) as caught:
            call(robot)
        assert robot.said == ["move"]
    return str(caught.value)


@pytest.mark.parametrize("goal", [(), 0.0, (0.0, 0.0), (0.0, 0.0, 0.0, 0.0), np.zeros((2, 3)), np.zeros((0, 3))])
def test_a_move_to_what_is_no_place_is_refused(goal: Any) -> None:
    assert "it must be (n, 3)" in refused(lambda robot: robot.move(goal))


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_move_a_stroke_and_a_lift_to_no_number_are_refused(bad: float) -> None:
    for call in (
        lambda robot: robot.move(np.array([0, 0, bad])),
        lambda robot: robot.stroke(np.array([[0, 0, 0], [0.01, bad, 0]]), SLOW[:2]),
        lambda robot: robot.lift(bad),
    ):
        assert refused(call) == "a point of the path is not a finite number"


def test_a_stroke_needs_a_speed_for_each_point() -> None:
    for count, told in ((2, "2 speeds"), (1, "1 speed")):
        said = refused(lambda robot, count=count: robot.stroke(PATH, SLOW[:count]))
        assert said == f"a stroke has {told} for 3 points; give one per point"


@pytest.mark.parametrize("speed", [0, -0.1, 0.3, np.nan])
def test_a_stroke_that_is_too_fast_or_stands_still_is_refused(speed: float) -> None:
    said = refused(lambda robot: robot.stroke(PATH, np.array([0.1, speed, 0.1])))
    assert said.endswith("it must be above 0 and at most 200 mm/s")


def test_a_stroke_must_begin_below_the_pen() -> None:
    said = refused(lambda robot: robot.stroke(PATH, SLOW), place=(0.0, 0.002, 0.05))
    assert said == "the stroke starts 2 mm beside the pen; move there first"


def test_while_the_pen_is_down_it_neither_moves_nor_begins_another_stroke() -> None:
    robot = Recorder()
    with robot:
        robot.move(np.array(HIGH))
        assert np.array_equal(robot.stroke(PATH, SLOW), PATH)
        with pytest.raises(InputError, match=r"^the pen is down; lift it before moving$"):
            robot.move(np.array(HIGH))
        with pytest.raises(InputError, match=r"^the pen is down already; lift it before the next stroke$"):
            robot.stroke(PATH[::-1], SLOW)
        assert np.array_equal(robot.lift(0.01), [0.02, 0, 0.01])
        assert np.array_equal(robot.move(np.array(HIGH)), HIGH)
    assert robot.said == ["move", "stroke", "lift", "move", "close"]


def test_a_machine_that_is_not_connected_does_nothing() -> None:
    robot = Recorder()
    with pytest.raises(InputError, match="use it in a with statement"):
        robot.lift(0.05)
    with pytest.raises(InputError, match="use it in a with statement"):
        robot.stroke(PATH, SLOW)
    assert robot.commands == []


def test_a_machine_that_is_left_with_its_pen_down_lifts_it() -> None:
    robot = Recorder()
    with robot:
        robot.move(np.array(HIGH))
        robot.stroke(PATH, SLOW)
    assert robot.said == ["move", "stroke", "recover", "close"]
    assert not robot.down


@pytest.mark.parametrize("error", [MachineError("the cable is off"), KeyboardInterrupt(), InputError("no")])
@pytest.mark.parametrize("during", ["move", "stroke", "lift"])
def test_whatever_goes_wrong_on_the_way_the_pen_is_lifted_and_nothing_more_is_done(
    during: str, error: BaseException
) -> None:
    def fail(what: str) -> None:
        if what == during:
            raise error

    robot = Recorder(before=fail)
    with robot:
        with pytest.raises(type(error)) as caught:
            draw(robot)
        assert caught.value is error
        with pytest.raises(StoppedError):  # since the place of the pen is not known
            robot.move(np.array(HIGH))
    assert not robot.down
    assert "recover" in robot.said


def test_what_goes_wrong_while_lifting_does_not_hide_what_went_wrong_before() -> None:
    def fail(what: str) -> None:
        if what != "close":
            raise MachineError(what)

    robot = Recorder(before=fail)
    with pytest.raises(MachineError, match=r"^move$"), robot:
        robot.move(np.array(HIGH))
    assert robot.said == ["close"]


def test_a_machine_that_does_not_open_is_closed() -> None:
    class Dead(Recorder):
        def _open(self) -> Any:
            raise MachineError("nobody answers")

    robot = Dead()
    with pytest.raises(MachineError, match="nobody answers"):
        robot.__enter__()
    assert robot.said == ["close"]


def test_after_a_stop_nothing_is_done_until_it_is_entered_again() -> None:
    robot = Recorder()
    with robot:
        robot.stop()
        with pytest.raises(StoppedError, match=r"^the machine was stopped$"):
            robot.move(np.array(HIGH))
        with pytest.raises(StoppedError):
            robot.lift(0.05)
    assert not {"move", "stroke", "lift"} & set(robot.said)
    with robot:
        robot.move(np.array(HIGH))
    assert robot.said[-2:] == ["move", "close"]


def draw_twice(robot: Recorder) -> None:
    with robot:
        draw(robot)
        draw(robot)


def test_a_signal_handler_may_stop_it_at_any_line_and_its_pen_is_lifted_in_the_end() -> None:
    """Check a stop from a signal handler, which runs between any two lines: it neither waits for ever nor is missed."""

    def lines_until_stop(at: int) -> int:
        robot, seen = Recorder(), 0

        def trace(frame: FrameType, event: str, _: object) -> Any:
            nonlocal seen
            if event == "line":
                seen += 1
                if seen == at:
                    robot.stop()
            return trace

        def work() -> None:
            sys.settrace(trace)
            try:
                draw_twice(robot)
            except StoppedError:
                pass
            finally:
                sys.settrace(None)

        worker = threading.Thread(target=work, daemon=True)
        worker.start()
        worker.join(20)
        assert not worker.is_alive(), f"a stop at line {at} waits for ever"
        assert not robot.down, f"after a stop at line {at} the pen is down"
        assert robot.said[-1] == "close"
        return seen

    last = lines_until_stop(0)
    assert last > 100
    for at in range(1, last + 1):
        lines_until_stop(at)


def test_a_pen_that_could_not_be_lifted_is_not_said_to_be_until_it_is() -> None:
    cut = [True]

    def fail(what: str) -> None:
        if cut[0] and what in ("stroke", "recover"):
            raise MachineError("the cable is off")

    robot = Recorder(before=fail)
    with robot:
        robot.move(PATH[0])
        with pytest.raises(MachineError, match="the cable is off"):
            robot.stroke(PATH, SLOW)
        assert not robot.lifted
        cut[0] = False
    assert robot.lifted
    assert robot.said[-2:] == ["recover", "close"]


def test_a_tip_that_was_jogged_down_is_not_lifted_until_it_is_where_it_came_from() -> None:
    with Recorder() as robot:
        robot.move(np.array(HIGH))
        robot.jog(np.array([0.01, 0.0, 0.05]))
        assert robot.lifted
        robot.jog(np.array([0.01, 0.0, 0.0]))
        robot.move(np.array([0.02, 0.0, 0.01]))
        assert not robot.lifted
        assert (robot.drawing, robot.clear) == (False, 0.05)
        robot.jog(np.array([0.02, 0.0, 0.06]))
        assert robot.lifted
        robot.jog(np.array([0.02, 0.0, 0.0]))
        robot.lift(0.03)
        assert (robot.lifted, robot.clear) == (True, 0.03)
    assert "recover" not in robot.said


def test_a_tip_creeps_down_by_no_number_of_small_steps_and_counts_as_lifted() -> None:
    with Recorder() as robot:
        robot.move(np.array(HIGH))
        for _ in range(5):
            robot.jog(robot.place - (0, 0, 5e-5))
        assert not robot.lifted


@pytest.mark.parametrize("stopped", [False, True])
def test_a_machine_that_is_left_or_stopped_with_its_tip_jogged_down_lifts_it(stopped: bool) -> None:
    heights: list[float] = []

    class Rising(Recorder):
        def _recover(self) -> None:
            super()._recover()
            heights.append(self.place[2])

    robot = Rising()
    with robot:
        robot.move(np.array(HIGH))
        robot.jog(np.zeros(3))
        if stopped:
            robot.stop()
            with pytest.raises(StoppedError):
                robot.lift(0.05)
    assert robot.said == ["move", "move", "recover", "close"]
    assert heights == [0.05]
    assert robot.lifted


class Connecting(Recorder):
    """Recorder that also notes when it connects, and may fail to open."""

    broken = False

    def _connect(self) -> None:
        self._note("connect", np.empty((0, 3)))

    def _open(self) -> Floats:
        if self.broken:
            raise MachineError("it does not open")
        return super()._open()


def test_a_machine_that_is_connected_is_entered_on_the_same_connection_and_closed_once() -> None:
    robot = Connecting()
    with robot.connected():
        assert robot.said == ["connect"]
        with robot:
            draw(robot)
        assert robot.said == ["connect", "move", "stroke", "lift"], "left, and still connected"
    assert robot.said[-1] == "close"
    with robot:
        pass
    assert robot.said[-3:] == ["close", "connect", "close"], "on its own it connects by itself"


def test_a_connected_machine_that_cannot_be_entered_or_fails_is_closed_once() -> None:
    robot = Connecting()
    robot.broken = True
    with pytest.raises(MachineError, match="does not open"), robot.connected(), robot:
        pass
    assert robot.said == ["connect", "close"]
