"""The abstract machine: it moves, draws strokes, lifts and stops; every motion is checked against its limits first."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import TracebackType
from typing import ClassVar, Self, TypeVar, final

import numpy as np

from maulstick.errors import InputError, MachineError
from maulstick.robot.easel import Easel
from maulstick.robot.limits import Limits
from maulstick.robot.stopping import Stopping
from maulstick.storage.arrays import Floats
from maulstick.storage.text import counted

Result = TypeVar("Result")

_SAME_PLACE = 1e-4  # metres: a stroke may begin so far beside the pen; covers rounding to steps or decimals


class StoppedError(MachineError):
    """Error that says that the machine was stopped."""

    def __init__(self) -> None:
        super().__init__("the machine was stopped")


class Robot(ABC):
    """Machine that draws: a context, entered before anything moves, and left with the pen lifted.

    Lengths are metres in the machine's own frame, right-handed, z up. Calls return the places that were really
    commanded, which steps or decimals may have rounded. No command outside the workspace or beyond the speed of the
    `limits` is ever sent, but to lift a tip straight up that was put beside it: a call that would need one raises
    InputError, and nothing moves. An arm's reach is computed, so it is checked before a plan begins, by `check_room`,
    and not here: no lift may fail by it. All calls raise MachineError where the machine fails. After that, and after
    `stop`, they raise StoppedError until the machine is entered again. `stop` may be called from any thread or signal
    handler, all else from one thread.

    An adapter implements the abstract methods. They return once the machine has arrived; one that takes longer than
    0.1 s looks at `_stopping` that often, and raises StoppedError.
    """

    knows_its_reach: ClassVar[bool] = False
    """Whether the machine itself can be asked what it `accepts`."""

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self._stopping = Stopping()
        self._place: Floats | None = None
        self._clear = -np.inf  # height at which the pen was last known to be lifted, metres
        self._down = self._low = self._out_of_use = self._connected = False

    @final
    def __enter__(self) -> Self:
        self._stopping.clear()
        self._out_of_use = False
        try:
            if not self._connected:
                self._connect()
            self._place, self._down, self._low = self._open(), False, False
            self._clear = float(self._place[2])
        except BaseException:
            self._leave()
            raise
        return self

    @final
    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        try:
            self._save()
        finally:
            self._place = None
            self._leave()

    @final
    @contextmanager
    def connected(self) -> Iterator[None]:
        """Connect without moving: the machine's own `limits` are known, and it can be asked what it `accepts`.

        It may be entered within, on the same connection.
        """
        try:
            self._connect()
            self._connected = True
            yield
        finally:
            self._connected = False
            self._close()

    @final
    def accepts(self, place: Floats) -> bool:
        """Return whether the machine says that its tip gets to a place (3,), metres; it must be connected.

        Raises StoppedError after `stop`: a machine may be asked for thousands of places.
        """
        if self._stopping.is_set():
            raise StoppedError
        return self._accepts(np.asarray(place, dtype=np.float64))

    @property
    @final
    def lifted(self) -> bool:
        """Whether the pen is known to be lifted; False where the machine failed and could not be reached again.

        A tip that was jogged down may touch the paper, wherever that lies: it is lifted again from `clear` upwards.
        """
        return not (self._down or self._low)

    @property
    @final
    def drawing(self) -> bool:
        """Whether a stroke has lowered the pen, which stays where it is until `lift`."""
        return self._down

    @property
    @final
    def clear(self) -> float:
        """Height at which the pen was last known to be lifted, metres."""
        self._check_connected()
        return self._clear

    @property
    def counts_steps(self) -> bool:
        """Whether it knows its place only by counting steps from where it was switched on, or homed."""
        return False

    @property
    def home(self) -> Floats | None:
        """Place (2,) where its pen is put by hand before it is switched on, metres; None where it is not."""
        return None

    @property
    @final
    def place(self) -> Floats:
        """Place (3,) where the tip was last sent, metres."""
        return self._check_connected().copy()

    @final
    def move(self, place: Floats) -> Floats:
        """Move straight to a place (3,), metres, with the pen lifted; returns the place commanded, (3,)."""
        reached = self._moved(place, low=self._low)
        if not self._low:
            self._clear = float(reached[2])
        return reached

    @final
    def jog(self, place: Floats) -> Floats:
        """Move as `move` does, by hand and maybe onto the paper: what is lower than `clear` then is not lifted."""
        reached = self._moved(place, low=True)
        self._clear = max(self._clear, float(reached[2]))
        return reached

    @final
    def stroke(self, path: Floats, speed: Floats) -> Floats:
        """Lower the tip to the first point of the path (n, 3), metres, and follow it; the pen stays down.

        speed: (n,) metres per second at most at each point; the machine's acceleration may make it slower.
        The tip must be above the first point. A machine that cannot vary the pressure takes any height as "down".
        Returns the path commanded, (n, 3).
        """
        path, speed = np.asarray(path, dtype=np.float64), np.asarray(speed, dtype=np.float64)
        self.limits.check_path(path)
        if speed.shape != path.shape[:1]:
            speeds, points = counted(speed.size, "speed"), counted(len(path), "point")
            raise InputError(f"a stroke has {speeds} for {points}; give one per point")
        self.limits.check_speed(speed)
        if self._down:
            raise InputError("the pen is down already; lift it before the next stroke")
        beside = float(np.hypot(*(self.place - path[0])[:2]))
        if beside > _SAME_PLACE:
            raise InputError(f"the stroke starts {1e3 * beside:.3g} mm beside the pen; move there first")
        self._down = True
        return self._do(lambda: self._stroke(path, speed))

    @final
    def lift(self, height: float) -> Floats:
        """Lift the tip straight up to a height, metres; returns the place commanded, (3,).

        A tip that was put beside its limits, by hand or by a narrower easel, is lifted there: it goes nowhere else.
        """
        goal = np.array([*self.place[:2], height], dtype=np.float64)
        self.limits.check_height(height)
        self._clear = max(self._clear, height)
        place = self._do(lambda: self._lift(goal))
        self._down = self._low = False
        self._clear = float(place[2])
        return place

    @final
    def pause_pressed(self) -> bool:
        """Return whether the machine's own button for a pause was pressed since the last call; False if it has none."""
        return self._guarded(self._pressed)

    @final
    def stop(self) -> None:
        """Stop at once, and lift the pen. The call that is running raises StoppedError, and so does every later one."""
        self._stopping.set()
        self._halt()

    @abstractmethod
    def easel(self, width: float, height: float) -> Easel:
        """Return the easel of a sheet of this size, metres, in its usual place before the machine.

        Raises InputError where there is no usual place, so that it must be calibrated.
        """

    @abstractmethod
    def _connect(self) -> None:
        """Connect without moving, and take over the machine's own `limits`."""

    @abstractmethod
    def _open(self) -> Floats:
        """Lift the pen without moving it sideways, once connected; returns the place of the tip, (3,)."""

    @abstractmethod
    def _close(self) -> None:
        """Disconnect; called after every `_connect`, even if that or `_open` failed."""

    @abstractmethod
    def _move(self, place: Floats) -> Floats:
        """Move straight to a place (3,) that was checked; returns the place commanded, (3,)."""

    @abstractmethod
    def _stroke(self, path: Floats, speed: Floats) -> Floats:
        """Draw a path (n, 3) that was checked; returns the path commanded, (n, 3)."""

    @abstractmethod
    def _lift(self, place: Floats) -> Floats:
        """Lift the tip to this place (3,), straight above where it is; returns the place commanded, (3,)."""

    def _accepts(self, place: Floats) -> bool:
        """Ask the machine whether its tip gets to a place (3,) within the limits; one that does not know says yes."""
        return True

    def _pressed(self) -> bool:
        """Return whether the button for a pause was pressed since the last call; for machines that have one."""
        return False

    @abstractmethod
    def _halt(self) -> None:
        """Tell the machine to stop, from any thread and without waiting, where `_recover` would come too late."""

    @abstractmethod
    def _recover(self) -> None:
        """Stop and lift the pen as far as possible, after a stop or a fault; called from the thread of the calls.

        `place` has the height by then to which the pen was lifted before.
        """

    def _moved(self, place: Floats, low: bool) -> Floats:
        """Move straight to a place (3,), metres. low: whether the tip is not lifted there if that is below `clear`."""
        goal = np.asarray(place, dtype=np.float64)
        self.limits.check_path(goal[None])
        self._check_connected()
        if self._down:
            raise InputError("the pen is down; lift it before moving")
        self._low = low
        reached = self._do(lambda: self._move(goal))
        self._low = low and bool(reached[2] < self._clear - _SAME_PLACE)
        return reached

    def _leave(self) -> None:
        if not self._connected:
            self._close()

    def _check_connected(self) -> Floats:
        if self._place is None:
            raise InputError("the machine is not connected; use it in a with statement")
        return self._place

    def _do(self, act: Callable[[], Floats]) -> Floats:
        place = self._guarded(act)
        self._place = place.reshape(-1, 3)[-1].copy()
        return place

    def _guarded(self, act: Callable[[], Result]) -> Result:
        """Return what the act returns; after a stop or a fault, lift the pen and raise."""
        if self._out_of_use:
            raise StoppedError
        try:
            if self._stopping.is_set():
                raise StoppedError
            return act()
        except BaseException:
            self._out_of_use = True  # until it is entered again, since the place of the tip is not known
            self._down = True
            self._save()
            raise

    def _save(self) -> None:
        """Lift the pen if it is not known to be lifted."""
        if not self.lifted:
            if self._place is not None:  # a stroke that has ended, or a jog, left it at the paper
                self._place[2] = max(self._place[2], self._clear)
            with suppress(MachineError):  # the fault before it says more
                self._recover()
                self._down = self._low = False
