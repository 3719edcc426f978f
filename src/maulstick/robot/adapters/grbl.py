"""Plotters and small machines that run Grbl 1.1, over a serial port."""

from collections.abc import Iterable
from contextlib import closing, suppress
from itertools import product
from typing import Literal, final

import numpy as np
from pydantic import ValidationError

from maulstick.errors import InputError, MachineError, validation_fault
from maulstick.robot.adapters.grbl_answers import (
    MOVES,
    homing_seconds,
    is_zero_at_switches,
    own_limits,
    settings_of,
    work_origin,
)
from maulstick.robot.adapters.grbl_stream import HOLD, GrblStream
from maulstick.robot.adapters.serial_line import SerialLine
from maulstick.robot.easel import Easel, Pen
from maulstick.robot.export.gcode import Gcode
from maulstick.robot.limits import Limits
from maulstick.robot.plotter import HasServo, KeepsOrigin, LetsGo, LocksItself, OverridesSpeed
from maulstick.robot.stopping import Stopping
from maulstick.storage.arrays import Floats

_BAUD = 115200  # the rate of Grbl 1.1 as it ships
_CLEAR = 5e-3  # metres above the paper, or where that is lost, above the tip: height to which it is lifted at first
_ANY_SPEED = np.array([1e-3])  # metres per second: of a motion that only lowers the pen
_FACTORY = Limits(  # of Grbl as it ships, until the machine has told its own
    lower=(0, 0, -0.2), upper=(0.2, 0.2, 0.2), speed=0.5 / 60, climb=0.5 / 60, acceleration=0.01, varies_pressure=True
)


@final
class Grbl(KeepsOrigin, LetsGo, LocksItself, HasServo, OverridesSpeed):
    """Machine with Grbl 1.1, in its work coordinates (G54): lower left corner of the sheet at (0, 0), paper at 0.

    address: the port, as /dev/ttyUSB0 or /dev/ttyUSB0@115200.  pen: servo of its pen; None where it lifts by height.
    limits: limits narrower than its own. Its own are known while it is `connected` or entered, and after.
    patience: seconds without an answer until it counts as lost.
    """

    def __init__(
        self, address: str, pen: Pen | None = None, limits: Limits | None = None, patience: float = 5.0
    ) -> None:
        port, at, baud = address.partition("@")
        if at and not baud.isdecimal():
            raise InputError.of_range(
                "the baud rate of a Grbl", repr(baud), "a whole number, as in /dev/ttyUSB0@115200"
            )
        super().__init__(limits or _FACTORY)
        self._port, self._baud = port, int(baud) if at else _BAUD
        self._pen = pen
        self._narrower = limits
        self._patience = patience + (0.0 if pen is None else pen.seconds)
        self._line: SerialLine | None = None
        self._origin: Floats = np.zeros(3)
        self._servo_range = (0.0, 0.0)
        self._finds_home = False

    def easel(self, width: float, height: float) -> Easel:
        """Return a flat easel whose lower left corner is the work's origin, as `Robot.easel`."""
        return Easel(corner=(0, height, 0), right=(1, 0, 0), down=(0, -1, 0), pen=self._pen)

    @property
    def counts_steps(self) -> bool:
        """As `Robot.counts_steps`."""
        return True

    @property
    def home(self) -> Floats | None:
        """As `Robot.home`: the work's origin, but for one that finds its place at switches, $22=1."""
        return None if self._finds_home else np.zeros(2)

    @property
    def pen(self) -> Pen | None:
        """As in `HasServo`."""
        return self._pen

    @property
    def servo_range(self) -> tuple[float, float]:
        """As in `HasServo`: $31 to $30, once it is entered."""
        return self._servo_range

    @property
    def highest_override(self) -> int:
        """As in `OverridesSpeed`: Grbl keeps to its own highest speeds, but knows of no narrower ones."""
        return 200 if self._narrower is None else 100

    def override(self, percent: int) -> None:
        """As in `OverridesSpeed`."""
        self._stream.override = percent

    def set_pen(self, pen: Pen) -> None:
        """As in `HasServo`."""
        self._check_pen(pen)
        self._pen, self._gcode = pen, Gcode("grbl", self.limits, pen)
        self._do(self._set_servo)

    def find_home(self) -> None:
        """As in `LocksItself`, by $H. What interrupts it stops the machine, and leaves it locked."""
        with closing(SerialLine(self._port, self._baud)) as line:
            stream = self._reset(line)
            settings = _Settings(stream.ask("$$"), self._port)
            if not settings[22]:
                raise InputError(
                    f"the Grbl on {self._port} has no switches to find home by ($22=0); unlock it if its pen stands "
                    "where it did, or else switch it off and on with its pen at home"
                )
            if not (settings[24] and settings[25]):
                raise InputError(f"the Grbl on {self._port} is to look for home at no speed; set $24 and $25 above 0")
            patience = self._patience + homing_seconds(settings)
            if self._pen is not None and stream.status(ready=False).state == "Idle":  # the reset let its servo go
                gcode = Gcode("grbl", self.limits, self._pen)
                stream.run(gcode.lift(np.array(self.limits.upper)))
            try:
                GrblStream(line, patience, self._stopping).find_home()
            except BaseException:
                with suppress(MachineError):
                    self._reset(line)
                raise

    def unlock(self) -> None:
        """As in `LocksItself`, by $X."""
        with closing(SerialLine(self._port, self._baud)) as line:
            self._reset(line).ask("$X")

    def let_go(self) -> None:
        """Raise InputError, since Grbl 1.1 cannot switch its motors off and keep its place."""
        raise InputError(
            "a Grbl 1.1 lets its motors go only at rest, by its setting $1 (25 after 25 ms, 255 never), or to sleep, "
            "with $SLP, which locks it; to move it by hand, set $1=25, or switch it off"
        )

    def set_origin(self, what: Literal["corner", "paper"]) -> None:
        """As in `KeepsOrigin`: writes it into G54, which Grbl keeps.

        Without homing, the next connection takes the whole travel to lie beyond the new corner, as it always does.
        """
        self._do(lambda: self._set_origin(np.array((1, 1, 0) if what == "corner" else (0, 0, 1))))

    def _open(self) -> Floats:
        self._gcode = Gcode("grbl", self.limits, self._pen)
        return self._lift_from_where_it_is(self._stream, _CLEAR)

    def _connect(self) -> None:
        self._line = SerialLine(self._port, self._baud)
        self._stream = GrblStream(self._line, self._patience, self._stopping)
        self._stream.end_motion()
        self._stream.reset()
        self._stream.status()
        self._take_settings()

    def _reset(self, line: SerialLine) -> GrblStream:
        """Return the stream of a line whose Grbl has been reset."""
        stream = GrblStream(line, self._patience, Stopping())
        stream.reset()
        return stream

    def _close(self) -> None:
        if self._line is not None:
            with suppress(MachineError):  # a line that is lost is closed all the same
                if self._stopping.is_set() and not self._out_of_use:
                    self._stream.release()
                self._stream.take_back_override()
            self._line.close()
            self._line = None

    def _move(self, place: Floats) -> Floats:
        self._stream.run(self._gcode.travel(self.place, place))
        return self._gcode.rounded(place)

    def _stroke(self, path: Floats, speed: Floats) -> Floats:
        self._stream.run(self._gcode.draw(self.place, path, speed))
        return self._gcode.rounded(path)

    def _lift(self, place: Floats) -> Floats:
        self._stream.run(self._gcode.lift(place))
        return np.array([*place[:2], self._gcode.rounded(place)[2]])

    def _set_servo(self) -> Floats:
        place = self.place
        self._stream.run(self._gcode.lift(place) if self.lifted else self._gcode.draw(place, place[None], _ANY_SPEED))
        return place

    def _set_origin(self, moved: Floats) -> Floats:
        self._stream.run(["G10 L20 P1 Z0" if moved[2] else "G10 L20 P1 X0 Y0"])
        place = self.place
        self._origin = self._origin + moved * place
        self._clear -= float(moved[2] * place[2])
        self.limits = self.limits.shifted(-moved * place)
        self._gcode = Gcode("grbl", self.limits, self._pen)
        return np.asarray(place - moved * place)

    def _halt(self) -> None:
        if (line := self._line) is not None:
            with suppress(MachineError):  # the call that waits for the machine raises it
                line.write(HOLD)

    def _recover(self) -> None:
        if self._line is None:
            return
        stream = GrblStream(self._line, self._patience, Stopping())  # a flag of its own, so that no stop interrupts it
        stream.has_restarted = self._stream.has_restarted
        stream.hold()
        # The one before waits for answers to what the reset drops.
        self._stream = GrblStream(self._line, self._patience, self._stopping)
        self._stream.has_restarted = stream.has_restarted
        has_lost_height = self._pen is None and stream.has_restarted
        stream.reset()
        if stream.status(ready=False).state == "Alarm" and not has_lost_height:  # its lock tells that it has
            stream.ask("$X")
        self._lift_from_where_it_is(stream, self.place[2], _CLEAR if has_lost_height else 0.0)

    def _lift_from_where_it_is(self, stream: GrblStream, height: float, least: float = 0.0) -> Floats:
        """Lift the pen to a height, metres, unless it is higher; returns the place of the tip then, (3,).

        least: metres by which it rises in any case. Raises MachineError where that would leave the limits.
        """
        status = stream.status()
        tip = status.tip - self._origin if status.of_machine else status.tip
        if least and tip[2] + least > self.limits.upper[2]:
            raise MachineError(f"the Grbl on {self._port} has no room to rise from where it counts its pen")
        height = max(height, tip[2] + least)
        lifted = np.array([*tip[:2], np.clip(height, self.limits.lower[2], self.limits.upper[2])])
        stream.run([*self._gcode.begin(), *self._gcode.lift(lifted)])
        return lifted

    def _take_settings(self) -> None:
        """Ask the machine for its settings, and set the limits and the work's origin by them."""
        settings = _Settings(self._stream.ask("$$"), self._port)
        origin = work_origin(self._stream.ask("$#"))
        if origin is None:
            raise MachineError(f"the Grbl on {self._port} did not tell where its work's origin lies; start again")
        try:
            self._check_modes(settings)
            at_switches = self._finds_home and is_zero_at_switches(self._stream.ask("$I"))
            own = own_limits(settings, origin, self._pen, at_switches)
            self.limits = own if self._narrower is None else own.narrowed(self._narrower)
        except ValidationError as error:
            raise InputError(
                f"the settings of the Grbl on {self._port} leave no limits: {validation_fault(error)}"
            ) from error
        self._origin = origin

    def _check_modes(self, settings: dict[int, float]) -> None:
        """Raise MachineError for settings that would make commands mean something else.

        Raises InputError for those by which an axis does not move, and for a wrong pen.
        """
        if settings[13]:
            raise MachineError(f"the Grbl on {self._port} reports in inches; send $13=0, then start again")
        for (first, what, unit), (axis, name) in product(MOVES, enumerate("xyz" if self._pen is None else "xy")):
            if settings[first + axis] <= 0:
                setting = f"${first + axis}"
                fault = f"the Grbl on {self._port} has no {what} along {name} ({setting}={settings[first + axis]:g})"
                raise InputError(f"{fault}; set {setting} to what it is, in {unit}")
        self._servo_range, self._finds_home = (settings[31], settings[30]), bool(settings[22])
        if self._pen is None:
            return
        if settings[32]:
            raise MachineError(f"the Grbl on {self._port} is in laser mode, which moves the servo; send $32=0")
        self._check_pen(self._pen)

    def _check_pen(self, pen: Pen) -> None:
        """Raise InputError where the servo cannot be where the pen's numbers say."""
        lowest, highest = self._servo_range
        for name, target in (("up", pen.up), ("down", pen.down)):
            if not lowest <= target <= highest:
                allowed = f"{lowest:g} to {highest:g} ($31 to $30 of this Grbl)"
                raise InputError.of_range(f"the pen's {name}", f"{target:g}", allowed)


@final
class _Settings(dict[int, float]):
    """Settings of the Grbl on a port, by its answer to $$. Raises MachineError for one that it did not tell."""

    def __init__(self, lines: Iterable[str], port: str) -> None:
        super().__init__(settings_of(lines))
        self._port = port

    def __missing__(self, number: int) -> float:
        raise MachineError(f"the Grbl on {self._port} did not tell its setting ${number}; start again")
