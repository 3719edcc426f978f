"""The AxiDraw: its EiBotBoard takes slices of even steps, so speed is planned here."""

from contextlib import suppress
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from maulstick.errors import InputError, MachineError, Remedy
from maulstick.robot.adapters.ebb_board import HALT, STEPS_PER_SECOND, EbbBoard, open_board_line
from maulstick.robot.adapters.serial_line import SerialLine
from maulstick.robot.easel import Easel, Pen
from maulstick.robot.limits import Limits
from maulstick.robot.plotter import HasServo, LetsGo
from maulstick.robot.stopping import Stopping
from maulstick.robot.timing import Profile
from maulstick.storage.arrays import Floats

_STEPS_PER_METRE = 80_000  # 2032 per inch, with steps divided by 16
_UNEVEN = 2 / _STEPS_PER_METRE  # metres: along an edge a stop may come between the steps of one motor and the other
_SLICE = 0.025  # seconds: short enough for smooth ramps and a quick stop, long enough for USB
_SHORTEST = 0.005  # seconds: slices that are shorter come faster than the board takes them
_MILLISECONDS = 1000  # per second
_SERVO = 6000, 30000  # units of 1/12 microsecond: 0.5 to 2.5 ms, the pulses that servos understand
_UNPOWERED = "the AxiDraw's motors have no power; plug its supply in, and push its pen to the home corner"
_ANOTHERS = (
    "another program left the AxiDraw away from home, with motors that do not hold or make other steps; unplug power "
    "and USB, push its pen to the home corner, and plug both in"
)
_USUAL_PEN = Pen(up=20641, down=15248, seconds=0.3)  # 60 % and 30 % of the range of the V3's servo
V3: Final = Limits(
    lower=(0, -0.218, -0.1),
    upper=(0.3, 0, 0.1),
    speed=0.2,  # where both motors add up, along a diagonal, that is 22,600 steps per second
    climb=0.2,
    acceleration=1.0,
    deviation=1e-5,
    varies_pressure=False,
)
"""Limits: an AxiDraw V3, from its home corner."""


@final
class AxiDraw(LetsGo, HasServo):
    """AxiDraw V3; its frame begins at the home corner where it is switched on, x along its rail, -y along its arm.

    port: serial port of its board; left out, the one AxiDraw that is plugged in.
    pen: `up` and `down` are pulses of its servo in units of 1/12 microsecond.
    limits: limits narrower than its own.  patience: seconds without an answer until it counts as lost.
    """

    def __init__(
        self,
        port: str | None = None,
        pen: Pen | None = None,
        limits: Limits | None = None,
        patience: float = 5.0,
    ) -> None:
        pen = pen or _USUAL_PEN
        own = V3.model_copy(update={"lifting": pen.seconds})
        super().__init__(own if limits is None else own.narrowed(limits))
        _check_pen(pen)
        self._port, self._pen = port, pen
        self._patience = patience + pen.seconds
        self._line: SerialLine | None = None

    def easel(self, width: float, height: float) -> Easel:
        """Return an easel whose upper left corner is the home corner, as `Robot.easel`."""
        return Easel(corner=(0, 0, 0), right=(1, 0, 0), down=(0, -1, 0), pen=self._pen)

    @property
    def counts_steps(self) -> bool:
        """As `Robot.counts_steps`."""
        return True

    @property
    def home(self) -> Floats:
        """As `Robot.home`: the home corner."""
        return np.zeros(2)

    @property
    def pen(self) -> Pen:
        """As in `HasServo`."""
        return self._pen

    @property
    def servo_range(self) -> tuple[float, float]:
        """As in `HasServo`."""
        return _SERVO

    def set_pen(self, pen: Pen) -> None:
        """As in `HasServo`."""
        _check_pen(pen)
        self._pen = pen
        self._do(self._set_servo)

    def let_go(self) -> None:
        """As in `LetsGo`."""
        self.lift(self.place[2])
        self._do(self._switch_off)
        self._out_of_use = True

    def _connect(self) -> None:
        self._line = open_board_line(self._port)
        self._board = EbbBoard(self._line, self._patience, self._stopping)
        self._board.greet()

    def _open(self) -> Floats:
        self._board.set_pen(self._pen.up, self._pen.down)
        self._board.pen(down=False, seconds=self._pen.seconds)
        self._board.wait()
        self._check_power(None)
        if self._board.position() == (0, 0):  # a board that has counted steps still holds its motors, and its place
            self._board.enable()
        elif not self._board.holds():
            raise MachineError(_ANOTHERS)
        self._board.pressed()  # what was pressed before does not count
        place = self._where(0.0)
        try:
            V3.check_path(place[None])  # not the narrower limits, which may leave out its home
        except InputError as error:
            raise MachineError(
                f"the AxiDraw is not where it may be; unplug power and USB, and plug them in at its home: {error}"
            ) from error
        return place

    def _close(self) -> None:
        if self._line is not None:
            with suppress(MachineError):  # a line that is lost is closed all the same
                self._board.leave_pen()
            self._line.close()
            self._line = None

    def _move(self, place: Floats) -> Floats:
        _, goal = self._follow(np.stack([self.place, place]), np.full(2, self.limits.speed))
        return np.asarray(goal)

    def _stroke(self, path: Floats, speed: Floats) -> Floats:
        self._check_power(Remedy.GO_ON)  # without it the pen is not above the stroke
        self._board.pen(down=True, seconds=self._pen.seconds)
        return self._follow(path, speed)

    def _lift(self, place: Floats) -> Floats:
        self._board.pen(down=False, seconds=self._pen.seconds)
        self._board.wait()
        self._check_power(Remedy.GO_ON)
        return self._where(float(place[2]))

    def _pressed(self) -> bool:
        return self._board.pressed()

    def _check_power(self, remedy: Remedy | None) -> None:
        """Raise MachineError where the motors have no power: they have lost their place, which is then at home."""
        if not self._board.powered():
            self._board.release()
            raise MachineError(_UNPOWERED, remedy)

    def _set_servo(self) -> Floats:
        self._board.set_pen(self._pen.up, self._pen.down)
        self._board.pen(down=not self.lifted, seconds=self._pen.seconds)
        self._board.wait()
        return self.place

    def _switch_off(self) -> Floats:
        self._board.release()
        return self.place

    def _halt(self) -> None:
        if (line := self._line) is not None:
            with suppress(MachineError):  # the call that waits for the machine raises it
                line.write(HALT)

    def _recover(self) -> None:
        if self._line is None:
            return
        board = EbbBoard(self._line, self._patience, Stopping())  # a flag of its own, so that no stop interrupts it
        self._line.write(HALT)
        board.greet()
        board.pen(down=False, seconds=self._pen.seconds)
        board.wait()

    def _follow(self, path: Floats, speed: Floats) -> Floats:
        """Follow the path (n, 3) from where the motors are; returns its points on the grid of steps, (n, 3) metres."""
        flat = path * (1, 1, 0)
        profile = Profile.of(flat, speed, self.limits)
        instants = _instants(profile.times)
        places = profile.at(instants)
        places[-1] = flat[-1]
        ends = np.rint(instants * _MILLISECONDS).astype(np.int64)
        at, when = np.array(self._board.position()), 0
        for place, end in zip(places, ends.tolist(), strict=True):
            goal = _motors_of(self._grid(place))
            first, second = (goal - at).tolist()
            least = -(-max(abs(first), abs(second)) * _MILLISECONDS // STEPS_PER_SECOND)
            self._board.steps(max(end - when, least, 1), first, second)
            at, when = goal, end
        self._board.wait()
        return np.concatenate([self._grid(path) / _STEPS_PER_METRE, path[:, 2:]], axis=1)

    def _where(self, height: float) -> Floats:
        """Return the place (3,) that the board tells, at a height; a few steps beside an edge count as on the edge."""
        place = np.array([*(_grid_of(self._board.position()) / _STEPS_PER_METRE), height])
        for limits in (V3, self.limits):
            inside = place.clip(limits.lower, limits.upper)
            place = inside if np.abs(place - inside).max() <= _UNEVEN else place
        return place

    def _grid(self, places: Floats) -> Floats:
        """Return whole steps (..., 2) along x and y for places (..., 3), rounded towards the inside at the limits."""
        lower = np.ceil(np.array(self.limits.lower[:2]) * _STEPS_PER_METRE - 1e-6)
        upper = np.floor(np.array(self.limits.upper[:2]) * _STEPS_PER_METRE + 1e-6)
        return np.asarray(np.clip(np.rint(places[..., :2] * _STEPS_PER_METRE), lower, upper) + 0.0)


def _check_pen(pen: Pen) -> None:
    """Raise InputError where a servo does not understand one of the pen's pulses."""
    for name, pulse in (("up", pen.up), ("down", pen.down)):
        if not _SERVO[0] <= pulse <= _SERVO[1]:
            raise InputError.of_range(
                f"the pen's {name}", f"{pulse:g}", "{} to {} (twelfths of a microsecond)".format(*_SERVO)
            )


def _instants(times: Floats) -> Floats:
    """Return the seconds at which slices end, for times (n,) at a path's points; close points share a slice."""
    ends, last = [0.0], 0.0
    for time in times[1:].tolist():
        if time - last >= _SHORTEST or time == times[-1]:
            parts = max(int(np.ceil((time - last) / _SLICE)), 1)
            ends += np.linspace(last, time, parts + 1)[1:].tolist()
            last = time
    return np.array(ends[1:] or ends)


def _motors_of(grid: Floats) -> NDArray[np.int64]:
    """Return steps (2,) of the motors for steps (2,) along x and y; each motor pulls the pen along a diagonal."""
    along, across = grid  # the board's y points down the sheet
    return np.array([along - across, along + across], dtype=np.int64)


def _grid_of(motors: tuple[int, int]) -> Floats:
    """Return the inverse of `_motors_of`: steps (2,) along x and y."""
    first, second = motors
    return np.array([(first + second) / 2, (second - first) / 2])
