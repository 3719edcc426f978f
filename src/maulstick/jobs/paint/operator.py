"""Operator: the interface to the person at a machine that paints, by a terminal or a page."""

import signal
from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import final

from maulstick.jobs.paint.estimate import Estimate
from maulstick.painting.painting import Painting
from maulstick.robot.execute import PaintProgress, Pause
from maulstick.robot.pace import Pace
from maulstick.robot.robot import Robot
from maulstick.robot.routine import Prompt


class Operator(ABC):
    """Interface to the operator: messages and questions to them, and their ways to stop and pause the machine.

    pause: pauses the machine between two strokes.  pace: how fast it draws.  stopped: whether the operator stopped it.
    resting: whether the machine rests while something else is done, which `interrupt` then interrupts.
    """

    def __init__(self, robot: Robot) -> None:
        self.pause = Pause(self.tell_of_button)
        self.pace = Pace(robot)
        self.stopped = False
        self.robot = robot
        self.resting = False

    @abstractmethod
    def expect(self, estimate: Estimate) -> None:
        """Show the estimate of what will be painted."""

    @abstractmethod
    def on_duty(self) -> AbstractContextManager[None]:
        """Return a context in which the machine may move and the operator can stop it."""

    @abstractmethod
    def watch(self, progress: PaintProgress) -> None:
        """Show the progress of painting."""

    @abstractmethod
    def ask(self, action: Prompt) -> None:
        """Ask the operator to do something; return once it is done, or once they have stopped the machine."""

    @abstractmethod
    def note(self, sentence: str) -> None:
        """Show a warning that does not stop the machine."""

    @abstractmethod
    def show(self, photograph: Path) -> None:
        """Show a photograph of the sheet from the camera."""

    @abstractmethod
    def expect_plan(self, painting: Painting) -> None:
        """Show the painting, after the rest of it was planned again."""

    @abstractmethod
    def leave(self, photograph: Path) -> None:
        """Show, at the end, the path of a picture of the sheet."""

    @abstractmethod
    def wants_a_look(self) -> bool:
        """Return whether the operator asks for a photograph now, once per request; called after each stroke."""

    def tell_of_button(self, held: bool) -> None:
        """Show that the machine's own button was pressed, and whether the machine waits since then."""
        self.note("paused by the machine's button; press it again to go on" if held else "going on")

    @final
    @contextmanager
    def interruptible(self) -> Iterator[None]:
        """Let a stop interrupt the body of the context; raises KeyboardInterrupt where it was stopped before."""
        self.resting = True
        try:
            if self.stopped:
                raise KeyboardInterrupt
            yield
        finally:
            self.resting = False

    @final
    @contextmanager
    def stopped_by_signals(self) -> Iterator[None]:
        """Let Ctrl-C, a kill and a closed terminal stop the machine; only the main thread can hear them."""
        stopping = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]
        if signal.getsignal(signal.SIGHUP) == signal.SIG_IGN:  # nohup: it is to go on where its terminal is closed
            stopping.remove(signal.SIGHUP)
        before = {number: signal.signal(number, self.interrupt) for number in stopping}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    @final
    def stop(self) -> None:
        """Stop the machine, from any thread or signal handler; once, since a second stop would halt the lifting."""
        if self.stopped:
            return
        self.stopped = True
        self.robot.stop()
        if self.pause.held:
            self.pause.toggle()

    @final
    def interrupt(self, *_: object) -> None:
        """Stop the machine, and interrupt what is done while it rests; a signal handler."""
        self.stop()
        if self.resting:
            raise KeyboardInterrupt
