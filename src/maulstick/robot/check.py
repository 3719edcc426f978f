"""Check that a machine keeps what `Robot` promises: for authors of adapters, and for untested machines."""

import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial

import numpy as np

from maulstick.errors import InputError
from maulstick.robot.easel import Easel
from maulstick.robot.limits import Limits
from maulstick.robot.robot import Robot, StoppedError
from maulstick.robot.timing import Profile
from maulstick.storage.arrays import Floats

_SHEET = 0.1  # metres: sides of the sheet that is assumed where no easel is given
_HALF = 0.01  # metres: half the side of the square that is driven
_RESOLUTION = 1e-4  # metres: the most that rounding to steps or decimals may displace a place
_BEYOND = 0.01  # metres outside the workspace: places that must be refused
_SLOW = 0.01  # metres per second: the stroke lasts 2 s, long enough to be stopped on the way
_BEFORE_STOP = 0.2  # seconds from the start of that stroke to the stop
_AT_ONCE = 0.2  # seconds that the machine may take to stand still; the time for lifting is added
_CLEAR = np.array([[0, 0, 0], [0, 0, 0.02]])  # metres: the longest way up that lifting after a stop is allowed
_UP = 1e-3  # metres above the stroke: the least height at which a pen counts as lifted


@dataclass(frozen=True)
class Check:
    """Result of one check: the promise, whether it was kept, and a sentence about what was seen."""

    name: str
    passed: bool
    finding: str


def check_robot(
    robot: Robot, easel: Easel | None = None, middle: tuple[float, float] = (_SHEET / 2, _SHEET / 2)
) -> tuple[Check, ...]:
    """Move a machine, not yet entered, 10 mm to each side of a place (x, y) of the sheet, metres; report what it did.

    Its strokes end halfway between the paper and the height of travel: arms draw in the air, and a machine that only
    lifts its pen draws a short line, three times.
    easel: where the sheet lies; left out, `Robot.easel` of a sheet of 100 x 100 mm, which an arm does not have.
    Raises InputError where that does not fit the machine's limits; whatever fails afterwards is in the result.
    """
    trial = _Trial(robot, easel or robot.easel(_SHEET, _SHEET), middle)
    entered = _checked("it can be entered", trial.enters)
    if not entered.passed:
        return (entered,)
    promises: list[tuple[str, Callable[[], str]]] = [
        ("it goes where it is sent", trial.moves),
        ("it draws and lifts where it is told", trial.draws),
        ("it refuses what is outside its limits", trial.refuses),
        ("it stops at once", trial.stops),
        ("it stays stopped", trial.stays_stopped),
        ("it can be left", trial.leaves),
        ("it comes back with its pen lifted", trial.comes_back),
    ]
    try:
        return entered, *(_checked(name, promise) for name, promise in promises)
    finally:
        with suppress(Exception):  # it was left once before, and that check has its own result
            trial.leaves()


class _BrokenPromiseError(Exception):
    pass


def _checked(name: str, promise: Callable[[], str]) -> Check:
    try:
        return Check(name, True, promise())
    except _BrokenPromiseError as broken:
        return Check(name, False, str(broken))
    except Exception as error:  # an adapter may raise anything, and this is what the check finds out
        return Check(name, False, f"raised {type(error).__name__}: {error}")


class _Trial:
    """Checks of one machine; they build on each other, in the order of `check_robot`.

    Each method returns what was seen, and raises _BrokenPromiseError where the promise was not kept.
    """

    def __init__(self, robot: Robot, easel: Easel, middle: tuple[float, float]) -> None:
        self._robot = robot
        self._entered = False
        sides = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) * _HALF + middle
        self._square = easel.canvas_to_machine(np.c_[sides, np.full(5, easel.travel)])
        self._path = easel.canvas_to_machine(np.c_[sides[:2], np.full(2, easel.travel / 2)])
        robot.limits.check_path(np.concatenate([self._square, self._path]))

    def enters(self) -> str:
        self._robot.__enter__()
        self._entered = True
        return f"its tip is {1e3 * _distance(self._robot.place, self._square[0]):.0f} mm from where it is tried"

    def moves(self) -> str:
        worst = 0.0
        for corner in self._square:
            returned = self._robot.move(corner)
            worst = max(worst, _distance(returned, corner), _distance(self._robot.place, returned))
        _demand(worst <= _RESOLUTION, f"it says that it was sent {1e3 * worst:.3g} mm beside where it was")
        return f"round a square, to {1e6 * worst:.0f} µm"

    def draws(self) -> str:
        drawn = self._robot.stroke(self._path, np.full(2, self._robot.limits.speed))
        _demand(drawn.shape == self._path.shape, f"for a path {self._path.shape} it returned one {drawn.shape}")
        axes = 3 if self._robot.limits.varies_pressure else 2
        worst = _distance(drawn[:, :axes], self._path[:, :axes])
        _demand(worst <= _RESOLUTION, f"it says that it drew {1e3 * worst:.3g} mm beside the path")
        above = self._square[1, 2]
        lifted = self._robot.lift(above)
        _demand(abs(lifted[2] - above) <= _RESOLUTION, f"it says that it was lifted to {1e3 * lifted[2]:.4g} mm")
        _demand(_distance(lifted[:2], drawn[-1, :2]) <= _RESOLUTION, "it moved sideways when it was lifted")
        return f"a line of {2e3 * _HALF:.0f} mm, to {1e6 * worst:.0f} µm"

    def refuses(self) -> str:
        limits, robot = self._robot.limits, self._robot
        place = robot.move(self._square[0])
        too_fast = np.full(2, 2 * limits.speed)
        attempts: list[tuple[str, Callable[[], object]]] = [
            (f"place {1e3 * _BEYOND:g} mm outside its workspace", partial(robot.move, outside))
            for outside in _outside(place, limits)
        ]
        attempts += [
            ("speed that is twice its own", lambda: robot.stroke(self._path, too_fast)),
            ("height above its workspace", lambda: robot.lift(limits.upper[2] + _BEYOND)),
        ]
        for what, attempt in attempts:
            try:
                attempt()
            except InputError:
                pass
            else:
                raise _BrokenPromiseError(f"it accepted a {what}")
            _demand(_distance(robot.place, place) == 0, f"it refused a {what}, and moved")
        return f"{len(attempts)} times, and stood still"

    def stops(self) -> str:
        stopped_at: list[float] = []

        def stop() -> None:
            stopped_at.append(time.monotonic())
            self._robot.stop()

        self._robot.move(self._square[0])
        other = threading.Timer(_BEFORE_STOP, stop)
        other.start()
        try:
            self._robot.stroke(self._path, np.full(2, _SLOW))
        except StoppedError:
            took = time.monotonic() - stopped_at[0]
        else:
            raise _BrokenPromiseError("a stroke of 2 s was over before it was stopped, or went on")
        finally:
            other.join()
        limits = self._robot.limits
        lifting = limits.lifting + Profile.of(_CLEAR, np.full(2, limits.speed), limits).seconds
        _demand(took <= _AT_ONCE + lifting, f"it took {took:.2f} s, of which lifting takes {lifting:.2f} at most")
        return f"and was lifted, in {took:.2f} s"

    def stays_stopped(self) -> str:
        calls: list[tuple[str, Callable[[], object]]] = [
            ("moved", lambda: self._robot.move(self._square[0])),
            ("drew", lambda: self._robot.stroke(self._path, np.full(2, _SLOW))),
        ]
        for what, call in calls:
            try:
                call()
            except StoppedError:
                continue
            raise _BrokenPromiseError(f"it {what} after it was stopped")
        return "it neither moved nor drew"

    def comes_back(self) -> str:
        self.enters()
        height = self._robot.place[2] - self._path[-1, 2]
        if self._robot.limits.varies_pressure:
            _demand(height >= _UP, f"after it was stopped, its tip is {1e3 * height:.2g} mm above the stroke")
        self.moves()
        return "and goes where it is sent, as before"

    def leaves(self) -> str:
        if self._entered:
            self._entered = False
            self._robot.__exit__(None, None, None)
        return "without an error"


def _outside(place: Floats, limits: Limits) -> list[Floats]:
    """Return places (3,), each like the given one but a little beyond one face of the workspace."""
    beyond = np.stack([np.array(limits.lower) - _BEYOND, np.array(limits.upper) + _BEYOND])
    return [np.where(np.arange(3) == axis, face, place) for face in beyond for axis in range(3)]


def _demand(kept: bool, otherwise: str) -> None:
    if not kept:
        raise _BrokenPromiseError(otherwise)


def _distance(one: Floats, other: Floats) -> float:
    return float(np.sqrt(((one - other) ** 2).sum(axis=-1)).max())
