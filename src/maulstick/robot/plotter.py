"""What some plotters can do: find home, let their motors go, keep an origin, set the pen's servo, change speed."""

from abc import abstractmethod
from typing import Literal

from maulstick.errors import MachineError
from maulstick.robot.easel import Pen
from maulstick.robot.robot import Robot


class LockedError(MachineError):
    """A machine has locked itself, as its place may be lost."""


class LocksItself(Robot):
    """Machine that locks itself where its place may be lost: entering it raises LockedError.

    Both ways out are for a machine that is not entered.
    """

    @abstractmethod
    def find_home(self) -> None:
        """Move to the switches by which the machine finds its home, which unlocks it.

        Raises InputError where it has none, MachineError where it does not find them, and StoppedError after `stop`.
        """

    @abstractmethod
    def unlock(self) -> None:
        """Unlock the machine, which takes its place to be where it says."""


class LetsGo(Robot):
    """Machine whose motors can be switched off, so that its pen is moved by hand."""

    @abstractmethod
    def let_go(self) -> None:
        """Lift the pen and switch the motors off; the place is lost, so the machine has to be entered again.

        Where it is then counts as its home. Raises InputError where the machine has no way to do so.
        """


class KeepsOrigin(Robot):
    """Machine that keeps the place of its own frame's origin, even where it is switched off."""

    @abstractmethod
    def set_origin(self, what: Literal["corner", "paper"]) -> None:
        """Make the place of the tip the origin: x and y of the sheet's corner, or z of the paper.

        The workspace stays where it is: its limits are counted from the new origin from now on.
        """


class HasServo(Robot):
    """Machine that may lift its pen with a servo."""

    @property
    @abstractmethod
    def pen(self) -> Pen | None:
        """Positions of the servo; None where the pen is lifted by its height."""

    @property
    @abstractmethod
    def servo_range(self) -> tuple[float, float]:
        """Least and highest position of the servo."""

    @abstractmethod
    def set_pen(self, pen: Pen) -> None:
        """Change the positions of the servo, and move it to the one for lifted or lowered, whichever the pen is.

        Raises InputError where a position is outside the servo's range.
        """


def only_lifts_pen(robot: Robot) -> bool:
    """Return whether a machine only lifts its pen, as far as that is known before it is connected."""
    return not robot.limits.varies_pressure or (isinstance(robot, HasServo) and robot.pen is not None)


class OverridesSpeed(Robot):
    """Machine that can change the speed of all motions at once, also of the one that it makes."""

    @property
    @abstractmethod
    def highest_override(self) -> int:
        """Highest per cent of the commanded speeds within its limits."""

    @abstractmethod
    def override(self, percent: int) -> None:
        """Make all motions so many per cent as fast as commanded, soon, until it is left; from any thread."""
