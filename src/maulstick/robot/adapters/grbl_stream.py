"""Grbl's streaming protocol: lines are sent as long as its buffer has room, counted in characters (Grbl 1.1 interface).

A line counts from when it is sent until Grbl has answered it. Status reports are requested meanwhile, so that a line
that takes long can be told from a Grbl that is gone.
"""

import re
import time
from typing import Final, final

from maulstick.errors import MachineError, Remedy
from maulstick.robot.adapters.grbl_answers import ALARMS, ERRORS, REMEDIES, Status
from maulstick.robot.adapters.serial_line import Patience, SerialLine
from maulstick.robot.plotter import LockedError
from maulstick.robot.robot import StoppedError
from maulstick.robot.stopping import Stopping

BUFFER: Final = 127
"""Bytes that Grbl can hold unread: its 128, less one that tells full from empty."""

HOLD: Final = b"!"
"""Command that brakes at once, whatever else is on the line."""

_RESET, _REPORT, _GO_ON = b"\x18", b"?", b"~"  # real-time commands: soft reset, a status report, the end of a hold
_USUAL, _FASTER, _SLOWER = b"\x90", b"\x91", b"\x92"  # overrides of the feed: 100 %, 10 % more, 10 % less
_STEP = 10  # per cent of those
_BETWEEN_REPORTS = 0.2  # seconds; Grbl's interface asks for at most 5 per second
_BETWEEN_RESETS = 1.0  # seconds; a board that restarts when its port is opened misses the first reset
_DEAF = 1.0  # seconds without a report: after the alarm of a limit, Grbl hears nothing but a reset
_QUIET = 0.1  # seconds in which a board that took both resets greets a second time
_HALTED = ("Hold:0", "Idle", "Alarm", "Sleep", "Door:0", "Door:1")  # states at rest
_MOVING = ("Run", "Jog")
_UNABLE = {
    "Door": "its safety door is open; close it",
    "Check": "it only checks G-code; send $C, then start again",
    "Sleep": "it sleeps; reset it, then start again",
    "Alarm": "it is locked, as its position may be lost",
}
_REMEDIES = {"Door": Remedy.GO_ON, "Alarm": Remedy.UNLOCK}


@final
class GrblStream:
    """Line to a Grbl: sends commands and reads its answers.

    override: per cent of the commanded speed that is wanted, in steps of 10; another thread may change it.
    has_restarted: whether it has started again by itself since it was reset, and counts its place from where it then
    stood.
    Raises MachineError where it is silent, fails or is not understood; `run` raises StoppedError once `stopping` is
    set.
    """

    def __init__(self, line: SerialLine, patience: float, stopping: Stopping) -> None:
        self._line = line
        self._patience = patience
        self._stopping = stopping
        self._waiting: list[str] = []
        self._told: list[str] = []
        self._progress = Patience(patience)
        self._next_report = 0.0
        self.override = self._overridden = 100
        self._just_changed = False
        self.has_restarted = False

    def reset(self) -> None:
        """Reset Grbl, which empties its buffers; its position is kept if it stands still."""
        self._line.drop()
        self._waiting.clear()
        patience, resets = Patience(self._patience), 0
        while True:
            self._line.write(_RESET)
            resets += 1
            if self._starts():
                break
            if patience.over:
                raise MachineError(f"no Grbl answers on {self._line.port}; check port, baud rate, cable and power")
        again = Patience(_QUIET)
        while resets > 1 and not again.over:
            self._line.line()
        self.has_restarted = False

    def hold(self) -> None:
        """Brake; returns once it stands still, or where it does not report that."""
        self._line.write(HOLD)
        patience, deaf = Patience(self._patience), Patience(_DEAF)
        at_rest = 0
        while not patience.over and not deaf.over:
            if (status := self._report()) is not None:
                at_rest = at_rest + 1 if status.state in _HALTED else 0
                if at_rest == 2:  # the first may have been asked for before it began to move
                    return
                deaf.renew()

    def end_motion(self) -> None:
        """Brake where a run that was killed has left it moving, since a reset would lose its place."""
        if (status := self._report()) is not None and status.state in _MOVING:
            self.hold()

    def release(self) -> None:
        """End a hold in which it stands still and has nothing left to do, so that other programs find it idle."""
        if self._waiting:  # it would go on with what it was sent
            return
        patience = Patience(_DEAF)
        while not patience.over:  # reports that were asked for before the hold may come first
            if (status := self._report()) is not None and status.state == "Hold:0":
                self._line.write(_GO_ON)
                return

    def take_back_override(self) -> None:
        """Let it move as fast as commanded again, so that other programs find it so; waits for no answer."""
        if self._overridden != 100:
            self._line.write(_USUAL)

    def status(self, ready: bool = True) -> Status:
        """Ask for the status. ready: raise MachineError, which says what to do, where it is not ready to draw."""
        patience = Patience(self._patience)
        while not patience.over:
            if (status := self._report()) is not None:
                if ready:
                    self._check(status)
                return status
        raise self._line.lost()

    def ask(self, command: str) -> list[str]:
        """Send a command, and return the lines that come before its ok."""
        self._told.clear()
        self._send(command)
        while self._waiting:
            self._hear()
        return self._told.copy()

    def find_home(self) -> None:
        """Find home by switches, raising StoppedError as `run`. Grbl tells nothing meanwhile; a reset stops it."""
        self._heed_stop()
        self._send("$H")
        while self._waiting:
            self._heed_stop()
            self._hear()

    def run(self, lines: list[str]) -> None:
        """Send lines; returns once their motions have ended, not only been read."""
        for line in [*lines, "G4 P0"]:  # a pause of no time is answered once all motions before it have ended
            content = line.replace(" ", "")
            while sum(map(_size, self._waiting)) + _size(content) > BUFFER:
                self._go_on()
            self._send(content)
        while self._waiting:
            self._go_on()

    def _report(self) -> Status | None:
        """Ask for the status once; returns None where it does not come, or noise has changed it."""
        self._line.write(_REPORT)
        asked = Patience(_BETWEEN_REPORTS)
        while not asked.over:
            text = self._line.line() or ""
            if (status := Status.parse(text)) is not None:
                return status
            self.has_restarted |= _greets(text)  # what came before, as noise on its own line, was the fault
        return None

    def _heed_stop(self) -> None:
        if self._stopping.is_set():
            raise StoppedError

    def _go_on(self) -> None:
        self._heed_stop()
        if (now := time.monotonic()) > self._next_report:
            self._line.write(_REPORT + self._override_nearer())
            self._next_report = now + _BETWEEN_REPORTS
        self._hear()

    def _override_nearer(self) -> bytes:
        """Return the command that takes the override nearer to the wanted one, at every other report, or nothing.

        Grbl counts two commands that come at once as one, so each is seen in a report before the next is sent.
        """
        missing = self.override - self._overridden
        self._just_changed = missing != 0 and not self._just_changed
        if not self._just_changed:
            return b""
        self._overridden = 100 if self.override == 100 else self._overridden + (_STEP if missing > 0 else -_STEP)
        return _USUAL if self.override == 100 else _FASTER if missing > 0 else _SLOWER

    def _send(self, content: str) -> None:
        if not self._waiting:
            self._progress.renew()
        self._waiting.append(content)
        self._line.write(f"{content}\n".encode())

    def _hear(self) -> None:
        text = self._line.line()
        if text is None:
            if self._progress.over:
                raise self._line.lost()
        elif text == "ok" and self._waiting:
            self._waiting.pop(0)
            self._progress.renew()
        elif text.startswith("<") or text.endswith(">"):  # a report that noise has changed comes again
            if (status := Status.parse(text)) is not None:
                self._check(status)
                if status.override is not None and not self._just_changed:
                    self._overridden = status.override
                if status.state != "Idle":  # an idle Grbl that owes an answer has lost it
                    self._progress.renew()
        elif text.startswith(("[", "$", ">")):
            self._told.append(text)
        else:
            raise self._fault(text)

    def _fault(self, text: str) -> MachineError:
        port = self._line.port
        if found := re.fullmatch(r"error:(\d+)", text):
            line = self._waiting[0] if self._waiting else ""
            said = ERRORS.get(int(found[1]), "it does not say what that means")
            fault = f"the Grbl on {port} refused the line {line!r} with error {found[1]}: {said}"
            return MachineError(fault, REMEDIES.get(text))
        if found := re.fullmatch(r"ALARM:(\d+)", text):
            code, unknown = int(found[1]), f"it does not say why; {_UNABLE['Alarm']}"
            fault = f"the Grbl on {port} raised alarm {code}: {ALARMS.get(code, unknown)}"
            return MachineError(fault, REMEDIES.get(text) if code in ALARMS else Remedy.UNLOCK)
        if _greets(text):
            self.has_restarted = True
            return MachineError(f"the Grbl on {port} started again by itself; check its power", Remedy.HOME)
        shown = text if len(text) <= 40 else text[:37] + "..."
        return MachineError(
            f"there is noise on the line to {port} ({shown!r}); check cable and ground",
            Remedy.GO_ON,
        )

    def _check(self, status: Status) -> None:
        state = status.state.split(":")[0]
        if (reason := _UNABLE.get(state)) is not None:
            kind = LockedError if state == "Alarm" else MachineError
            raise kind(f"the Grbl on {self._line.port} cannot draw: {reason}", _REMEDIES.get(state))

    def _starts(self) -> bool:
        """Return whether Grbl greets in time. Raises MachineError where it is not version 1.1."""
        patience = Patience(min(_BETWEEN_RESETS, self._patience))
        while not patience.over:
            if (found := re.match(r"(?i)(grbl\w*) (\S+)", self._line.line() or "")) is not None:
                if found[1] != "Grbl" or not found[2].startswith("1.1"):  # grblHAL greets as GrblHAL 1.1f
                    raise MachineError(
                        f"the machine on {self._line.port} is a {found[1]} {found[2]}; it must be a Grbl 1.1, or be "
                        "given a file, as maulstick export writes"
                    )
                return True
        return False


def _greets(text: str) -> bool:
    return "Grbl " in text  # perhaps after noise, as power came back


def _size(content: str) -> int:
    return len(content) + 1
