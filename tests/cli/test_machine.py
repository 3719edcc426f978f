"""``maulstick machine``, with keys on a pseudo-terminal and machines on others."""

import io
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from maulstick.painting.painting_file import write_painting
from maulstick.robot.easel import Easel, Pen, read_easel, write_easel
from maulstick.robot.logbook import logbook_path
from tests.cli.conftest import Ran, Running, run
from tests.support.robot.fake_ebb import FakeEbb
from tests.support.robot.fake_grbl import WITH_SWITCHES, FakeGrbl
from tests.support.robot.recorder import Recorder
from tests.support.robot.small_paintings import SIX

LEFT, RIGHT, UP, DOWN, LOWER, HIGHER = "\x1b[D", "\x1b[C", "\x1b[A", "\x1b[B", "\x1b[6~", "\x1b[5~"
SIZE = ("--size", "60x40mm")
SERVO = ("--servo", "700,500")


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in which the commands run, where nobody else's machines are in use."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    return tmp_path


@pytest.fixture
def grbl() -> Iterator[FakeGrbl]:
    with FakeGrbl(pace=1000.0) as device:
        yield device


@pytest.fixture
def ebb() -> Iterator[FakeEbb]:
    with FakeEbb() as device:
        yield device


def on(device: FakeGrbl | FakeEbb, terminal: int, keys: str, *words: str) -> Ran:
    """Press keys at a machine."""
    os.write(terminal, keys.encode())
    kind = "grbl" if isinstance(device, FakeGrbl) else "axidraw"
    return run("machine", f"{kind}:{device.port}", *words)


def test_keys_jog_a_machine_set_its_origin_and_take_it_home(grbl: FakeGrbl, terminal: int) -> None:
    ran = on(grbl, terminal, 3 * ("1" + RIGHT) + 2 * ("1" + UP) + "o" + "2" + RIGHT + "hq", *SERVO)
    assert (ran.code, ran.stdout) == (0, "")
    assert grbl.origin == pytest.approx((30, 20, 0))
    assert grbl.place == pytest.approx((30, 20, 0))
    assert grbl.servo == 700
    assert "the machine's work origin is here: the sheet's lower left corner; it keeps that" in ran.stderr


def test_a_key_that_is_held_moves_once_for_all_repeats_that_came_meanwhile(grbl: FakeGrbl, terminal: int) -> None:
    assert on(grbl, terminal, "1" + 20 * RIGHT + "1" + 20 * UP + "q").code == 0
    assert grbl.place == pytest.approx((10, 10, 5))


def test_a_key_that_would_leave_the_limits_says_so_and_the_next_one_works(grbl: FakeGrbl, terminal: int) -> None:
    ran = on(grbl, terminal, LEFT + "1" + RIGHT + "q")
    assert ran.code == 0
    assert "the machine's x is -1 mm; it must be 0 to 300 mm: 1 mm less far" in ran.stderr
    assert grbl.place == pytest.approx((10, 0, 5))


def test_the_outline_is_drawn_with_the_pen_up_and_the_square_with_it_down(grbl: FakeGrbl, terminal: int) -> None:
    assert on(grbl, terminal, "b" + "1" + RIGHT + "tq", *SIZE, *SERVO).code == 0
    up = {(x, y) for x, y, _, servo in grbl.reached if servo == 700}
    down = {(x, y) for x, y, _, servo in grbl.reached if servo == 500}
    assert {(0, 0), (60, 0), (60, 40), (0, 40)} <= up
    assert down == {(10, 0), (30, 0), (30, 20), (10, 20)}
    assert grbl.servo == 700


def test_the_pens_numbers_are_set_tried_and_written_for_painting(ebb: FakeEbb, terminal: int) -> None:
    ran = on(ebb, terminal, "p" + "++" + "-" + "p" + "+" + "w" + "q", *SIZE)
    assert ran.code == 0, ran.stderr
    assert read_easel("easel.json").pen == Pen(up=20881, down=15488, seconds=0.3)
    assert "easel.json is written; paint with --easel easel.json" in ran.stderr
    assert "not written" not in ran.stderr
    assert not ebb.down


def test_a_file_that_is_there_is_replaced_where_w_is_pressed_twice(ebb: FakeEbb, terminal: int) -> None:
    Path("easel.json").write_text("mine")
    ran = on(ebb, terminal, "+" + "w1" + "q", *SIZE)
    assert Path("easel.json").read_text() == "mine"
    assert "easel.json is already there; press w again to replace it" in ran.stderr
    assert "the pen's new numbers or place are not written; w would have" in ran.stderr
    assert on(ebb, terminal, "ww" + "q", *SIZE).code == 0
    assert read_easel("easel.json").pen is not None


def test_a_locked_grbl_is_homed_or_unlocked_before_it_moves_or_left_as_it_is(terminal: int) -> None:
    for keys, place in {"xf" + LEFT + "q": (-2, -1, -1), "u" + LEFT + "q": (-51, -50, -10)}.items():
        with FakeGrbl(pace=1000.0, locked=True, **WITH_SWITCHES) as device:
            ran = on(device, terminal, keys)
            assert ran.code == 0, ran.stderr
            assert device.place == pytest.approx(place)
            assert "the machine is locked, as its place may be lost" in ran.stderr
    with FakeGrbl(locked=True, **WITH_SWITCHES) as device:
        assert on(device, terminal, "q").code == 0
        assert device.state == "Alarm"


def test_a_grbl_finds_home_whenever_it_is_asked_and_its_pen_is_lifted_before(terminal: int) -> None:
    with FakeGrbl(pace=1000.0, **WITH_SWITCHES) as device:
        ran = on(device, terminal, "p" + "f" + LEFT + "q")
        assert ran.code == 0, ran.stderr
        assert device.place == pytest.approx((-2, -1, -1))
        assert device.reached[-2][2] > -20, "lifted, before it left"


def test_what_finds_no_home_says_so_and_is_left_where_it_is(grbl: FakeGrbl, ebb: FakeEbb, terminal: int) -> None:
    ran = on(grbl, terminal, "f" + RIGHT + "q")
    assert ran.code == 0
    assert "has no switches to find home by ($22=0)" in " ".join(ran.stderr.split())
    assert grbl.place == pytest.approx((1, 0, 5))
    assert "this machine has no switches to find its home by" in on(ebb, terminal, "fq").stderr


def test_motors_are_switched_off_and_where_the_pen_is_pushed_is_home(ebb: FakeEbb, terminal: int) -> None:
    ran = on(ebb, terminal, "1" + RIGHT + "p" + "m" + "x" + RIGHT + "q")
    assert ran.code == 0
    assert ebb.commands.count("EM,0,0") == 1
    assert ebb.commands.count("EM,1,1") == 2
    assert ebb.steps == (800, 800), "10 mm from its new home"
    assert "push the pen to its home corner by hand, and press a key" in ran.stderr
    assert not ebb.down


def test_a_pen_that_counts_as_away_from_home_is_asked_about_before_it_moves(ebb: FakeEbb, terminal: int) -> None:
    asked = "see that the pen stands at x 10.0, y 0.0 mm (elsewhere: leave with q, unplug power and USB"
    at_home = on(ebb, terminal, "1" + RIGHT + "q")
    assert "see that the pen stands" not in at_home.stderr
    away = on(ebb, terminal, "hq")
    assert away.stderr.index(asked) < away.stderr.index("arrow keys move")
    assert ebb.steps == (0, 0)


def test_a_grbl_says_that_its_motors_stay_on(grbl: FakeGrbl, terminal: int) -> None:
    ran = on(grbl, terminal, "mq")
    assert ran.code == 0
    assert "by its setting $1" in ran.stderr


def test_a_servo_takes_as_long_with_other_numbers(grbl: FakeGrbl, ebb: FakeEbb, terminal: int) -> None:
    slow = Easel(corner=(0, 0.04, 0), right=(1, 0, 0), down=(0, -1, 0), pen=Pen(up=600, down=400, seconds=0.5))
    write_easel(slow, "slow.json")
    assert on(grbl, terminal, "wq", "--easel", "slow.json", *SERVO).code == 0
    assert read_easel("easel.json").pen == Pen(up=700, down=500, seconds=0.5)
    assert on(ebb, terminal, "wq", "--servo", "20000,15000", *SIZE, "--out", "ebb.json").code == 0
    assert read_easel("ebb.json").pen == Pen(up=20000, down=15000, seconds=0.3), "the AxiDraw's own"


def test_numbers_of_a_servo_that_the_machine_refuses_are_replaced(ebb: FakeEbb, terminal: int) -> None:
    of_another = Easel(corner=(0, 0, 0), right=(1, 0, 0), down=(0, -1, 0), pen=Pen(up=30, down=90, seconds=0.4))
    write_easel(of_another, "other.json")
    assert on(ebb, terminal, "wq", "--easel", "other.json", "--servo", "20000,15000", *SIZE).code == 0
    assert read_easel("easel.json").pen == Pen(up=20000, down=15000, seconds=0.4)


def test_an_easel_that_cannot_be_written_loses_no_number_that_was_set(ebb: FakeEbb, terminal: int) -> None:
    ran = on(ebb, terminal, "+" + "w" + "1" + RIGHT + "q", *SIZE, "--out", "nowhere/easel.json")
    assert ran.code == 0
    assert "cannot write nowhere/easel.json: its folder does not exist" in ran.stderr
    assert "the pen's new numbers or place are not written; w would have" in ran.stderr
    assert ebb.steps != (0, 0), "the next key works"


def test_ctrl_c_says_that_new_numbers_are_not_written(ebb: FakeEbb, terminal: int) -> None:
    ran = on(ebb, terminal, "+\x03", *SIZE)
    assert ran.code == 130
    assert "not written; w would have" in ran.stderr


def test_a_machine_that_was_never_entered_was_not_stopped(grbl: FakeGrbl, terminal: int) -> None:
    grbl.settings[13] = 1
    ran = on(grbl, terminal, "q")
    assert (ran.code, ran.stderr.count("\n")) == (3, 1)
    assert "stopped" not in ran.stderr


@pytest.mark.parametrize("keys", ["p\x03", "p"])
def test_ctrl_c_and_a_closed_keyboard_lift_the_pen(
    grbl: FakeGrbl, terminal: int, keys: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if keys == "p":
        monkeypatch.setattr("maulstick.cli.machine.pressed_keys", lambda: iter("p"))
    ran = on(grbl, terminal, keys, *SERVO)
    assert ran.code == (130 if keys != "p" else 2)
    assert grbl.servo == 700
    assert ("stopped, with the pen lifted" in ran.stderr) is (ran.code == 130)


def test_a_cable_that_is_pulled_while_nothing_is_painted_leaves_nothing_to_go_on_with(terminal: int) -> None:
    with FakeEbb(faults={5: "closed"}) as device:
        ran = on(device, terminal, "b", *SIZE)
    assert ran.code == 3
    assert ran.stderr.rstrip().endswith("went silent; check cable and power")


def test_a_terminal_that_is_closed_lifts_the_pen(grbl: FakeGrbl) -> None:
    terminal = Running("machine", f"grbl:{grbl.port}", *SERVO, keys=True)
    terminal.wait_for("lists all keys")
    os.write(terminal._terminal, b"p")
    terminal.wait_for("pen down at 500")
    os.kill(terminal.pid, 1)
    assert terminal.leave() == 130
    assert grbl.servo == 700


@pytest.mark.parametrize("leave", ["q", "\x03"])
def test_a_tip_that_was_lowered_by_height_is_lifted_at_the_end(grbl: FakeGrbl, terminal: int, leave: str) -> None:
    ran = on(grbl, terminal, 6 * ("2" + LOWER) + leave)
    assert ran.code == (0 if leave == "q" else 130)
    assert "z -1.0 mm, pen lowered" in ran.stderr
    assert ("stopped, with the pen lifted" in ran.stderr) is (leave != "q")
    assert grbl.place[2] == pytest.approx(5)


def test_a_terminal_that_is_gone_lifts_the_pen(grbl: FakeGrbl) -> None:
    terminal = Running("machine", f"grbl:{grbl.port}", *SERVO, keys=True)
    terminal.wait_for("lists all keys")
    os.write(terminal._terminal, b"p")
    terminal.wait_for("pen down at 500")
    os.close(terminal._terminal)
    assert terminal._process.wait() != 0
    assert grbl.servo == 700


def test_an_easel_without_a_size_is_no_sheets(grbl: FakeGrbl, terminal: int) -> None:
    ran = on(grbl, terminal, "wbq")
    assert not Path("easel.json").exists()
    assert "name it with --size" in ran.stderr


def test_every_key_is_listed(grbl: FakeGrbl, terminal: int) -> None:
    ran = on(grbl, terminal, "?q")
    for label in ("motors off", "draw a test square of 20 mm from here", "the paper is at this height"):
        assert label in ran.stderr


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("sim",), "sim has its sheet in place and no pen to set; name a real machine: "),
        (("toaster",), "there is no machine 'toaster'; there are: "),
        (("simplotter",), "there is no machine 'simplotter'; there are: "),
        (("grbl:/dev/null", "--size", "0x0mm"), "a side of the canvas is 0 mm"),
        (("grbl:/dev/null", "--servo", "up"), "--servo is 'up'; it must be two numbers"),
        (("grbl:/dev/null", "--easel", "none.json"), "none.json"),
        (("xarm:192.0.2.1",), "calibrate touch"),
    ],
)
def test_what_cannot_be_used_is_one_line(terminal: int, words: tuple[str, ...], text: str) -> None:
    ran = run("machine", *words)
    assert ran.code in (2, 3)
    assert text in ran.mistake


def test_keys_need_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    with open(os.devnull) as nobody:
        monkeypatch.setattr("sys.stdin", nobody)
        assert run("machine", "grbl:/dev/null").mistake == "keys are needed to move the machine; run it in a terminal"


def test_the_logbook_lists_what_each_pen_drew_on_a_machine_or_on_all(
    grbl: FakeGrbl, here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_painting(SIX, here / "painting.json")
    monkeypatch.setattr("sys.stdin", io.StringIO("\n\n"))
    easel = Easel(corner=(0, 0.04, 0), right=(1, 0, 0), down=(0, -1, 0), deepest=0.002)
    write_easel(easel, here / "flat.json")
    spec = f"grbl:{grbl.port}"
    ran = run("paint", "painting.json", "--robot", spec, "--easel", "flat.json", "--pen", "micron-08")
    assert ran.code == 0, ran.stderr
    for words in ((), (spec,)):
        table = run("machine", *words, "--log").stdout
        assert "micron-08 #cc1a1a" in table
        assert "0.03" in table
        assert "1 run" in table
    other = run("machine", "axidraw", "--log")
    assert (other.code, other.stdout) == (
        0,
        "nothing was painted on axidraw so far (the simulated easel is not counted)\n",
    )


def test_a_machine_that_there_is_not_has_no_logbook(here: Path) -> None:
    assert run("machine", "FOO", "--log").mistake.startswith("there is no machine 'FOO'; there are: sim")
    assert run("machine", "grbl", "--log").mistake.startswith("'grbl' does not say where the machine is")
    assert run("machine", "sim:foo", "--log").mistake.startswith(
        "there is no machine 'sim:foo'; there are: sim, sim:pe"
    )
    told = "a plotter of hpgl is not driven, but draws a file; write that with maulstick export"
    assert run("machine", "hpgl", "--log").mistake == told
    assert run("machine", "sim", "--log").stdout.startswith("nothing was painted on sim so far")


def test_nothing_is_logged_of_a_simulated_machine(here: Path) -> None:
    write_painting(SIX, here / "painting.json")
    assert run("paint", "painting.json").code == 0
    ran = run("machine", "--log")
    assert (ran.code, ran.stdout) == (0, "no real machine has painted so far (the simulated easel is not counted)\n")


def test_a_logbook_that_cannot_be_written_is_a_note_and_all_is_painted(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("maulstick.jobs.paint.setup.machine", lambda spec, easel: Recorder())
    monkeypatch.setattr("sys.stdin", io.StringIO("\n\n"))
    logbook_path().mkdir(parents=True)
    write_painting(SIX, here / "painting.json")
    ran = run("paint", "painting.json", "--robot", f"grbl:{here}")
    assert ran.code == 0
    assert "note: cannot write the logbook" in ran.stderr


def test_a_machine_or_the_log_is_asked_for() -> None:
    assert run("machine").mistake.endswith("or add --log to list what each pen has drawn")
