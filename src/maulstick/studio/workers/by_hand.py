"""Process that has a machine while a person sets it up on the page: one move after another, as they ask for it.

It stops the machine, lifts the pen and ends by itself once the studio is gone, even if the studio was killed.
"""

import signal
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from queue import SimpleQueue
from typing import TYPE_CHECKING

from maulstick.errors import InputError, MachineError, nothing_is_painted
from maulstick.robot.easel import Easel, Pen
from maulstick.studio.wording import error_text
from maulstick.studio.workers.messages import Ended
from maulstick.studio.workers.process import Line, farewell

if TYPE_CHECKING:
    from maulstick.robot.bench import Bench
    from maulstick.robot.robot import Robot


class Deed(Enum):
    """Thing that the machine shall do.

    TAKE_HOLD: with motors that were off.  FIND_HOME: by its switches.  UNLOCK: where it stands.  LEAVE: lift the pen,
    and disconnect.
    """

    LOWER = "lower"
    LIFT = "lift"
    HOME = "home"
    OUTLINE = "outline"
    SQUARE = "square"
    CORNER = "corner"
    PAPER = "paper"
    LET_GO = "let go"
    TAKE_HOLD = "take hold"
    FIND_HOME = "find home"
    UNLOCK = "unlock"
    LEAVE = "leave"
    STOP = "stop"


@dataclass(frozen=True)
class Jog:
    """Move along x, y or z (0, 1 or 2), metres, with the pen lifted."""

    axis: int
    metres: float


@dataclass(frozen=True)
class SetServo:
    """Change of the servo's number, for the way the pen is now; by a share of its range, above 0 for higher."""

    share: float


Word = Deed | Jog | SetServo


@dataclass(frozen=True)
class Standing:
    """Where the machine stands, sent after each word that it has acted on.

    place: x, y and z in the machine's frame, metres.  pen: numbers of the servo; None where none lifts the pen.
    lets_go: whether its motors can be switched off.  finds_home: whether it has switches for that.
    has_sheet: whether the sheet's size is known.
    easel: where the sheet lies by now.  changed: whether that is new.  said: a sentence about the word.
    fault: whether the word could not be done.
    """

    place: tuple[float, float, float]
    lifted: bool
    pen: Pen | None
    lets_go: bool
    finds_home: bool
    has_sheet: bool
    easel: Easel
    changed: bool
    said: str = ""
    fault: bool = False


@dataclass(frozen=True)
class Loose:
    """Message that the motors are off, until `Deed.TAKE_HOLD`."""


@dataclass(frozen=True)
class Locked:
    """Message that the machine is locked, until `Deed.FIND_HOME` or `Deed.UNLOCK`. fault: why it still is, or ""."""

    fault: str = ""


def move_by_hand(line: Line, spec: str, easel: Path | None, painting: Path | None) -> None:
    """Do what the words of the studio say; send a `Standing` after each, and `Ended`.

    painting: file whose sheet lies before the machine, if any.
    """
    hands = _Hands()
    line.heard_by(hands.hear, lambda: farewell(lambda: hands.hear(Deed.STOP)))
    from maulstick.jobs.paint.machine_lock import machine_lock
    from maulstick.jobs.paintable import read_paintable
    from maulstick.robot import machines
    from maulstick.robot.bench import Bench
    from maulstick.robot.easel import read_easel
    from maulstick.studio.workers.svg_work import options_of

    place = None if easel is None else read_easel(easel)
    sheet = None if painting is None else read_paintable(painting, options_of(painting)).painting.sheet
    with machine_lock(spec):
        robot = machines.machine(spec, place)
        bench = Bench(robot, place, None if sheet is None else (sheet.width, sheet.height))
        for number in (signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, lambda *_: hands.hear(Deed.STOP))
        try:
            with nothing_is_painted():
                while hands.attend(line, robot, bench):
                    pass
        except MachineError as error:
            line.say(Ended("" if hands.is_to_stop else error_text(error), robot.lifted))
        else:
            line.say(Ended(None, True))


class _Hands:
    """Words of the studio, received in a thread of its own. is_to_stop: whether a stop was among them."""

    def __init__(self) -> None:
        self.is_to_stop = False
        self._robot: Robot | None = None
        self._undone = ""
        self._words: SimpleQueue[object] = SimpleQueue()

    def hear(self, word: object) -> None:
        """Keep a word until its turn; a stop is acted on at once."""
        if word is Deed.STOP:
            self.is_to_stop = True
            if self._robot is not None:
                self._robot.stop()
        self._words.put(word)

    def attend(self, line: Line, robot: "Robot", bench: "Bench") -> bool:
        """Do what the words say, until the machine has to be entered once more; return whether it has.

        Raises MachineError where the machine fails or is stopped, InputError where it cannot be entered.
        """
        from maulstick.robot.plotter import LockedError, LocksItself

        self._robot = robot
        undone, self._undone = self._undone, ""
        try:
            deed = self._attend_entered(line, robot, bench, undone)
        except LockedError:
            line.say(Locked(undone))
            deed = self._wait_for(Deed.FIND_HOME, Deed.UNLOCK)
        if deed is Deed.LET_GO:
            line.say(Loose())
            deed = self._wait_for(Deed.TAKE_HOLD)
        if deed is Deed.UNLOCK and isinstance(robot, LocksItself):
            robot.unlock()
        if deed is Deed.FIND_HOME and isinstance(robot, LocksItself):
            try:
                robot.find_home()
            except InputError as error:
                self._undone = error_text(error)
        return deed is not Deed.LEAVE

    def _wait_for(self, *deeds: Deed) -> Deed:
        """Wait for one of these words; return `Deed.LEAVE` where the person leaves instead."""
        while (word := self._words.get()) not in deeds:
            if word in (Deed.STOP, Deed.LEAVE):
                return Deed.LEAVE
        return Deed(word)

    def _attend_entered(self, line: Line, robot: "Robot", bench: "Bench", undone: str) -> Deed:
        """Enter the machine, and do what the words say; return the last, for which it must not be entered.

        undone: why what was asked for before that could not be done, or "".
        """
        with robot:
            if self.is_to_stop:  # while it was connected, which clears the robot's own stop
                robot.stop()
            line.say(_standing(bench, undone, bool(undone)))
            while True:
                word = self._words.get()
                if word in (Deed.STOP, Deed.LEAVE):
                    bench.lift()
                    return Deed.LEAVE
                try:
                    said, fault = _do(bench, word), False
                except InputError as error:
                    said, fault = error_text(error), True
                else:
                    if word in (Deed.LET_GO, Deed.FIND_HOME):
                        return Deed(word)
                line.say(_standing(bench, said, fault))


def _standing(bench: "Bench", said: str = "", fault: bool = False) -> Standing:
    from maulstick.robot.plotter import LetsGo, LocksItself

    x, y, z = bench.robot.place.tolist()
    return Standing(
        place=(x, y, z),
        lifted=bench.robot.lifted,
        pen=None if bench.servo is None else bench.servo.pen,
        lets_go=isinstance(bench.robot, LetsGo),
        finds_home=isinstance(bench.robot, LocksItself) and bench.robot.home is None,
        has_sheet=bench.size is not None,
        easel=bench.easel,
        changed=bench.changed and bench.may_be_written,
        said=said,
        fault=fault,
    )


def _do(bench: "Bench", word: object) -> str:
    """Do what a word says; return a sentence about it, or "". Raises InputError where it cannot be done."""
    match word:
        case Jog(axis=axis, metres=metres):
            bench.jog(axis, metres)
        case SetServo(share=share):
            pen = bench.set_servo(1 if share > 0 else -1, abs(share))
            return f"the pen is up at {pen.up:g}, and down at {pen.down:g}"
        case Deed.CORNER:
            return bench.set_origin("corner")
        case Deed.PAPER:
            return bench.set_origin("paper")
        case Deed.TAKE_HOLD | Deed.UNLOCK:
            pass  # it holds already
        case Deed():
            deeds = {
                Deed.LOWER: bench.lower,
                Deed.LIFT: bench.lift,
                Deed.HOME: bench.go_home,
                Deed.OUTLINE: bench.outline,
                Deed.SQUARE: bench.square,
                Deed.LET_GO: bench.let_go,
                Deed.FIND_HOME: bench.lift,
            }
            deeds[word]()
    return ""
