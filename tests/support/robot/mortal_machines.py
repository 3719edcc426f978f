"""Machines that outlive the program that drives them, each with a paper that shows where its pen really was."""

import json
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Final, Literal, final

import numpy as np

from maulstick.errors import MachineError
from maulstick.painting.brush import Brush
from maulstick.painting.raster import Canvas
from maulstick.robot.adapters.axidraw import AxiDraw
from maulstick.robot.adapters.grbl import Grbl
from maulstick.robot.easel import Easel, Pen
from maulstick.robot.robot import Robot
from maulstick.robot.simulated.easel import ARM, SimulatedEasel
from maulstick.robot.simulated.sheets import Colour, InkedSheet
from maulstick.storage.arrays import Floats, Image
from tests.support.robot.fake_ebb import POWERED, UNPOWERED, FakeEbb
from tests.support.robot.fake_grbl import FakeGrbl
from tests.support.robot.obedient_robot import EASEL, Obedient
from tests.support.robot.small_paintings import HEIGHT, WIDTH

Kill = Literal["sigkill", "ctrl_c", "cable", "power"]
KILLS: Final[tuple[Kill, ...]] = ("sigkill", "ctrl_c", "cable", "power")
PATIENCE = 1.0  # seconds that a machine may be silent: more than a busy computer takes, and short enough to wait for
_QUIET = 0.1  # seconds of the wall without a motion, after which none is left
_LONGEST = 30.0  # seconds that what is queued takes at most
_TOUCHES = 1e-6  # metres: a tip so low is on the paper
_DEEPEST = 2e-3  # metres: the tips of these machines are pressed half as deep
_PEN = Pen(up=500, down=700, seconds=0.05)
_AXIDRAW_PEN = Pen(up=20000, down=15000, seconds=0.05)


class MortalMachine(ABC):
    """A machine for one painting.  easel: where its sheet lies.

    kills: what may happen to it.  lifts: after which of these the program lives and can reach the machine.
    """

    kills: tuple[Kill, ...] = KILLS
    lifts: tuple[Kill, ...] = ("ctrl_c",)
    easel: Easel

    @abstractmethod
    def maker(self) -> Callable[[], Robot]:
        """What makes the robot in another process, now."""

    @abstractmethod
    def tracks(self) -> list[Floats]:
        """Where the pen was on the paper, (n, 2) metres on the canvas each, from one lowering to the next lift."""

    @abstractmethod
    def pen_is_down(self) -> bool:
        """Whether the pen is on the paper now."""

    @abstractmethod
    def suffer(self, kill: Kill) -> None:
        """Lose the cable or the power."""

    @abstractmethod
    def mend(self) -> None:
        """Do what a person does before going on: plug in what is unplugged, and put the machine at its home."""

    def moves(self) -> bool:
        """Whether it carries out what is queued; an arm has no queue."""
        return False

    def end(self) -> None:
        """Switch it off for good."""
        self.rest()

    @final
    def rest(self) -> None:
        """Wait until nothing moves."""
        began = still = time.monotonic()
        while time.monotonic() - still < _QUIET:
            time.sleep(0.01)
            if self.moves():
                still = time.monotonic()
            assert still - began < _LONGEST


class MortalGrbl(MortalMachine):
    """A Grbl that lifts its pen by a servo, or by height."""

    def __init__(self, pen: Pen | None, folder: Path) -> None:
        self._pen = pen
        self.easel = Easel(corner=(0, HEIGHT, 0), right=(1, 0, 0), down=(0, -1, 0), pen=pen, deepest=_DEEPEST)
        self._before: list[Floats] = []
        self._begin((0.0, 0.0, 5.0), 0.0)

    def _begin(self, start: tuple[float, float, float], servo: float) -> None:
        self._device = FakeGrbl(start=start, servo=servo).__enter__()
        self._lost: Kill | None = None

    def maker(self) -> Callable[[], Robot]:
        return partial(Grbl, self._device.port, self._pen, None, PATIENCE)

    def tracks(self) -> list[Floats]:
        return [*self._before, *self._tracks()]

    def _tracks(self) -> list[Floats]:
        reached = np.array([(*self._device.start, np.inf), *self._device.reached])  # it stood there, neither way
        return _runs(1e-3 * reached[:, :2] * (1, -1) + (0, HEIGHT), self._down(reached[:, 2], reached[:, 3]))

    def _down(self, z: Floats, servo: Floats) -> Floats:
        return 1e-3 * z <= _TOUCHES if self._pen is None else servo == self._pen.down

    def pen_is_down(self) -> bool:
        return bool(self._down(np.array(self._device.place[2]), np.array(self._device.servo)))

    def suffer(self, kill: Kill) -> None:
        self._lost = kill
        self._device.__exit__(None, None, None)

    def moves(self) -> bool:
        return self._lost is None and self._device.state == "Run"

    def mend(self) -> None:
        """Plug it in again; without power it has forgotten its place, and is put at its home."""
        old, self._before = self._device, self.tracks()
        self._begin(*((old.place, old.servo) if self._lost == "cable" else ((0.0, 0.0, 5.0), 0.0)))

    def end(self) -> None:
        self._device.__exit__(None, None, None)


class MortalEbb(MortalMachine):
    """An EiBotBoard; it lives on USB, so that power is that of its motors."""

    lifts = ("ctrl_c", "power")

    def __init__(self, folder: Path) -> None:
        self.easel = Easel(corner=(0, 0, 0), right=(1, 0, 0), down=(0, -1, 0), pen=_AXIDRAW_PEN)
        self._device = FakeEbb().__enter__()

    def maker(self) -> Callable[[], Robot]:
        return partial(AxiDraw, self._device.port, _AXIDRAW_PEN, None, PATIENCE)

    def tracks(self) -> list[Floats]:
        first, second, down = np.array(self._device.reached).reshape(-1, 3).T
        return _runs(np.stack([first + second, first - second], axis=1) / 2 / 80e3, down == 1)

    def pen_is_down(self) -> bool:
        return self._device.down

    def suffer(self, kill: Kill) -> None:
        if kill == "cable":
            self._device.unplug()
        else:
            self._device.supply = UNPOWERED

    def moves(self) -> bool:
        return self._device.moves

    def mend(self) -> None:
        if self._device.supply == UNPOWERED:
            self._device.supply, self._device.made = POWERED, (0, 0)
        else:
            self._device.plug_in()

    def end(self) -> None:
        self._device.__exit__(None, None, None)


class MortalArm(MortalMachine):
    """A simulated arm, which lives in the process that drives it and leaves its places in a file."""

    kills = KILLS[:3]
    easel = EASEL.model_copy(update={"deepest": _DEEPEST})

    def __init__(self, folder: Path) -> None:
        self._world = folder / "arm.txt"
        self._world.touch()

    def maker(self) -> Callable[[], Robot]:
        return partial(_Arm, self._world, self._cable())

    def tracks(self) -> list[Floats]:
        places = self._places()
        return _runs(places[:, :2], places[:, 2] <= _TOUCHES)

    def pen_is_down(self) -> bool:
        places = self._places()
        return len(places) > 0 and bool(places[-1, 2] <= _TOUCHES)

    def suffer(self, kill: Kill) -> None:
        self._cable().touch()

    def mend(self) -> None:
        self._cable().unlink()

    def _places(self) -> Floats:
        return self.easel.machine_to_canvas(_places_in(self._world)) if self._world.stat().st_size else np.empty((0, 3))

    def _cable(self) -> Path:
        return self._world.with_suffix(".cut")


class MortalEasel(MortalMachine):
    """The simulated easel, whose sheet leaves its strokes in a file."""

    kills = KILLS[:2]

    def __init__(self, folder: Path) -> None:
        self._world = folder / "sheet.jsonl"
        self._world.touch()
        self.easel = SimulatedEasel(_Sheet(self._world)).easel(WIDTH, HEIGHT)

    def maker(self) -> Callable[[], Robot]:
        return partial(_simulated, self._world)

    def tracks(self) -> list[Floats]:
        return [np.array(json.loads(line)) for line in self._world.read_text().splitlines()]

    def pen_is_down(self) -> bool:
        return False  # its tip is in the memory of its process, which says whether it is lifted

    def suffer(self, kill: Kill) -> None:
        raise NotImplementedError("it has neither a cable nor a power of its own")

    def mend(self) -> None:
        raise NotImplementedError("nothing of it can break")


MACHINES: Final[dict[str, tuple[type[MortalMachine], Callable[[Path], MortalMachine]]]] = {
    "grbl_servo": (MortalGrbl, partial(MortalGrbl, _PEN)),
    "grbl_z": (MortalGrbl, partial(MortalGrbl, None)),
    "ebb": (MortalEbb, MortalEbb),
    "arm": (MortalArm, MortalArm),
    "sim": (MortalEasel, MortalEasel),
}
"""Kinds of machines by their names, and what makes one over a folder."""


class _Arm(Obedient):
    """An arm that is found where the world says that it is, and whose cable may be cut."""

    def __init__(self, world: Path, cable: Path) -> None:
        self._world, self._cut = world, cable
        super().__init__()
        if world.stat().st_size:
            self._at = _places_in(world)[-1]

    @property
    def at(self) -> Floats:
        return self._at

    @at.setter
    def at(self, place: Floats) -> None:
        if self._cut.exists():
            raise MachineError("the line to the arm went silent")
        self._at = place
        with self._world.open("a") as file:
            file.write("{} {} {}\n".format(*place))

    def _open(self) -> Floats:
        self.at = np.array([*self._at[:2], 0.1])
        return self.at


class _Sheet(InkedSheet):
    """A sheet whose strokes are in a file."""

    def __init__(self, world: Path) -> None:
        self.canvas, self.depth, self.deepest = Canvas(WIDTH, HEIGHT, 1000), 0.004, 0.004
        self._world = world

    def take(self, brush: Brush) -> None:
        pass

    def lay(self, picture: Image) -> None:
        pass

    def draw(self, trajectory: Floats, colour: Colour) -> None:
        with self._world.open("a") as file:
            file.write(json.dumps(trajectory[:, :2].tolist()) + "\n")

    def image(self) -> Image:
        return np.ones((40, 60, 3), dtype=np.float32)


def _simulated(world: Path) -> Robot:
    return SimulatedEasel(_Sheet(world), pace=5.0, limits=ARM)


def _places_in(world: Path) -> Floats:
    lines = [line.split() for line in world.read_text().splitlines() if line.count(" ") == 2]
    return np.array(lines, dtype=np.float64).reshape(-1, 3)


def _runs(places: Floats, down: Floats | Sequence[bool]) -> list[Floats]:
    """The places (n, 2) in parts in which the pen is down, each from where it was lowered."""
    at = np.flatnonzero(down)
    parts = np.split(at, np.flatnonzero(np.diff(at) > 1) + 1)
    return [places[max(part[0] - 1, 0) : part[-1] + 1] for part in parts if len(part)]
