import os
import re
import termios
import time
from collections.abc import Iterator
from typing import cast

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from maulstick.errors import InputError, MachineError
from maulstick.robot.adapters.grbl import Grbl
from maulstick.robot.adapters.grbl_answers import ALARMS, ERRORS, Status
from maulstick.robot.adapters.grbl_stream import GrblStream
from maulstick.robot.adapters.serial_line import SerialLine
from maulstick.robot.easel import Pen
from maulstick.robot.limits import Limits
from maulstick.robot.plotter import LockedError
from maulstick.robot.robot import StoppedError
from maulstick.robot.stopping import Stopping
from maulstick.robot.timing import Profile
from maulstick.storage.arrays import Floats
from tests.support.robot.fake_grbl import CRITICAL, SETTINGS, WITH_SWITCHES, FakeGrbl
from tests.support.robot.under_way import once
from tests.support.tolerances import CLOCK, GCODE_METRES

SERVO = Pen(up=500, down=700, seconds=0.1)
ABOVE = np.array([0.05, 0.05, 0.005])
ANGLES = np.linspace(0, 2 * np.pi, 32)
CIRCLE = np.stack([0.05 + 0.02 * np.sin(ANGLES), 0.07 - 0.02 * np.cos(ANGLES), -1e-3 * np.sin(ANGLES / 2)], axis=1)
SPEED = np.full(32, 0.04)
BUFFER = 127
QUICK = 1.5  # seconds of patience, where it must end


def draw_a_circle(robot: Grbl) -> Floats:
    robot.move(ABOVE)
    path = robot.stroke(CIRCLE, SPEED)
    robot.lift(ABOVE[2])
    return path


@pytest.mark.parametrize("pen", [None, SERVO])
def test_a_stroke_ends_up_where_it_was_commanded(pen: Pen | None) -> None:
    with FakeGrbl() as device, Grbl(device.port, pen) as robot:
        robot.move(ABOVE)
        before = len(device.reached)
        path = robot.stroke(CIRCLE, SPEED)
        drawn = np.array(device.reached[before:])
        assert device.place == pytest.approx(1e3 * path[-1] if pen is None else [*1e3 * path[-1, :2], 0], abs=1e-9)
        robot.lift(ABOVE[2])
    np.testing.assert_allclose(path, CIRCLE, atol=GCODE_METRES)
    if pen is None:
        np.testing.assert_allclose(1e-3 * drawn[:, :3], path, atol=1e-9)
    else:
        np.testing.assert_allclose(1e-3 * drawn[:, :2], path[1:, :2], atol=1e-9)
        assert set(drawn[:, 3]) == {SERVO.down}
        assert device.servo == SERVO.up


def test_a_machine_tells_its_own_limits() -> None:
    with FakeGrbl() as device, Grbl(device.port) as robot:
        assert robot.limits == Limits(
            lower=(0, 0, -0.06),
            upper=(0.3, 0.22, 0.06),
            speed=0.1,
            climb=0.02,
            acceleration=0.4,
            axes=(0.4, 0.4, 0.4),
            deviation=1e-5,
            varies_pressure=True,
            settling=25e-3 + 5e-3,  # of $1, and for the answer
        )


def test_a_machine_that_is_only_asked_for_its_limits_does_not_move() -> None:
    with FakeGrbl() as device:
        robot = Grbl(device.port, SERVO)
        servo = device.servo
        with robot.connected():
            pass
        assert robot.limits.upper[:2] == (0.3, 0.22)
        assert not device.reached
        assert device.servo == servo


def test_a_homed_machine_has_its_travel_below_its_own_origin() -> None:
    told = FakeGrbl(settings={**SETTINGS, 22: 1}, origin=(-280.0, -200.0, -30.0), start=(-280.0, -200.0, -20.0))
    with told as device, Grbl(device.port) as robot:
        assert robot.limits.lower == pytest.approx((-0.02, -0.02, -0.03))
        assert robot.limits.upper == pytest.approx((0.28, 0.2, 0.03))
        assert robot.place == pytest.approx((0, 0, 0.01))
        robot.move(ABOVE)
        assert device.place == pytest.approx((-230, -150, -25))


@pytest.mark.parametrize(("options", "corner"), [("VZ", (-0.01, -0.01, -0.04)), ("V", (-0.31, -0.23, -0.04))])
def test_a_machine_that_was_built_to_be_at_zero_at_its_switches_has_its_travel_above_those_it_homes_down_to(
    options: str, corner: tuple[float, float, float]
) -> None:
    settings = {**SETTINGS, 22: 1, 23: 0b011}
    with FakeGrbl(settings=settings, options=options, origin=(10.0, 10.0, -20.0)) as device:
        robot = Grbl(device.port)
        with robot.connected():
            assert robot.limits.lower == pytest.approx(corner)
            assert np.subtract(robot.limits.upper, robot.limits.lower) == pytest.approx((0.3, 0.22, 0.06))


def test_the_users_limits_narrow_the_machines() -> None:
    narrow = Limits(
        lower=(0.01, 0.01, -1),
        upper=(0.1, 1, 1),
        speed=0.05,
        climb=1,
        acceleration=5,
        varies_pressure=True,
        deviation=1,
    )
    with FakeGrbl() as device, Grbl(device.port, limits=narrow) as robot:
        assert (robot.limits.lower, robot.limits.upper) == ((0.01, 0.01, -0.06), (0.1, 0.22, 0.06))
        assert (robot.limits.speed, robot.limits.acceleration) == (0.05, 0.4)
        sent = len(device.lines)
        with pytest.raises(InputError, match=r"the machine's x is 110 mm"):
            robot.move(ABOVE + np.array([0.06, 0, 0]))
        assert len(device.lines) == sent


def test_a_sheet_lies_with_its_lower_left_corner_at_the_works_origin() -> None:
    easel = Grbl("nowhere", SERVO).easel(0.2, 0.16)
    np.testing.assert_allclose(
        easel.canvas_to_machine(np.array([[0, 0.16, 0], [0.2, 0, 0]])), [[0, 0, 0], [0.2, 0.16, 0]]
    )
    assert easel.pen == SERVO


@pytest.fixture(scope="module")
def session() -> Iterator[tuple[FakeGrbl, Grbl]]:
    with FakeGrbl(pace=2000) as device, Grbl(device.port) as robot:
        yield device, robot


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(seed=st.integers(0, 2**32 - 1), points=st.integers(1, 40), reach=st.floats(1e-4, 0.2))
def test_whatever_is_drawn_grbls_buffer_never_overflows_and_its_limits_are_kept(
    session: tuple[FakeGrbl, Grbl], seed: int, points: int, reach: float
) -> None:
    device, robot = session
    rng = np.random.default_rng(seed)
    limits = robot.limits
    path = np.array([0.15, 0.11, 0]) + rng.uniform(-reach, reach, (points, 3)) * (1, 1, 0.3)
    speed = rng.uniform(0.03, 0.1, points)
    try:
        limits.check_path(path)
        robot.move(np.array([*path[0, :2], 0.01]))
        robot.stroke(path, speed)
        robot.lift(0.01)
    except InputError:
        assert np.any((path < limits.lower) | (path > limits.upper))
    assert device.most_unread <= BUFFER
    reached = 1e-3 * np.array(device.reached)[:, :3]
    assert np.all((reached >= np.array(limits.lower) - 1e-9) & (reached <= np.array(limits.upper) + 1e-9))
    assert device.fastest <= 1e3 * limits.speed + 1e-6


def test_a_stroke_is_streamed_so_fast_that_the_machine_never_waits_for_its_next_line() -> None:
    zigzag = np.zeros((201, 3))
    zigzag[:, 0] = 0.05 + np.linspace(0, 0.1, 201)
    zigzag[:, 1] = 0.05
    with FakeGrbl() as device, Grbl(device.port, SERVO) as robot:
        robot.move(zigzag[0] + (0, 0, 0.005))
        before = device.seconds
        robot.stroke(zigzag, np.full(201, 0.06))
        took = device.seconds - before - SERVO.seconds
        assert took == pytest.approx(Profile.of(zigzag, np.full(201, 0.06), robot.limits).seconds, rel=CLOCK)


def test_late_answers_only_take_longer() -> None:
    with FakeGrbl(delay=0.02, pace=500) as device, Grbl(device.port, SERVO) as robot:
        path = draw_a_circle(robot)
        assert device.place[:2] == pytest.approx(1e3 * path[-1, :2])
        assert device.most_unread <= BUFFER


def test_reports_that_noise_has_changed_are_asked_for_again() -> None:
    with FakeGrbl(lost_reports=3) as device, Grbl(device.port, SERVO) as robot:
        draw_a_circle(robot)
        assert device.lost_reports == 0


GO_ON = r"then go on with paint\(\.\.\., resume=True\)$"
FAULTS = {
    "error:20": r"refused the line 'G1X.*' with error 20: it does not support a command of G-code$",
    "error:99": r"with error 99: it does not say what that means",
    "ALARM:1": r"raised alarm 1: a limit switch was hit and its position is lost; home it with maulstick "
    r"machine, or without switches turn it off and on with its pen at home",
    "ALARM:2": r"raised alarm 2: a motion would leave its travel; check where its work origin lies; home or unlock it",
    "ALARM:77": r"raised alarm 77: it does not say why; .* home or unlock it with maulstick machine",
    "noise": r"there is noise on the line to /dev/\S+ \('.*'\); check cable and ground; " + GO_ON,
    "lost": r"the line to /dev/\S+ went silent; check cable and power; " + GO_ON,
    "door": r"cannot draw: its safety door is open; close it",
    "Grbl 1.1h ['$' for help]": r"started again by itself; check its power; home it with maulstick machine",
}


@pytest.mark.parametrize(
    ("fault", "pen"), [*((fault, SERVO) for fault in FAULTS), ("error:20", None), ("ALARM:2", None)]
)
def test_a_fault_within_a_stroke_is_one_sentence_and_lifts_the_pen(fault: str, pen: Pen | None) -> None:
    with FakeGrbl(faults={25: fault}) as device:
        with Grbl(device.port, pen, patience=QUICK if fault in ("lost", "door") else 5) as robot:
            robot.move(ABOVE)
            with pytest.raises(MachineError, match=FAULTS[fault]) as caught:
                robot.stroke(CIRCLE, SPEED)
        assert "\n" not in str(caught.value)
        assert device.holds > 0 or fault in CRITICAL
        assert device.state == "Idle"
        if pen is None:
            assert device.place[2] == pytest.approx(1e3 * ABOVE[2])
        else:
            assert device.servo == pen.up
        with robot:
            draw_a_circle(robot)


@pytest.mark.parametrize("paper", [-10.0, 0.0, 10.0])
@pytest.mark.parametrize(
    ("fault", "told"), [("restart", "started again by itself"), ("noisy restart", "there is noise on the line")]
)
def test_a_machine_that_has_restarted_in_a_stroke_is_lifted_from_where_its_tip_then_was(
    paper: float, fault: str, told: str
) -> None:
    start = (50.0, 50.0, paper + 5)
    with FakeGrbl(origin=(0.0, 0.0, paper), start=start, faults={25: fault}) as device:
        with Grbl(device.port) as robot:
            robot.move(ABOVE)
            with pytest.raises(MachineError, match=told):
                robot.stroke(CIRCLE, SPEED)
        assert robot.lifted
        assert device.woke_at[2] < paper, "the tip was on the paper"
        assert device.place[2] >= 1e3 * ABOVE[2]


@pytest.mark.parametrize(
    ("fault", "told"),
    [("restart", r"started again by itself; .* home it"), ("noisy restart", "there is noise on the line")],
)
def test_a_machine_that_has_restarted_and_does_not_rise_says_so_and_stays_locked(fault: str, told: str) -> None:
    with FakeGrbl(**WITH_SWITCHES, faults={25: fault}) as device:
        with Grbl(device.port) as robot:
            robot.move(ABOVE)
            with pytest.raises(MachineError, match=told):
                robot.stroke(CIRCLE, SPEED)
        assert not robot.lifted
        assert device.state == "Alarm"


@pytest.mark.parametrize("fault", ["silent", "closed"])
def test_a_line_that_breaks_says_how_to_go_on(fault: str) -> None:
    with FakeGrbl(faults={25: fault}) as device, Grbl(device.port, SERVO, patience=QUICK) as robot:
        robot.move(ABOVE)
        with pytest.raises(
            MachineError,
            match=r"the line to /dev/\S+ went silent; check cable and power; " + GO_ON,
        ):
            robot.stroke(CIRCLE, SPEED)


@pytest.mark.parametrize("pen", [None, SERVO])
def test_a_stop_from_another_thread_halts_a_stroke_and_lifts_the_pen(pen: Pen | None) -> None:
    with FakeGrbl(pace=1, start=(50.0, 50.0, 5.0)) as device:
        with Grbl(device.port, pen) as robot:
            robot.move(ABOVE)

            def is_under_way() -> bool:
                return bool(np.linalg.norm(np.array(device.place)[:2] - 1e3 * ABOVE[:2]) > 10)

            with once(is_under_way, robot.stop), pytest.raises(StoppedError):
                robot.stroke(CIRCLE, SPEED)
            assert device.state == "Idle"  # no alarm: it braked before it was reset
            at = np.array(device.place)
            assert 10 < np.linalg.norm(at[:2] - 1e3 * ABOVE[:2]) < 40  # under way
            assert device.servo == pen.up if pen is not None else at[2] == pytest.approx(1e3 * ABOVE[2])
            with pytest.raises(StoppedError):
                robot.move(ABOVE)
        with Grbl(device.port, pen) as robot:
            assert robot.place[:2] == pytest.approx(1e-3 * at[:2], abs=1e-6)


@pytest.mark.parametrize("pen", [None, SERVO])
def test_after_a_stop_it_is_entered_again_on_the_same_connection(pen: Pen | None) -> None:
    with FakeGrbl(pace=5, start=(50.0, 50.0, 5.0)) as device:
        robot = Grbl(device.port, pen)
        with robot.connected():
            with robot:
                robot.move(ABOVE)
                with once(lambda: device.place[0] > 1e3 * ABOVE[0] + 1, robot.stop), pytest.raises(StoppedError):
                    robot.stroke(CIRCLE, SPEED)
            with robot:
                robot.move(ABOVE)
                assert device.place[:2] == pytest.approx(1e3 * ABOVE[:2])


def test_after_a_stop_while_it_is_entered_nothing_moves_any_more() -> None:
    brakes_at_once = SETTINGS | dict.fromkeys((120, 121, 122), 4000.0)
    with FakeGrbl(brakes_at_once, start=(0.0, 0.0, -50.0), pace=4.0) as device:
        robot = Grbl(device.port)
        with once(lambda: device.place[2] > -45, robot.stop), pytest.raises(StoppedError), robot:
            pytest.fail("it was entered")
        held = device.place
        time.sleep(0.3)
        assert (device.state, device.place) == ("Hold:0", held)


@pytest.mark.parametrize("pen", [None, SERVO])
@pytest.mark.parametrize("stopped", [True, False])
def test_a_pen_that_stays_down_after_a_stroke_is_lifted_by_a_stop_and_on_leaving(
    pen: Pen | None, stopped: bool
) -> None:
    with FakeGrbl() as device:
        with Grbl(device.port, pen) as robot:
            robot.move(ABOVE)
            robot.stroke(CIRCLE, SPEED)
            if stopped:
                robot.stop()
                with pytest.raises(StoppedError):
                    robot.lift(ABOVE[2])
            elif pen is None:
                assert device.place[2] < 0.1
        assert robot.lifted
        assert device.servo == pen.up if pen is not None else device.place[2] == pytest.approx(1e3 * ABOVE[2])


def test_an_interrupt_within_a_stroke_lifts_the_pen(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt() -> None:
        raise KeyboardInterrupt

    with FakeGrbl() as device, Grbl(device.port) as robot:
        robot.move(ABOVE)
        monkeypatch.setattr(robot._stream, "_go_on", interrupt)
        with pytest.raises(KeyboardInterrupt):
            robot.stroke(CIRCLE, SPEED)
        assert device.place[2] == pytest.approx(1e3 * ABOVE[2])


def test_a_machine_that_is_held_by_its_own_button_goes_on_by_its_own_button() -> None:
    with FakeGrbl(pace=5, start=(50.0, 50.0, 5.0)) as device, Grbl(device.port, SERVO, patience=QUICK) as robot:
        robot.move(ABOVE)

        def is_under_way() -> bool:
            return bool(np.linalg.norm(np.array(device.place)[:2] - 1e3 * ABOVE[:2]) > 10)

        def hold_for_longer_than_its_patience() -> None:
            device.press_hold()
            while device.state != "Hold:0":
                time.sleep(0.01)
            time.sleep(2 * QUICK)
            device.press_start()

        with once(is_under_way, hold_for_longer_than_its_patience):
            path = robot.stroke(CIRCLE, SPEED)
        assert device.place[:2] == pytest.approx(1e3 * path[-1, :2])


def test_a_stop_at_rest_leaves_no_hold_though_an_older_report_comes_first() -> None:
    with FakeGrbl(delay=0.3) as device:  # later than the next report is asked for
        with Grbl(device.port) as robot:
            robot.move(ABOVE)
            robot.stop()
        until = time.monotonic() + 30
        while device.state != "Idle" and time.monotonic() < until:
            time.sleep(0.01)
        assert (device.holds, device.state) == (1, "Idle")


def test_braking_waits_for_rest_though_a_report_from_before_the_motion_comes_first() -> None:
    class Line:
        port = "a port"

        def __init__(self) -> None:
            self.reports = [f"<{state}|MPos:0,0,0>" for state in ("Idle", "Run", "Hold:1", "Hold:0", "Hold:0")]

        def write(self, content: bytes) -> None: ...

        def line(self) -> str | None:
            return self.reports.pop(0)

    line = Line()
    GrblStream(cast(SerialLine, line), 30, Stopping()).hold()
    assert line.reports == []


@pytest.mark.parametrize("reports", [0, 1])
def test_offsets_that_other_programs_left_and_either_kind_of_report_are_understood(reports: int) -> None:
    told = FakeGrbl(
        settings={**SETTINGS, 10: reports}, origin=(10.0, 20.0, 0.0), shift=(5.0, 0.0, 1.0), start=(15.0, 20.0, 9.0)
    )
    with told as device, Grbl(device.port) as robot:
        assert robot.place == pytest.approx((0, 0, 0.008))
        robot.move(ABOVE)
        assert device.place == pytest.approx((65, 70, 6))


def test_a_port_that_is_closed_does_not_restart_its_board_when_it_is_opened_again() -> None:
    with FakeGrbl() as device:
        entered(Grbl(device.port))
        port = os.open(device.port, os.O_RDWR | os.O_NOCTTY)
        try:
            assert not termios.tcgetattr(port)[2] & termios.HUPCL
        finally:
            os.close(port)


def entered(robot: Grbl) -> None:
    with robot:
        pass


def test_a_locked_machine_is_not_unlocked_behind_its_operators_back() -> None:
    with FakeGrbl(locked=True) as device:
        sentence = "it is locked, as its position may be lost; home or unlock it with maulstick machine, then start"
        with pytest.raises(LockedError, match=sentence):
            entered(Grbl(device.port))
        assert "$X" not in device.lines


def test_a_machine_that_finds_home_by_its_switches_is_unlocked_and_waited_for() -> None:
    with FakeGrbl(locked=True, homing=0.5, **WITH_SWITCHES) as device:
        robot = Grbl(device.port, patience=0.3)
        robot.find_home()
        assert device.state == "Idle"
        with robot:
            assert robot.place == pytest.approx((0.099, 0.099, 0.019))


def test_a_machine_is_unlocked_where_it_stands() -> None:
    with FakeGrbl(locked=True, start=(20.0, 10.0, 0.0)) as device:
        robot = Grbl(device.port)
        robot.unlock()
        with robot:
            assert robot.place[:2] == pytest.approx((0.02, 0.01))


def test_a_machine_without_switches_is_not_homed_but_stays_locked() -> None:
    with FakeGrbl(locked=True) as device:
        with pytest.raises(InputError, match=r"has no switches to find home by \(\$22=0\); unlock it if its pen"):
            Grbl(device.port).find_home()
        assert (device.state, "$H" in device.lines) == ("Alarm", False)


def test_a_servo_holds_the_pen_up_while_a_machine_that_is_not_locked_finds_home() -> None:
    with FakeGrbl(**WITH_SWITCHES) as device:
        Grbl(device.port, SERVO).find_home()
        assert (device.state, device.servo) == ("Idle", SERVO.up)


def test_a_machine_that_was_told_to_stop_does_not_begin_to_look_for_home() -> None:
    with FakeGrbl(locked=True, **WITH_SWITCHES) as device:
        robot = Grbl(device.port)
        robot.stop()
        with pytest.raises(StoppedError):
            robot.find_home()
        assert "$H" not in device.lines


def test_a_search_for_home_at_no_speed_is_refused() -> None:
    with FakeGrbl(locked=True, settings=SETTINGS | {22: 1, 24: 0}) as device:
        with pytest.raises(InputError, match=r"is to look for home at no speed; set \$24 and \$25 above 0"):
            Grbl(device.port).find_home()
        assert "$H" not in device.lines


def test_a_search_for_home_that_takes_too_long_is_stopped() -> None:
    short = {"settings": SETTINGS | {22: 1, 25: 1e6, 24: 1e6}}
    with FakeGrbl(locked=True, homing=60.0, **short) as device:
        with pytest.raises(MachineError, match="went silent"):
            Grbl(device.port, patience=0.3).find_home()
        assert device.state == "Alarm"


def test_a_machine_that_does_not_tell_how_long_its_way_home_is_is_not_homed() -> None:
    told = {number: value for number, value in SETTINGS.items() if number != 25} | {22: 1}
    with FakeGrbl(locked=True, settings=told) as device:
        with pytest.raises(MachineError, match=r"did not tell its setting \$25"):
            Grbl(device.port).find_home()
        assert "$H" not in device.lines


@pytest.mark.parametrize(
    ("number", "value", "pen", "sentence"),
    [
        (13, 1, None, r"reports in inches; send \$13=0"),
        (32, 1, SERVO, r"is in laser mode, which moves the servo; send \$32=0"),
        (30, 600, SERVO, r"the pen's down is 700; it must be 0 to 600 \(\$31 to \$30 of this Grbl\)"),
    ],
)
def test_settings_that_would_spoil_a_drawing_are_refused(
    number: int, value: float, pen: Pen | None, sentence: str
) -> None:
    with FakeGrbl(settings={**SETTINGS, number: value}) as device:
        with pytest.raises((MachineError, InputError), match=sentence):
            entered(Grbl(device.port, pen))
        assert device.place == (0, 0, 0)


def test_a_setting_that_is_not_told_is_named() -> None:
    told = {number: value for number, value in SETTINGS.items() if number != 120}
    with FakeGrbl(settings=told) as device, pytest.raises(MachineError, match=r"did not tell its setting \$120"):
        entered(Grbl(device.port))


@pytest.mark.parametrize(
    ("number", "told"),
    [
        (131, r"travel along y \(\$131=0\); set \$131 to what it is, in mm"),
        (112, r"speed along z \(\$112=0\); set \$112 to what it is, in mm/min"),
        (120, r"acceleration along x \(\$120=0\); set \$120 to what it is, in mm/s²"),
    ],
)
def test_a_machine_that_cannot_move_along_an_axis_says_which_setting_to_mend(number: int, told: str) -> None:
    sentence = rf"^the Grbl on \S+ has no {told}$"
    with FakeGrbl(settings={**SETTINGS, number: 0}) as device, pytest.raises(InputError, match=sentence):
        entered(Grbl(device.port))


@pytest.mark.parametrize("number", [112, 122, 132])
def test_a_servo_needs_no_height_that_the_machine_could_move_to(number: int) -> None:
    with FakeGrbl(settings={**SETTINGS, number: 0}) as device, Grbl(device.port, SERVO) as robot:
        draw_a_circle(robot)
        assert device.servo == SERVO.up
        assert device.place == pytest.approx((*1e3 * CIRCLE[-1, :2], 0), abs=1e3 * GCODE_METRES)


@pytest.mark.parametrize("reports", [0, 1])
def test_a_machine_with_more_than_three_axes_is_driven_along_the_first_three(reports: int) -> None:
    more, origin = (7.0, -90.0), (10.0, 20.0, 1.0)
    with FakeGrbl(settings={**SETTINGS, 10: reports}, origin=origin, more_axes=more) as device:
        with Grbl(device.port) as robot:
            assert robot.place == pytest.approx((-0.01, -0.02, 0.005))
            path = draw_a_circle(robot)
        assert device.place[:2] == pytest.approx(1e3 * path[-1, :2] + origin[:2], abs=1e-9)


@pytest.mark.parametrize("kind", ["Grbl 0.9j", "Grbl 3.7", "GrblHAL 1.1f"])
def test_another_grbl_is_refused_by_its_name(kind: str) -> None:
    sentence = rf"is a {re.escape(kind)}; it must be a Grbl 1\.1, or be given a file"
    with FakeGrbl(banner=f"{kind} ['$' for help]") as device, pytest.raises(MachineError, match=sentence):
        entered(Grbl(device.port))


def test_a_machine_that_a_killed_run_left_moving_is_stopped_and_keeps_its_place() -> None:
    with FakeGrbl(pace=1) as device:
        line = SerialLine(device.port, 115200)
        line.write(b"G1 X100 F600\n")
        while device.place[0] < 1:
            time.sleep(0.01)
        line.close()
        with Grbl(device.port) as robot:
            assert 1 < device.place[0] < 100
            assert robot.place[:2] == pytest.approx([1e-3 * device.place[0], 0], abs=GCODE_METRES)


def test_a_port_where_nothing_answers_is_named() -> None:
    with FakeGrbl(banner="") as device, pytest.raises(MachineError, match=rf"no Grbl answers on {device.port}; check"):
        entered(Grbl(device.port, patience=QUICK))


def test_a_port_that_is_absent_or_in_use_is_refused() -> None:
    with pytest.raises(InputError, match=r"cannot open the port /dev/absent: .*is it plugged in"):
        entered(Grbl("/dev/absent"))
    sentence = r"cannot open the port .* free"
    with FakeGrbl() as device, Grbl(device.port), pytest.raises(InputError, match=sentence):
        entered(Grbl(device.port))


@pytest.mark.parametrize("address", ["/dev/null", __file__])
def test_what_is_no_serial_port_is_said_to_be_none(address: str) -> None:
    with pytest.raises(InputError, match=rf"cannot open the port {address}: it is no serial port; is it plugged in"):
        entered(Grbl(address))


def test_a_baud_rate_comes_after_an_at_sign() -> None:
    with FakeGrbl() as device, Grbl(f"{device.port}@57600") as robot:
        assert robot.place[2] > 0
    with pytest.raises(InputError, match=r"the baud rate of a Grbl is 'fast'; it must be a whole number"):
        Grbl("/dev/ttyUSB0@fast")
    with FakeGrbl() as device, pytest.raises(InputError, match=r"the baud rate is 99999999999; it must be one that"):
        entered(Grbl(f"{device.port}@99999999999"))


@pytest.mark.parametrize("pen", [None, SERVO])
def test_a_tip_that_was_put_beside_its_limits_is_lifted_there_and_moves_into_them(pen: Pen | None) -> None:
    with FakeGrbl(start=(-3, 0, 0)) as device, Grbl(device.port, pen) as robot:
        assert robot.lift(0.02) == pytest.approx([-0.003, 0, 0.02])
        with pytest.raises(InputError, match="the machine's z is 100 mm"):
            robot.lift(0.1)
        robot.move(np.array([0, 0, 0.02]))
        assert device.place == pytest.approx((0, 0, 20 if pen is None else 0))


def test_every_code_of_grbl_1_1_has_its_words() -> None:
    assert set(ERRORS) == {*range(1, 18), *range(20, 39)}
    assert set(ALARMS) == set(range(1, 10))
    assert all("\n" not in said for said in [*ERRORS.values(), *ALARMS.values()])


def test_a_report_tells_state_and_place_of_machine_or_work() -> None:
    machine = Status.parse("<Hold:1|MPos:1.000,-2.000,3.500|Bf:15,128|FS:500,0|Pn:XYZ|WCO:0.000,0.000,0.000>")
    assert machine is not None
    assert (machine.state, machine.tip.tolist(), machine.of_machine) == ("Hold:1", [0.001, -0.002, 0.0035], True)
    work = Status.parse("<Idle|WPos:0.000,0.000,0.000|FS:0,0>")
    assert work is not None
    assert not work.of_machine
    assert Status.parse("<Idle|MPos:1.0\xfe0,0.000,0.000|FS:0,0>") is None
