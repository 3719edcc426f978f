from collections.abc import Callable
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.errors import InputError
from maulstick.robot.adapters.axidraw import AxiDraw
from maulstick.robot.adapters.grbl import Grbl
from maulstick.robot.bench import SQUARE, Bench
from maulstick.robot.easel import Easel, Pen
from maulstick.robot.limits import SLACK, Limits
from tests.support.robot.fake_ebb import FakeEbb
from tests.support.robot.fake_grbl import SETTINGS, FakeGrbl
from tests.support.robot.recorder import EASEL, LIMITS, Recorder

SIZE = (0.06, 0.04)
SERVO = Pen(up=700, down=500, seconds=0.01)
PULSES = Pen(up=20000, down=15000, seconds=0.01)
doings = st.lists(
    st.one_of(
        st.tuples(st.just("jog"), st.integers(0, 2), st.floats(-0.3, 0.3)),
        st.sampled_from([("outline",), ("square",), ("lower",), ("lift",), ("go_home",)]),
        st.tuples(st.just("set_origin"), st.sampled_from(["corner", "paper"])),
    ),
    max_size=8,
)


@given(doings, st.booleans())
def test_nothing_that_is_done_by_hand_leaves_the_limits_or_moves_with_the_pen_down(
    doings: list[tuple[str, ...]], varies: bool
) -> None:
    robot = Recorder(LIMITS.model_copy(update={"varies_pressure": varies}))
    with robot:
        bench = Bench(robot, EASEL, SIZE)
        for what, *words in doings:
            with suppress(InputError):
                getattr(bench, what)(*words)
    for _, path in robot.commands:
        assert np.all(path >= np.array(LIMITS.lower) - SLACK)
        assert np.all(path <= np.array(LIMITS.upper) + SLACK)
    assert not robot.down


def test_a_step_outside_the_limits_is_refused_and_nothing_moves() -> None:
    with Recorder() as robot:
        bench = Bench(robot, EASEL, SIZE)
        with pytest.raises(InputError, match=r"the machine's x is 210 mm; it must be -100 to 200 mm"):
            bench.jog(0, 0.16)
        assert robot.said == []
        bench.jog(0, 0.01)
        assert robot.said == ["move"]


def test_the_outline_goes_around_the_sheet_with_the_pen_lifted_and_comes_back() -> None:
    with Recorder() as robot:
        bench = Bench(robot, EASEL, SIZE)
        start = robot.place
        bench.outline()
        path = np.concatenate([path for _, path in robot.commands])
        assert set(robot.said) == {"move"}
        np.testing.assert_allclose(robot.place[:2], start[:2])
        for corner in [(0, 0), (0.06, 0), (0.06, -0.04), (0, -0.04)]:
            assert np.abs(path[:, :2] - corner).max(axis=1).min() < SLACK
        assert path[:, 2].min() >= EASEL.travel - SLACK


def test_a_pen_at_home_beside_the_limits_of_its_easel_goes_into_them_and_around_the_sheet() -> None:
    narrow = Limits(
        lower=(0.01, -0.2, -0.1), upper=(0.2, -0.01, 0.1), speed=1, climb=1, acceleration=5, varies_pressure=True
    )
    easel = Easel(corner=(0.02, -0.03, 0), right=(1, 0, 0), down=(0, -1, 0), limits=narrow, pen=PULSES)
    for what, end in {"go_home": (0.02, -0.03), "outline": (0.01, -0.01)}.items():
        with FakeEbb() as device, AxiDraw(device.port, PULSES, narrow) as robot:
            getattr(Bench(robot, easel, SIZE), what)()
            assert robot.place[:2] == pytest.approx(end)


def test_an_outline_that_does_not_fit_moves_nothing() -> None:
    with Recorder() as robot:
        with pytest.raises(InputError, match="mm less far"):
            Bench(robot, EASEL, (0.5, 0.04)).outline()
        with pytest.raises(InputError, match="the sheet's size is not known; name it with size"):
            Bench(robot, EASEL, None).outline()
        assert robot.said == []


@pytest.mark.parametrize("corner", [(-0.1, -0.2), (0.2, 0.1), (0.2, -0.2), (-0.1, 0.1), (0.0, 0.0)])
def test_a_square_is_drawn_to_a_side_where_there_is_room(corner: tuple[float, float]) -> None:
    with Recorder() as robot:
        bench = Bench(robot, EASEL, SIZE)
        robot.move(np.array([*corner, 0.05]))
        bench.square()
        (path,) = [path for what, path in robot.commands if what == "stroke"]
        assert robot.lifted
    np.testing.assert_allclose(path[[0, -1], :2], [corner, corner], atol=1e-12)
    np.testing.assert_allclose(np.abs(np.diff(path, axis=0)).sum(axis=1), SQUARE)
    np.testing.assert_allclose(path[:, 2], -EASEL.deepest / 2)


def test_a_grbl_keeps_the_corner_and_its_workspace_stays_where_it_is() -> None:
    with FakeGrbl(pace=1000.0) as device:
        with Grbl(device.port, SERVO) as robot:
            bench = Bench(robot, None, SIZE)
            bench.jog(0, 0.1)
            bench.jog(1, 0.05)
            before = np.array(device.place)
            assert bench.set_origin("corner").startswith("the machine's work origin is here: the sheet's lower left")
            assert device.origin == pytest.approx((100, 50, 0))
            np.testing.assert_allclose(robot.place[:2], 0)
            np.testing.assert_allclose(robot.limits.lower[:2], (-0.1, -0.05), atol=1e-12)
            np.testing.assert_allclose(robot.limits.upper[:2], (0.2, 0.17), atol=1e-12)
            bench.jog(0, -0.05)
            bench.go_home()
            np.testing.assert_allclose(device.place, before, atol=1e-6)
            bench.jog(0, -0.1)
            assert device.place[0] == pytest.approx(0, abs=1e-6)
            with pytest.raises(InputError, match="the machine's x is"):
                bench.jog(0, -0.001)
        assert not bench.changed


def test_with_homing_a_new_connection_has_the_workspace_that_was_left() -> None:
    settings = {**SETTINGS, 22: 1}
    with FakeGrbl(settings, start=(-200.0, -100.0, -30.0), origin=(-250.0, -200.0, -40.0), pace=1000.0) as device:
        with Grbl(device.port) as robot:
            Bench(robot, None, SIZE).set_origin("corner")
            lower, upper = robot.limits.lower, robot.limits.upper
        with Grbl(device.port) as robot:
            np.testing.assert_allclose((robot.limits.lower, robot.limits.upper), (lower, upper), atol=1e-9)


def test_the_paper_of_a_machine_that_lifts_by_height_is_where_the_tip_touches_it() -> None:
    with FakeGrbl(pace=1000.0) as device, Grbl(device.port) as robot:
        bench = Bench(robot, None, SIZE)
        bench.jog(2, -0.007)
        assert device.place[2] == pytest.approx(-2)
        bench.set_origin("paper")
        assert device.origin[2] == pytest.approx(-2)
        assert robot.place[2] == pytest.approx(bench.easel.travel), "the tip does not stay on the paper"
        assert device.place[2] == pytest.approx(3)
        bench.lower()
        assert device.place[2] == pytest.approx(-2)
        bench.lift()


def test_a_tip_that_was_jogged_onto_the_paper_is_lifted_to_where_it_came_from() -> None:
    with FakeGrbl(pace=1000.0) as device, Grbl(device.port) as robot:
        bench = Bench(robot, None, SIZE)
        bench.jog(2, 0.009)
        bench.jog(2, -0.003)
        bench.lift()
        assert device.place[2] == pytest.approx(14), "wherever its paper lies, which nobody has told"
        bench.jog(2, -0.015)
        bench.go_home()
        assert device.place[2] == pytest.approx(5)
        assert min(z for *_, z, _ in device.reached) == pytest.approx(-1)


def test_a_tip_that_was_jogged_down_is_lifted_wherever_it_is() -> None:
    steep = EASEL.model_copy(update={"right": (0.9, 0, 0.19**0.5)})
    with Recorder() as robot:
        bench = Bench(robot, steep, SIZE)
        for _ in range(3):
            bench.jog(0, 0.05)
        bench.jog(2, -0.02)
        bench.lift()
        assert robot.lifted
        assert robot.place[2] == LIMITS.upper[2], "the height of travel there is beyond it"


def test_the_pen_is_lowered_beneath_where_it_is_on_a_tilted_easel() -> None:
    tilted = EASEL.model_copy(update={"right": (np.cos(0.05), 0.0, np.sin(0.05))})
    with Recorder() as robot:
        bench = Bench(robot, tilted, SIZE)
        bench.lower()
        (path,) = [path for what, path in robot.commands if what == "stroke"]
        assert tilted.machine_to_canvas(path)[0, 2] == pytest.approx(-tilted.deepest / 2)
        bench.lift()


@pytest.mark.parametrize("pen", [SERVO, Pen(up=500, down=700, seconds=0.01)])
def test_a_grbls_servo_is_raised_and_lowered_where_the_pen_is(pen: Pen) -> None:
    upwards = np.sign(pen.up - pen.down)
    with FakeGrbl(pace=1000.0) as device, Grbl(device.port, pen) as robot:
        bench = Bench(robot, None, SIZE)
        assert bench.set_servo(1, 0.01) == pen.model_copy(update={"up": pen.up + 10 * upwards})
        assert device.servo == pen.up + 10 * upwards
        bench.lower()
        assert device.servo == pen.down
        moved = bench.set_servo(-2, 0.01)
        assert moved.down == device.servo == pen.down - 20 * upwards
        bench.lift()
        assert device.servo == moved.up
        bench.set_servo(1, 5.0)
        assert device.servo in (0, 1000)
        assert (bench.easel.pen, bench.changed) == (robot.pen, True)


def test_a_servo_is_not_moved_to_where_up_is_down() -> None:
    with FakeGrbl(pace=1000.0) as device, Grbl(device.port, SERVO) as robot:
        bench = Bench(robot, None, SIZE)
        with pytest.raises(InputError, match="up and down would be the same"):
            bench.set_servo(-2, 0.1)
        assert (device.servo, bench.easel.pen, bench.changed) == (SERVO.up, SERVO, False)


def test_an_axidraws_servo_is_moved_and_kept_within_its_pulses() -> None:
    with FakeEbb() as device, AxiDraw(device.port, PULSES) as robot:
        bench = Bench(robot, None, SIZE)
        bench.lower()
        moved = bench.set_servo(1, 0.01)
        assert (moved.up, moved.down) == (20000, 15240)
        assert "SC,5,15240" in device.commands
        assert device.down
        bench.lift()
        assert not device.down
        with pytest.raises(InputError, match="it must be 6000 to 30000"):
            robot.set_pen(Pen(up=99999, down=15000))


def test_an_axidraw_lets_go_and_its_home_is_where_it_is_then_pushed() -> None:
    with FakeEbb() as device:
        robot = AxiDraw(device.port, PULSES)
        with robot:
            bench = Bench(robot, None, SIZE)
            bench.jog(0, 0.02)
            bench.lower()
            bench.let_go()
            assert not device.down
            assert "EM,0,0" in device.commands
            with pytest.raises(Exception, match="stopped"):
                bench.jog(0, 0.01)
        with robot:
            assert device.commands.count("EM,1,1") == 2
            np.testing.assert_allclose(robot.place, 0)


def test_a_machine_without_an_origin_of_its_own_gets_an_easel_there() -> None:
    with FakeEbb() as device, AxiDraw(device.port, PULSES) as robot:
        bench = Bench(robot, None, SIZE)
        bench.jog(0, 0.02)
        bench.jog(1, -0.03)
        assert bench.set_origin("corner").startswith("the sheet's upper left corner is here, once the easel is written")
        assert bench.easel.corner == pytest.approx((0.02, -0.03, 0))
        assert bench.changed
        bench.jog(0, 0.05)
        bench.go_home()
        np.testing.assert_allclose(robot.place[:2], (0.02, -0.03), atol=1e-9)


@pytest.mark.parametrize(
    ("limits", "act", "text"),
    [
        (LIMITS, lambda bench: bench.set_servo(1, 0.01), "no servo lifts this pen"),
        (LIMITS, lambda bench: bench.let_go(), "cannot be switched off from here"),
        (LIMITS.model_copy(update={"varies_pressure": False}), lambda bench: bench.jog(2, 1e-3), "has no height"),
        (LIMITS.model_copy(update={"varies_pressure": False}), lambda bench: bench.set_origin("paper"), "height"),
    ],
)
def test_what_a_machine_cannot_do_is_one_sentence(limits: Limits, act: Callable[[Bench], None], text: str) -> None:
    with Recorder(limits) as robot, pytest.raises(InputError, match=text):
        act(Bench(robot, EASEL, SIZE))


def test_a_grbl_says_how_its_motors_let_go() -> None:
    with FakeGrbl() as device, Grbl(device.port) as robot, pytest.raises(InputError, match=r"set \$1=25"):
        Bench(robot, None, SIZE).let_go()
