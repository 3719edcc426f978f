"""The person beside a machine that paints, at a terminal or before a page."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import final

from maulstick.jobs.paint.estimate import Estimate
from maulstick.robot.execute import PaintProgress, Pause
from maulstick.robot.robot import Robot
from maulstick.robot.routine import Prompt


class Operator(ABC):
    """What they are told and asked, and how they stop and hold the machine.

    pause: holds it between two strokes.  stopped: whether they stopped it.
    resting: whether it rests while something else is done, which `interrupt` then interrupts.
    """

    def __init__(self, robot: Robot) -> None:
        self.pause = Pause()
        self.stopped = False
        self.robot = robot
        self.resting = False

    @abstractmethod
    def expect(self, estimate: Estimate) -> None:
        """Tell them what will be painted."""

    @abstractmethod
    def on_duty(self) -> AbstractContextManager[None]:
        """While it lasts the machine may move, and they can stop it."""

    @abstractmethod
    def watch(self, progress: PaintProgress) -> None:
        """Show them where painting is."""

    @abstractmethod
    def ask(self, action: Prompt) -> None:
        """Say what is to be done, and return once it is, or once they have stopped the machine."""

    @abstractmethod
    def note(self, sentence: str) -> None:
        """Tell them what is odd and does not stop the machine."""

    @abstractmethod
    def show(self, photograph: Path) -> None:
        """Show them what the camera saw."""

    @abstractmethod
    def expect_strokes(self, number: int) -> None:
        """Tell them of how many strokes the painting is, now that the rest was planned again."""

    @abstractmethod
    def leave(self, photograph: Path) -> None:
        """Tell them, at the end, where a picture of the sheet now is."""

    @abstractmethod
    def wants_a_look(self) -> bool:
        """Whether they want the camera to look now; asked after each stroke, and once they do, they have been heard."""

    @final
    @contextmanager
    def interruptible(self) -> Iterator[None]:
        """While it lasts a stop interrupts what is done; raises KeyboardInterrupt where it was stopped before."""
        self.resting = True
        try:
            if self.stopped:
                raise KeyboardInterrupt
            yield
        finally:
            self.resting = False

    @final
    def stop(self) -> None:
        """Stop the machine; from any thread or signal handler. It is told once: twice would halt the lifting, too."""
        if self.stopped:
            return
        self.stopped = True
        self.robot.stop()
        if self.pause.held:
            self.pause.toggle()

    @final
    def interrupt(self, *_: object) -> None:
        """Stop the machine; a signal handler."""
        self.stop()
        if self.resting:
            raise KeyboardInterrupt
