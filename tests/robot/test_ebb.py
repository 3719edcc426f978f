import time
from collections.abc import Callable, Iterator
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from serial.tools import list_ports

from maulstick.errors import InputError, MachineError
from maulstick.robot.adapters.axidraw import AxiDraw
from maulstick.robot.easel import Pen
from maulstick.robot.limits import SLACK, Limits
from maulstick.robot.robot import StoppedError
from maulstick.robot.timing import Profile
from maulstick.storage.arrays import Floats
from tests.support.robot.fake_ebb import POWERED, SERVO_REST, UNPOWERED, FakeEbb
from tests.support.robot.under_way import once
from tests.support.tolerances import CLOCK, STEP_METRES

PEN = Pen(up=20000, down=15000, seconds=0.1)
ABOVE = np.array([0.05, -0.05, 0.005])
ANGLES = np.linspace(0, 2 * np.pi, 32)
CIRCLE = np.stack([0.05 + 0.02 * np.sin(ANGLES), -0.07 + 0.02 * np.cos(ANGLES), 0 * ANGLES], axis=1)
SPEED = np.full(32, 0.04)
VERSIONS = ("2.7.0", "2.8.1", "3.0.2")  # of firmware: the first cannot say whether its motors hold
QUICK = 1.5  # seconds of patience, where it must end


def places_of(motors: list[tuple[int, int]]) -> Floats:
    """Return the pen (n, 2), metres, for steps of both motors since home, y up, independently of the package."""
    first, second = np.array(motors, dtype=np.float64).reshape(-1, 2).T
    return np.stack([first + second, second - first], axis=1) / 2 / 80e3


def commanded(commands: list[str]) -> Floats:
    """Return the places (n, 2) where motions end, from home."""
    steps = [tuple(map(int, command.split(",")[2:])) for command in commands if command.startswith("SM")]
    return places_of(np.cumsum(np.array(steps).reshape(-1, 2), axis=0).tolist())


def until_true(condition: Callable[[], bool]) -> bool:
    """Wait until it holds; a minute at most."""
    ends = time.monotonic() + 60
    while not condition() and time.monotonic() < ends:
        time.sleep(0.01)
    return condition()


def test_a_stroke_passes_its_points_to_a_step_and_none_is_lost() -> None:
    with FakeEbb() as device, AxiDraw(device.port, PEN) as robot:
        robot.move(ABOVE)
        before = len(device.reached)
        path = robot.stroke(CIRCLE, SPEED)
        drawn = device.reached[before:]
        robot.lift(0.005)
        np.testing.assert_allclose(path, CIRCLE, atol=STEP_METRES)
        reached = places_of([(first, second) for first, second, _ in drawn])
        assert max(np.abs(reached - point).max(axis=1).min() for point in CIRCLE[:, :2]) < STEP_METRES
        np.testing.assert_allclose(commanded(device.commands)[-1], path[-1, :2], atol=1e-12)
        assert {down for _, _, down in drawn} == {True}
        assert not device.down
        assert not device.refused


def test_its_arm_reaches_down_the_sheet_and_both_motors_move_it() -> None:
    with FakeEbb() as device, AxiDraw(device.port, PEN) as robot:
        robot.move(np.array([0.1, 0, 0]))
        assert device.steps == (8000, 8000)
        robot.move(np.array([0.1, -0.1, 0]))
        assert device.steps == (16000, 0)


def test_a_motion_takes_as_long_as_its_profile() -> None:
    with FakeEbb() as device, AxiDraw(device.port, PEN) as robot:
        robot.move(ABOVE)
        before = device.seconds
        robot.stroke(CIRCLE, SPEED)
        profile = Profile.of(CIRCLE, SPEED, robot.limits)
        assert device.seconds - before == pytest.approx(PEN.seconds + profile.seconds, rel=CLOCK)


def test_the_servo_gets_its_positions_and_its_time() -> None:
    with FakeEbb() as device, AxiDraw(device.port, PEN) as robot:
        robot.stroke(np.zeros((1, 3)), np.array([0.1]))
        assert [command for command in device.commands if command[:2] in ("SC", "SP")] == [
            "SC,4,20000",
            "SC,5,15000",
            "SP,1,100",
            "SP,0,100",
        ]
        assert robot.limits.lifting == PEN.seconds


@pytest.mark.parametrize("version", VERSIONS)
def test_it_knows_its_place_when_it_is_entered_again(version: str) -> None:
    with FakeEbb(version=version) as device:
        with AxiDraw(device.port, PEN) as robot:
            robot.move(ABOVE)
        with AxiDraw(device.port, PEN) as robot:
            assert robot.place[:2] == pytest.approx(ABOVE[:2], abs=STEP_METRES)
        assert device.commands.count("EM,1,1") == 1


@pytest.mark.parametrize("version", VERSIONS)
def test_a_pen_that_is_not_where_it_may_be_is_not_moved(version: str) -> None:
    with FakeEbb(version=version, steps=(-4000, -4000)) as device:
        robot = AxiDraw(device.port, PEN)
        with pytest.raises(MachineError, match=r"plug them in at its home: the machine's x is -50 mm"):
            robot.__enter__()
        assert device.steps == (-4000, -4000)


@pytest.mark.parametrize("steps", [(8000, 8001), (8001, -8000), (-1, 0), (0, 1)])
def test_a_stop_between_the_steps_of_its_motors_along_an_edge_leaves_the_pen_on_the_edge(
    steps: tuple[int, int],
) -> None:
    with FakeEbb(steps=steps) as device, AxiDraw(device.port, PEN) as robot:
        robot.limits.check_path(robot.place[None])
        assert robot.place[:2] == pytest.approx(places_of([steps])[0], abs=STEP_METRES)
        robot.limits.check_path(robot.lift(0.005)[None])
        robot.move(np.zeros(3))
        assert device.steps == (0, 0)


def test_it_lifts_its_pen_at_home_where_an_easel_leaves_that_out() -> None:
    narrow = Limits(
        lower=(0.01, -0.2, -0.1), upper=(0.2, -0.01, 0.1), speed=1, climb=1, acceleration=5, varies_pressure=True
    )
    with FakeEbb() as device, AxiDraw(device.port, PEN, narrow) as robot:
        assert robot.lift(0.005).tolist() == [0, 0, 0.005]
        robot.move(ABOVE)
        assert places_of([device.steps])[0] == pytest.approx(ABOVE[:2])


@pytest.mark.parametrize(("enabled", "divided"), [(False, 16), (True, 8)])
def test_what_another_program_left_away_from_home_is_no_place(enabled: bool, divided: int) -> None:
    with FakeEbb(version="2.8.1", steps=(8000, 0), enabled=enabled, divided=divided) as device:
        with pytest.raises(MachineError, match="another program left the AxiDraw away from home, with motors that do"):
            AxiDraw(device.port, PEN).__enter__()
        assert (device.steps, device.down) == ((8000, 0), False)
    with FakeEbb(version="2.8.1", enabled=enabled, divided=divided) as device:
        robot = AxiDraw(device.port, PEN)
        with robot:
            robot.move(ABOVE)
            assert (device.enabled, device.divided) == (True, 16)
        with robot:
            assert robot.place[:2] == pytest.approx(ABOVE[:2], abs=STEP_METRES)


@pytest.fixture(scope="module")
def session() -> Iterator[tuple[FakeEbb, AxiDraw]]:
    narrow = Limits(
        lower=(0.0100033, -0.1, -0.1),
        upper=(0.15, -0.0099977, 0.1),
        speed=1,
        climb=1,
        acceleration=5,
        varies_pressure=True,
    )
    with FakeEbb(pace=2000, steps=(8000, 0)) as device, AxiDraw(device.port, PEN, narrow) as robot:
        yield device, robot


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), points=st.integers(1, 20), reach=st.floats(1e-4, 0.06))
def test_whatever_is_drawn_it_stays_within_its_limits_and_its_motors_speed(
    session: tuple[FakeEbb, AxiDraw], seed: int, points: int, reach: float
) -> None:
    device, robot = session
    rng = np.random.default_rng(seed)
    limits = robot.limits
    path = np.array([0.05, -0.05, 0]) + rng.uniform(-reach, reach, (points, 3))
    if rng.uniform() < 0.5:
        path = np.clip(path, limits.lower, limits.upper)
    try:
        limits.check_path(path)
        robot.move(path[0])
        robot.stroke(path, rng.uniform(0.02, limits.speed, points))
        robot.lift(0)
    except InputError:
        assert np.any((path < limits.lower) | (path > limits.upper))
    reached = np.array([0.05, -0.05]) + commanded(device.commands)
    assert np.all(reached >= np.array(limits.lower[:2]) - SLACK)
    assert np.all(reached <= np.array(limits.upper[:2]) + SLACK)
    assert not device.refused


NO_POWER = "motors have no power; plug its supply in, and push its pen to the home corner$"
GO_ON = r"then go on with paint\(\.\.\., resume=True\)$"
FAULTS = {
    "!5 Err: <axis1> step rate out of range.": r"refused 'SM,.*': 5 Err: <axis1> step rate out of range\.$",
    "!0 Err: <axis2> step rate > 25K steps/second.\r\nOK": r"refused 'SM,.*': 0 Err: <axis2> step rate > 25K steps",
    "unpowered": r"motors have no power; plug its supply in, and push its pen to the home corner; " + GO_ON,
    "noise": r"there is noise on the line to /dev/\S+ \('.*'\); check cable and hub; " + GO_ON,
    "silent": r"the line to /dev/\S+ went silent; check cable and power; " + GO_ON,
    "closed": r"the line to /dev/\S+ went silent",
}


def drawn(robot: AxiDraw) -> None:
    """Draw a stroke from its beginning to its end."""
    robot.stroke(CIRCLE, SPEED)
    robot.lift(0.005)


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_within_a_stroke_is_one_sentence_and_lifts_the_pen(fault: str) -> None:
    with FakeEbb(faults={60: fault}) as device:
        with AxiDraw(device.port, PEN, patience=QUICK if fault == "silent" else 5) as robot:
            robot.move(ABOVE)
            with pytest.raises(MachineError, match=FAULTS[fault]) as caught:
                drawn(robot)
        assert "\n" not in str(caught.value)
        if fault != "closed":
            assert device.stops > 0
        if fault not in ("silent", "closed"):
            assert not device.down
            device.supply = POWERED
            with robot:
                assert robot.place[:2] == pytest.approx(places_of([device.steps])[0])


def test_motors_without_power_are_noticed_before_anything_moves() -> None:
    with FakeEbb(supply=UNPOWERED) as device:
        with pytest.raises(MachineError, match=NO_POWER):
            AxiDraw(device.port, PEN).__enter__()
        assert not device.down
        assert not device.reached[1:]  # the pen alone was lifted


def test_motors_that_lost_their_power_have_lost_their_place_and_turn_freely_to_the_home_corner() -> None:
    with FakeEbb() as device:
        with AxiDraw(device.port, PEN) as robot:
            robot.move(ABOVE)
            robot.stroke(CIRCLE[:2], SPEED[:2])
            device.supply = UNPOWERED
            with pytest.raises(MachineError, match="no power"):
                robot.lift(0.005)
        assert (device.steps, device.enabled, device.down) == ((0, 0), False, False)
        device.supply = POWERED
        with AxiDraw(device.port, PEN) as robot:
            assert robot.place.tolist() == [0, 0, 0]
            assert device.enabled


def test_a_pen_that_was_not_moved_above_its_stroke_is_not_lowered() -> None:
    with FakeEbb() as device, AxiDraw(device.port, PEN) as robot:
        device.supply = UNPOWERED
        robot.move(ABOVE)
        with pytest.raises(MachineError, match="no power"):
            robot.stroke(CIRCLE, SPEED)
        assert "SP,0,100" not in device.commands


def test_a_supply_of_nine_volts_is_enough_on_any_board_and_the_five_of_usb_are_on_none() -> None:
    for divider in (11, 9.2):  # of boards before 2.3, and since
        of_supply, of_usb = (int((volts - 0.3) / divider / 3.3 * 1023) for volts in (9, 5))
        with FakeEbb(supply=of_supply) as device, AxiDraw(device.port, PEN):
            pass
        with FakeEbb(supply=of_usb) as device, pytest.raises(MachineError, match="no power"):
            AxiDraw(device.port, PEN).__enter__()


def test_the_servo_holds_the_pen_however_long_a_person_needs_and_rests_afterwards() -> None:
    with FakeEbb(pace=2000) as device:
        with AxiDraw(device.port, PEN):
            until = device.clock + 2 * SERVO_REST / 1000
            assert until_true(lambda: device.clock > until)
            assert device.servo_is_powered
        assert until_true(lambda: not device.servo_is_powered)


def test_firmware_whose_servo_never_rests_is_not_told_how_long() -> None:
    with FakeEbb(version="2.5.9") as device, AxiDraw(device.port, PEN):
        assert device.servo_is_powered
    assert not device.refused


def test_the_button_is_pressed_once_per_press_and_not_before_painting() -> None:
    with FakeEbb(button=True) as device, AxiDraw(device.port, PEN) as robot:
        assert not robot.pause_pressed()
        device.button = True
        assert robot.pause_pressed()
        assert not robot.pause_pressed()


@pytest.mark.parametrize("torn", [b"SM,25,1", b"SP", b"\x00"])
def test_what_a_broken_line_left_of_a_command_spoils_none(torn: bytes) -> None:
    with FakeEbb(unread=torn) as device, AxiDraw(device.port, PEN, patience=QUICK) as robot:
        assert robot.place.tolist() == [0, 0, 0]


def test_the_slowest_stroke_is_no_slice_that_the_board_refuses() -> None:
    with FakeEbb(pace=2000) as device, AxiDraw(device.port, PEN) as robot:
        path = np.array([(0, 0, 0), (1e-4, 0, 0), (1e-4, 0, 0), (1e-4, -2e-5, 0)])
        robot.stroke(path, np.full(4, 1e-4))
        assert device.steps == (10, 6)  # 8 along x, and 2 (1.6 rounded) across
        assert not device.refused


def test_late_answers_only_take_longer() -> None:
    with FakeEbb(delay=0.005) as device, AxiDraw(device.port, PEN) as robot:
        robot.move(ABOVE)
        path = robot.stroke(CIRCLE, SPEED)
        assert places_of([device.steps])[0] == pytest.approx(path[-1, :2])


@pytest.mark.parametrize("version", VERSIONS)
def test_a_stop_from_another_thread_halts_a_stroke_and_lifts_the_pen(version: str) -> None:
    with FakeEbb(version=version, pace=1, steps=(8000, 0)) as device:  # at its place already
        with AxiDraw(device.port, PEN) as robot:

            def is_under_way() -> bool:
                return bool(np.linalg.norm(places_of([device.steps])[0] - ABOVE[:2]) > 0.01)

            with once(is_under_way, robot.stop), pytest.raises(StoppedError):
                robot.stroke(CIRCLE, SPEED)
        at = places_of([device.steps])[0]
        assert 0.01 < np.linalg.norm(at - ABOVE[:2]) < 0.04  # under way
        assert not device.down
        assert device.seconds < 1.2
        with robot:
            assert robot.place[:2] == pytest.approx(at)


@pytest.mark.parametrize("future", [True, False])
def test_a_board_that_another_program_left_in_its_new_syntax_is_driven_as_ever(future: bool) -> None:
    with FakeEbb(version="3.0.2", future=future, queue=16) as device, AxiDraw(device.port, PEN) as robot:
        robot.move(ABOVE)
        path = robot.stroke(CIRCLE, SPEED)
        robot.lift(0.005)
        assert places_of([device.steps])[0] == pytest.approx(path[-1, :2])
        assert (device.future, device.queue, device.refused) == (False, 1, [])


def test_older_firmware_is_refused() -> None:
    with (
        FakeEbb(version="2.4.3") as device,
        pytest.raises(MachineError, match=r"has firmware 2\.4\.3; update it to 2\.4\.4"),
    ):
        AxiDraw(device.port, PEN).__enter__()


def a_port(device: str, vid: int, pid: int) -> SimpleNamespace:
    return SimpleNamespace(device=device, vid=vid, pid=pid)


def test_the_one_that_is_plugged_in_is_found_by_its_usb_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    other = a_port("/dev/ttyUSB0", 0x1A86, 0x7523)
    with FakeEbb() as device:
        monkeypatch.setattr(list_ports, "comports", lambda: [other, a_port(device.port, 0x04D8, 0xFD92)])
        with AxiDraw(pen=PEN) as robot:
            assert robot.place.tolist() == [0, 0, 0]
    monkeypatch.setattr(list_ports, "comports", lambda: [other])
    with pytest.raises(InputError, match="no AxiDraw is plugged in; connect its USB cable and power"):
        AxiDraw(pen=PEN).__enter__()
    monkeypatch.setattr(list_ports, "comports", lambda: [a_port(name, 0x04D8, 0xFD92) for name in ("/b", "/a")])
    with pytest.raises(InputError, match="there are several AxiDraws; name one of their ports: /a, /b"):
        AxiDraw(pen=PEN).__enter__()


def test_a_sheet_lies_with_its_upper_left_corner_at_home() -> None:
    easel = AxiDraw(pen=PEN).easel(0.297, 0.21)
    np.testing.assert_allclose(
        easel.canvas_to_machine(np.array([[0, 0, 0], [0.297, 0.21, 0]])), [[0, 0, 0], [0.297, -0.21, 0]]
    )


def test_a_pen_beyond_the_servos_pulses_is_refused() -> None:
    with pytest.raises(InputError, match=r"the pen's up is 60; it must be 6000 to 30000"):
        AxiDraw(pen=Pen(up=60, down=30))
