"""A serial line to a machine: bytes there, whole lines back, and what breaks it in one sentence."""

import os
import time
from typing import Final, final

import serial

from maulstick.errors import InputError, MachineError, Remedy

GLANCE: Final = 0.01
"""Seconds that one look for an answer takes at most."""

_LONGEST_LINE = 4096  # bytes: no machine says more at once, but noise may


@final
class SerialLine:
    """An open line, that no other program can open.

    Raises InputError where there is no such port, and MachineError once the line is broken.
    """

    def __init__(self, port: str, baud: int) -> None:
        self.port = port
        self._came = b""
        self._lines: list[str] = []
        try:
            self._serial = serial.Serial(port, baud, timeout=GLANCE, write_timeout=1.0, exclusive=True)
        except OSError as error:
            reason = os.strerror(error.errno) if error.errno else str(error)
            raise InputError(
                f"cannot open the port {port}: {reason}; is it plugged in, free, and may you use it?"
            ) from error
        except ValueError as error:
            raise InputError.of_range("the baud rate", baud, "one that the port has, such as 115200") from error

    def write(self, content: bytes) -> None:
        """Send all of it; from any thread."""
        try:
            self._serial.write(content)
        except (OSError, TypeError) as error:  # a TypeError where another thread has closed it
            raise self.lost() from error

    def line(self) -> str | None:
        """The next line without its end, or None where none is whole within a glance. Bytes beyond ASCII become �."""
        if not self._lines:
            self._read()
        return self._lines.pop(0) if self._lines else None

    def drop(self) -> None:
        """Forget what has come and was not read."""
        while self._read():
            pass
        self._came, self._lines = b"", []

    def close(self) -> None:
        """Give the port free."""
        self._serial.close()

    def lost(self) -> MachineError:
        """What to raise once nothing comes any more."""
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


@final
class Patience:
    """How long a machine may say nothing that helps: `seconds` since it was last `renewed`."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self.renew()

    def renew(self) -> None:
        """Start again."""
        self._ends = time.monotonic() + self._seconds

    @property
    def over(self) -> bool:
        """Whether it has been too long."""
        return time.monotonic() > self._ends
