"""``maulstick machine``: sets up a machine by hand, with keys."""

import os
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Annotated, Final

import typer
from rich.console import Console

from maulstick.cli.export import servo_of
from maulstick.cli.keyboard import hang_up_as_ctrl_c, pressed_keys, unechoed
from maulstick.cli.logbook import print_logbook
from maulstick.cli.wording import COMMAND_LINE, stopped
from maulstick.errors import InputError, MachineError, OutputError, Remedy, nothing_is_painted
from maulstick.jobs.paint.machine_lock import machine_lock
from maulstick.painting.raster import parse_size
from maulstick.robot import machines
from maulstick.robot.bench import Bench
from maulstick.robot.easel import Easel, Pen, read_easel, write_easel
from maulstick.robot.plotter import HasServo, LockedError, LocksItself
from maulstick.robot.robot import Robot
from maulstick.robot.workplace import is_away

_STEPS: Final = {"1": (1e-2, 0.05), "2": (1e-3, 0.01), "3": (1e-4, 0.002)}  # metres, and shares of a servo's range

_sheet = partial(typer.Option, rich_help_panel="The sheet and the pen")
_writing = partial(typer.Option, rich_help_panel="What is written")


def machine(
    spec: Annotated[
        str | None, typer.Argument(metavar="MACHINE", show_default=False, help=f"The machine: {machines.REAL_SPECS}.")
    ] = None,
    size: Annotated[
        str | None, _sheet(metavar="SIZE", help="Size of the sheet, for its outline: 200x160mm, A4-landscape.")
    ] = None,
    servo: Annotated[
        str | None,
        _sheet(
            metavar="UP,DOWN",
            show_default="the easel's, or the machine's usual ones",
            help="Numbers of the servo that lifts and lowers the pen.",
        ),
    ] = None,
    easel: Annotated[
        Path | None,
        _sheet(metavar="FILE", help="Place of the sheet, from `maulstick calibrate touch`. Arms need it."),
    ] = None,
    log: Annotated[
        bool,
        typer.Option(
            "--log",
            metavar="",
            help="List what each pen has drawn, on this machine or on all, and leave.",
            rich_help_panel="The logbook",
        ),
    ] = False,
    out: Annotated[
        Path, _writing(metavar="FILE", help="Easel that the key w writes, for `maulstick paint --easel`.")
    ] = Path("easel.json"),
) -> None:
    """Move a machine with keys, set where the sheet begins and how high the pen is, and try both.

    Arrow keys move the lifted pen, Page Up and Page Down its height where no servo lifts it; 1, 2 and 3 set the step to
    10, 1 or 0.1 mm. Ctrl-C stops at once and lifts the pen; ? lists all keys. A Grbl that has locked itself is homed or
    unlocked first.

    Example: maulstick machine grbl:/dev/ttyUSB0 --size A4-landscape
    """
    if log:
        print_logbook(spec)
        return
    if spec is None:
        raise InputError(f"name a machine: {machines.REAL_SPECS}; or add --log to list what each pen has drawn")
    if machines.is_simulated(spec):
        raise InputError(f"{spec} has its sheet in place and no pen to set; name a real machine: {machines.REAL_SPECS}")
    sides = None if size is None else parse_size(size)
    place = None if easel is None else read_easel(easel)
    given = place if servo is None else _with_servo(spec, place, servo_of(servo))
    if not sys.stdin.isatty():
        raise InputError("keys are needed to move the machine; run it in a terminal")
    console = Console(stderr=True, markup=False, highlight=False)
    with machine_lock(spec), unechoed(), hang_up_as_ctrl_c(), nothing_is_painted():
        robot = machines.machine(spec, given)
        bench = Bench(robot, None if place is None else given, sides)
        session, keys = _Session(console, out, bench), pressed_keys()
        entered = False
        try:
            while not session.over:
                try:
                    with robot:
                        entered = True
                        session.attend(keys)
                except LockedError:
                    if not isinstance(robot, LocksItself):
                        raise
                    session.attend_locked(robot, keys)
                session.do_outside(robot, keys)
        except (MachineError, KeyboardInterrupt):
            if entered:
                session.say(stopped(robot))
            raise
        finally:
            if bench.changed:
                session.say("the pen's new numbers or place are not written; w would have")


def _with_servo(spec: str, place: Easel | None, pen: Pen) -> Easel:
    """Return the easel, or any, from which the machine takes its servo's numbers; the servo takes as long as before."""
    before = None if place is None else place.pen
    if before is None and isinstance(robot := machines.machine(spec, place), HasServo):
        before = robot.pen
    if before is not None:
        pen = pen.model_copy(update={"seconds": before.seconds})
    return (place or Easel(corner=(0, 0, 0), right=(1, 0, 0), down=(0, -1, 0))).model_copy(update={"pen": pen})


@dataclass
class _Session:
    """Keys that are pressed, and what the machine does then.

    step: metres, and share of a servo's range, per key.  over: whether the operator left.
    let_go: whether the motors were switched off; find_home: whether home is to be found; the machine has to be entered
    again after either.
    """

    console: Console
    out: Path
    bench: Bench
    step: tuple[float, float] = _STEPS["2"]
    over: bool = False
    let_go: bool = False
    find_home: bool = False
    _asked_to_replace: bool = field(default=False, init=False)

    def attend(self, keys: Iterator[str]) -> None:
        """Do what the keys say, until the operator leaves or switches the motors off."""
        if is_away(self.bench.robot):
            x, y = (1e3 * self.bench.robot.place[:2]).round(1) + 0.0
            otherwise = COMMAND_LINE.remedy(Remedy.PUT_HOME)
            self.say(f"see that the pen stands at x {x:.1f}, y {y:.1f} mm (elsewhere: leave with q, {otherwise})")
        self.console.print("arrow keys move; ? lists all keys; q leaves", soft_wrap=True)
        for key in keys:
            if key not in KEYS:
                continue
            try:
                KEYS[key][1](self, self.bench)
            except (InputError, OutputError) as error:
                self.say(COMMAND_LINE.say(error))
            else:
                if self._leaves:
                    return
                self.console.print(self._where(), end="\r")
            self._asked_to_replace &= key == "w"
        raise _nobody()

    def attend_locked(self, robot: LocksItself, keys: Iterator[str]) -> None:
        """Find home or unlock the machine as the keys say, or leave."""
        self.say("the machine is locked, as its place may be lost")
        self.say("f finds home by its switches: see that its way is free and the pen off the paper")
        self.say("u unlocks it, if the pen stands where it was left; q leaves")
        for key in keys:
            if key == "u":
                robot.unlock()
            self.find_home, self.over = key == "f", key == "q"
            if key in ("u", "f", "q"):
                return
        raise _nobody()

    def do_outside(self, robot: Robot, keys: Iterator[str]) -> None:
        """Do what the machine must not be entered for."""
        if self.let_go:
            self.say("the motors are off: push the pen to its home corner by hand, and press a key")
            next(keys, "")
        if self.find_home and isinstance(robot, LocksItself):
            self.say("finding home; Ctrl-C stops it")
            try:
                robot.find_home()
            except InputError as error:
                self.say(COMMAND_LINE.say(error))
        self.let_go = self.find_home = False

    @property
    def _leaves(self) -> bool:
        return self.over or self.let_go or self.find_home

    def say(self, sentence: str) -> None:
        """Print a sentence for the operator."""
        self.console.print(sentence, soft_wrap=True)

    def write(self, bench: Bench) -> None:
        """Write the easel; a file that is there is replaced where that was asked for twice."""
        if not bench.may_be_written:
            raise InputError("an easel is the place of one sheet, and its size is not known; name it with --size")
        if os.path.lexists(self.out) and not self._asked_to_replace:
            self._asked_to_replace = True
            raise InputError(f"{self.out} is already there; press w again to replace it")
        write_easel(bench.easel, self.out)
        bench.changed = False
        self.say(f"{self.out} is written; paint with --easel {self.out}")

    def _where(self) -> str:
        robot, servo = self.bench.robot, self.bench.servo
        x, y, z = (1e3 * robot.place).round(1) + 0.0
        if servo is None or servo.pen is None:
            at = "lifted" if robot.lifted else "lowered"
            return f"x {x:.1f}  y {y:.1f}  z {z:.1f} mm, pen {at}, step {1e3 * self.step[0]:g} mm   "
        at, number = ("up", servo.pen.up) if robot.lifted else ("down", servo.pen.down)
        return f"x {x:.1f}  y {y:.1f} mm, pen {at} at {number:g}, step {1e3 * self.step[0]:g} mm   "


def _nobody() -> InputError:
    return InputError("nobody is at the keyboard; run it in a terminal")


def _jogs(axis: int, sign: int) -> Callable[[_Session, Bench], None]:
    return lambda session, bench: bench.jog(axis, sign * session.step[0])


def _steps(key: str) -> Callable[[_Session, Bench], None]:
    def step(session: _Session, bench: Bench) -> None:
        session.step = _STEPS[key]

    return step


def _pen(session: _Session, bench: Bench) -> None:
    if bench.robot.lifted:
        bench.lower()
    else:
        bench.lift()


def _servo(steps: int) -> Callable[[_Session, Bench], None]:
    def move(session: _Session, bench: Bench) -> None:
        pen = bench.set_servo(steps, session.step[1])
        session.say(f"the pen is up at {pen.up:g}, down at {pen.down:g}")

    return move


def _corner(session: _Session, bench: Bench) -> None:
    session.say(bench.set_origin("corner"))


def _paper(session: _Session, bench: Bench) -> None:
    session.say(bench.set_origin("paper"))


def _let_go(session: _Session, bench: Bench) -> None:
    bench.let_go()
    session.let_go = True


def _find_home(session: _Session, bench: Bench) -> None:
    if not isinstance(bench.robot, LocksItself):
        raise InputError("this machine has no switches to find its home by")
    bench.lift()
    session.find_home = True


def _list_keys(session: _Session, bench: Bench) -> None:
    for key, (label, _) in KEYS.items():
        session.say(f"  {key:>8}  {label}")


def _leave(session: _Session, bench: Bench) -> None:
    bench.lift()
    session.over = True


KEYS: Final[dict[str, tuple[str, Callable[[_Session, Bench], None]]]] = {
    "left": ("x down", _jogs(0, -1)),
    "right": ("x up", _jogs(0, 1)),
    "down": ("y down", _jogs(1, -1)),
    "up": ("y up", _jogs(1, 1)),
    "pagedown": ("lower, where no servo lifts the pen", _jogs(2, -1)),
    "pageup": ("higher, where no servo lifts the pen", _jogs(2, 1)),
    "1": ("steps of 10 mm, or 5 % of the servo's range", _steps("1")),
    "2": ("steps of 1 mm, or 1 %", _steps("2")),
    "3": ("steps of 0.1 mm, or 0.2 %", _steps("3")),
    "p": ("lower the pen onto the paper, or lift it", _pen),
    "+": ("raise the servo, where the pen is now (up or down)", _servo(1)),
    "-": ("lower the servo, where the pen is now (up or down)", _servo(-1)),
    "h": ("go home to the corner", lambda session, bench: bench.go_home()),
    "b": ("go around the sheet's border with the pen up", lambda session, bench: bench.outline()),
    "t": ("draw a test square of 20 mm from here", lambda session, bench: bench.square()),
    "o": ("the sheet's corner is here: a Grbl's lower left one, others' upper left one", _corner),
    "z": ("the paper is at this height", _paper),
    "f": ("find home by a Grbl's switches", _find_home),
    "m": ("motors off", _let_go),
    "w": ("write the easel with the corner and the pen's numbers", _Session.write),
    "?": ("list the keys", _list_keys),
    "q": ("lift the pen and leave", _leave),
}
"""Keys by their names in prompt_toolkit: a label for people, and what the key does."""
