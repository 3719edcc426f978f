"""The commands and answers of an EiBotBoard, which drives an AxiDraw's motors and pen (firmware 2.x and 3.x)."""

import re
from typing import Final, final

from serial.tools import list_ports

from maulstick.errors import InputError, MachineError, Remedy
from maulstick.robot.adapters.serial_line import GLANCE, Patience, SerialLine
from maulstick.robot.robot import StoppedError
from maulstick.robot.stopping import Stopping

STEPS_PER_SECOND: Final = 25_000
"""Highest rate of either motor."""

HALT: Final = b"ES\r"
"""Command that stops at once and empties the queue; it is answered like any other."""

_USB = (0x04D8, 0xFD92)  # vendor and product of the board
_BAUD = 115200  # without meaning over USB, but the port asks for one
_OLDEST = (2, 4, 4)  # the first firmware whose QM reports the queue
_SWITCHES_SERVO = (2, 6, 0)  # the first firmware that takes the servo's power away, 60 s after its last motion
_TELLS_STEPS = 2, 8, 0  # the first firmware that says whether its motors hold, and how steps are divided
_DIVIDED = 16  # steps, by EM,1
_HAS_MODES = 3, 0, 0  # the first firmware that another program may have told to answer in another way, and queue more
_USUAL_REST = 60_000  # milliseconds: after which that firmware does, unless it was told otherwise
_POWERED = 200  # of QC: the 5 V of USB alone read 158 at most on any board, a supply of 9 V reads 245 at least
_POSITION = r"(-?\d+),(-?\d+)"
_VOLTAGES = r"(\d+),(\d+)"
_MOTOR_STATES = r"(\d+),(\d+)"
_BUTTON = r"([01])"
_MOTORS = r"QM,(\d+),(\d+),(\d+),(\d+)"
_NOTHING = "$^"  # a pattern that no answer matches


@final
class EbbBoard:
    """Commands to a board; each is answered before the next is sent, so that at most two motions are queued.

    Raises MachineError where it is silent, fails or is not understood; StoppedError once `stopping` is set.
    """

    def __init__(self, line: SerialLine, patience: float, stopping: Stopping) -> None:
        self._line = line
        self._patience = patience
        self._stopping = stopping
        self._version: tuple[int, ...] = _OLDEST
        self._holds = False

    def greet(self) -> None:
        """Check that the board answers and its firmware is new enough; answers to earlier commands are dropped."""
        self._line.drop()
        self._line.write(b"\rV\r")  # the first one ends what a broken line may have left of a command
        patience, found = Patience(self._patience), None
        while found is None:
            found = re.search(r"Firmware Version (\d+)\.(\d+)\.(\d+)", self._line.line() or "")
            if patience.over:
                raise MachineError(f"no EiBotBoard answers on {self._line.port}; check port, cable and power")
        self._version = tuple(map(int, found.groups()))
        if self._version < _OLDEST:
            came, oldest = ".".join(found.groups()), ".".join(map(str, _OLDEST))
            raise MachineError(f"the board on {self._line.port} has firmware {came}; update it to {oldest} or newer")
        if self._version >= _HAS_MODES:
            self._take_back_modes()

    def enable(self) -> None:
        """Switch both motors on, with steps divided by 16; steps are counted from where they are now."""
        self._command("EM,1,1")

    def holds(self) -> bool:
        """Return whether both motors hold, with steps as `enable` divides them; True where old firmware cannot say."""
        return self._version < _TELLS_STEPS or self._command("QE", _MOTOR_STATES) == (_DIVIDED, _DIVIDED)

    def release(self) -> None:
        """Let both motors turn freely; steps are counted from where they are now."""
        self._command("EM,0,0")
        self._command("CS")  # firmware before 2.6.2 counts on after EM

    def powered(self) -> bool:
        """Return whether the motors have power; without it the board, which lives on USB, counts steps all the same."""
        _, supply = self._command("QC", _VOLTAGES)
        return supply >= _POWERED

    def pressed(self) -> bool:
        """Return whether the button PRG was pressed since the last call."""
        return self._command("QB", _BUTTON) == (1,)

    def set_pen(self, up: float, down: float) -> None:
        """Set the servo's pulses for the lifted and the lowered pen, in units of 1/12 microsecond; keep its power on.

        A servo without power may let the pen sink while the machine waits for a person.
        """
        self._command(f"SC,4,{up:.0f}")
        self._command(f"SC,5,{down:.0f}")
        if self._version >= _SWITCHES_SERVO:
            self._command("SR,0")
            self._holds = True

    def leave_pen(self) -> None:
        """Let the board take the servo's power away again, as it usually does; waits for no answer."""
        if self._holds:
            self._line.write(f"SR,{_USUAL_REST}\r".encode())

    def pen(self, down: bool, seconds: float) -> None:
        """Lift or lower the pen, and wait for so many seconds before the next motion."""
        self._command(f"SP,{0 if down else 1},{max(round(1e3 * seconds), 1)}")

    def steps(self, milliseconds: int, first: int, second: int) -> None:
        """Step both motors evenly in that time; returns once the motion before this one has begun."""
        self._command(f"SM,{milliseconds},{first},{second}")

    def position(self) -> tuple[int, int]:
        """Return the steps of both motors since they were enabled."""
        first, second = self._command("QS", _POSITION)
        return first, second

    def wait(self) -> None:
        """Wait until nothing moves and nothing is queued."""
        while any(self._ask("QM", _MOTORS)):
            self._stopping.wait(GLANCE)

    def _take_back_modes(self) -> None:
        """Let the board answer, and queue one motion, as when it is switched on; NextDraw leaves it otherwise."""
        self._send(syntax := "CU,10,0")
        if (text := self._answer()) not in ("OK", "CUOK"):  # the latter where it had to change
            self._numbers(syntax, _NOTHING, text)
        self._command("CU,4,1")

    def _command(self, command: str, pattern: str = _NOTHING) -> tuple[int, ...]:
        """Send a command, and return the numbers in the line of this pattern that comes before OK."""
        self._send(command)
        numbers: tuple[int, ...] = ()
        while (text := self._answer()) != "OK":
            numbers = self._numbers(command, pattern, text)
        if pattern != _NOTHING and not numbers:
            raise self._noise("OK")
        return numbers

    def _ask(self, command: str, pattern: str) -> tuple[int, ...]:
        """Send a command, and return the numbers in its answer, which has no OK."""
        self._send(command)
        return self._numbers(command, pattern, self._answer())

    def _send(self, command: str) -> None:
        self._obey()
        self._line.write(f"{command}\r".encode())

    def _answer(self) -> str:
        patience = Patience(self._patience)
        while not patience.over:
            self._obey()
            if (text := self._line.line()) is not None:
                return text
        raise self._line.lost()

    def _obey(self) -> None:
        if self._stopping.is_set():
            raise StoppedError

    def _numbers(self, command: str, pattern: str, text: str) -> tuple[int, ...]:
        if (found := re.fullmatch(pattern, text)) is not None:
            return tuple(map(int, found.groups()))
        if text.startswith("!"):
            raise MachineError(f"the board on {self._line.port} refused {command!r}: {' '.join(text[1:].split())}")
        raise self._noise(text)

    def _noise(self, text: str) -> MachineError:
        shown = text if len(text) <= 40 else text[:37] + "..."
        return MachineError(
            f"there is noise on the line to {self._line.port} ({shown!r}); check cable and hub",
            Remedy.GO_ON,
        )


def open_board_line(port: str | None) -> SerialLine:
    """Open the line to the board on this port, or to the one that is plugged in; raises as `port_of_the_board`."""
    return SerialLine(port_of_the_board() if port is None else port, _BAUD)


def port_of_the_board() -> str:
    """Return the port of the one board that is plugged in. Raises InputError where there is none, or several."""
    found = [it.device for it in list_ports.comports() if (it.vid, it.pid) == _USB]
    if not found:
        raise InputError("no AxiDraw is plugged in", Remedy.NAME_PORT)
    if len(found) > 1:
        raise InputError(f"there are several AxiDraws; name one of their ports: {', '.join(sorted(found))}")
    return str(found[0])
