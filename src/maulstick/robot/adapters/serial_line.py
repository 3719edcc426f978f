"""A serial line to a machine: bytes are sent, whole lines are read, and a fault is one sentence."""

import os
import sys
import time
from contextlib import suppress
from errno import ENOTTY
from typing import Final, final

import serial

from maulstick.errors import InputError, MachineError, Remedy

GLANCE: Final = 0.01
"""Seconds that one read waits at most, which bounds how late a stop is seen."""

_LONGEST_LINE = 4096  # bytes: no machine sends a longer line, but noise may never end one
_LONGEST_REST = 1.0  # seconds: what comes for longer is no rest of earlier answers, but a device that never pauses


@final
class SerialLine:
    """Serial line that no other program can open meanwhile.

    Raises InputError where there is no such port, and MachineError once the line is broken.
    """

    def __init__(self, port: str, baud: int) -> None:
        self.port = port
        self._came = b""
        self._lines: list[str] = []
        try:
            self._serial = serial.Serial(port, baud, timeout=GLANCE, write_timeout=1.0, exclusive=True)
        except OSError as error:
            raise InputError(
                f"cannot open the port {port}: {_reason(error)}; is it plugged in, free, and may you use it?"
            ) from error
        except (ValueError, OverflowError) as error:
            raise InputError.of_range("the baud rate", baud, "one that the port has, such as 115200") from error
        _leave_raised(self._serial)

    def write(self, content: bytes) -> None:
        """Send all bytes; may be called from any thread."""
        try:
            self._serial.write(content)
        except (OSError, TypeError) as error:  # a TypeError where another thread has closed it
            raise self.lost() from error

    def line(self) -> str | None:
        """Return the next line without its end, or None where none is complete yet. Bytes beyond ASCII become �."""
        if not self._lines:
            self._read()
        return self._lines.pop(0) if self._lines else None

    def drop(self) -> None:
        """Drop what has come and was not read, until nothing comes, or the device never pauses."""
        rest = Patience(_LONGEST_REST)
        while self._read() and not rest.over:
            pass
        self._came, self._lines = b"", []

    def close(self) -> None:
        """Release the port."""
        self._serial.close()

    def lost(self) -> MachineError:
        """Return the error to raise once nothing comes any more."""
        return MachineError(f"the line to {self.port} went silent; check cable and power", Remedy.GO_ON)

    def _read(self) -> bool:
        try:
            came: bytes = self._serial.read(max(1, self._serial.in_waiting))
        except (OSError, TypeError) as error:
            raise self.lost() from error
        self._came = (self._came + came).replace(b"\r", b"\n")
        *whole, self._came = self._came.split(b"\n")
        if len(self._came) > _LONGEST_LINE:
            whole, self._came = [*whole, self._came], b""
        self._lines += [line.decode("ascii", "replace").strip() for line in whole if line.strip()]
        return bool(came)


def _reason(error: OSError) -> str:
    """Return why a port cannot be opened; where it cannot be set up, pyserial has the number in what it caught."""
    numbers = (error.errno, *getattr(error.__context__, "args", ()))
    number = next((number for number in numbers if isinstance(number, int)), None)
    if number == ENOTTY:
        return "it is no serial port"
    return str(error) if number is None else os.strerror(number)


def _leave_raised(port: serial.Serial) -> None:
    """Leave the DTR line raised once the port is closed: boards restart, and forget their place, when it is raised."""
    if sys.platform == "win32" or port.fd is None:
        return
    import termios

    with suppress(termios.error):  # a device that has no such line
        attributes = termios.tcgetattr(port.fd)
        attributes[2] &= ~termios.HUPCL
        termios.tcsetattr(port.fd, termios.TCSANOW, attributes)


@final
class Patience:
    """Timer of how long a machine may give no useful answer: `seconds` since it was made or renewed."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self.renew()

    def renew(self) -> None:
        """Start the time again."""
        self._ends = time.monotonic() + self._seconds

    @property
    def over(self) -> bool:
        """Whether the time is over."""
        return time.monotonic() > self._ends
