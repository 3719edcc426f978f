"""Operator in a terminal: progress bar, keys and questions."""

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from math import ceil
from pathlib import Path
from typing import final

from rich.console import Console
from rich.progress import BarColumn, TextColumn
from rich.progress import Progress as Bars
from typer import Exit

from maulstick.cli.exit_codes import STOPPED
from maulstick.cli.wording import COMMAND_LINE, stopped
from maulstick.errors import InputError, MaulstickError
from maulstick.jobs.paint.estimate import Estimate
from maulstick.jobs.paint.operator import Operator
from maulstick.jobs.paint.turns import in_minutes
from maulstick.painting.painting import Painting
from maulstick.robot.execute import PaintProgress
from maulstick.robot.robot import Robot, StoppedError
from maulstick.robot.routine import Draw, Prompt, TrayVisit
from maulstick.storage.text import counted

_PACES = {"+": 1, "-": -1}  # steps of the pace by key
_LOOK = 0.05  # seconds between two looks at the keyboard: no delay that a person notices


@final
class TerminalOperator(Operator):
    """Operator who sees a progress bar and presses keys: Ctrl-C or s stops, space pauses, + and - change the pace.

    painted: number of strokes that are painted already.  what_next: sentence that is shown if painting ends early.
    """

    def __init__(self, console: Console, painting: Painting, robot: Robot, painted: int, what_next: str) -> None:
        super().__init__(robot)
        self._console, self._paints, self._what_next = console, painting.paints, what_next
        self._strokes = painted
        self._drawn = 0.0  # metres, before the last photograph
        self._asking = False
        self._keyboard = threading.Lock()
        columns = (
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.fields[drawn]} of {task.fields[metres]} mm"),
            TextColumn("{task.fields[left]} left"),
            TextColumn("{task.fields[pace]}"),
            TextColumn("{task.fields[paint]}"),
        )
        self._bars = Bars(*columns, console=console)
        self._task = self._bars.add_task("ready", total=1.0, drawn="0", metres="…", left="…", pace="", paint="")

    def expect(self, estimate: Estimate) -> None:
        """As in `Operator`."""
        self.say(in_words(estimate))

    @contextmanager
    def on_duty(self) -> Iterator[None]:
        """As in `Operator`: shows a progress bar, and passes keys and signals to the machine.

        If painting ends early, prints what is next; if the operator stopped it, the command ends.
        """
        over = threading.Event()
        keys = threading.Thread(target=self._listen, args=(over,), daemon=True)
        with self.stopped_by_signals():
            keys.start()
            try:
                with self._bars:
                    yield
            except (MaulstickError, KeyboardInterrupt) as error:
                self.say(f"{stopped(self.robot)}; {self._what_next}")
                if isinstance(error, StoppedError | KeyboardInterrupt) and self.stopped:
                    raise Exit(STOPPED) from None
                raise
            finally:
                over.set()
                keys.join()

    def watch(self, progress: PaintProgress) -> None:
        """As in `Operator`."""
        match progress.action:
            case Draw():
                self._strokes += 1
                doing = f"stroke {self._strokes}"
            case TrayVisit(what=what):
                doing = what
            case Prompt():
                doing = "waiting"
            case None:
                doing = "painted"
        drawn, metres = self._drawn + progress.drawn, self._drawn + progress.metres
        if progress.action is None:
            self._drawn = drawn
        following = "" if progress.next_paint is None else f"next: {self._paints[progress.next_paint].label}"
        self._bars.update(
            self._task,
            description=doing,
            completed=drawn / (metres or 1.0),
            drawn=f"{1e3 * drawn:.0f}",
            metres=f"{1e3 * metres:.0f}",
            left=_clock(progress.left),
            pace="" if self.pace.percent == 100 else self._shown_pace(),
            paint=following,
        )

    def _shown_pace(self) -> str:
        return f"at {self.pace.percent} %"

    def ask(self, action: Prompt) -> None:
        """Print what is to be done, and wait for Enter; s stops."""
        self._bars.stop()
        self._asking = True
        try:
            with self.interruptible(), self._keyboard:
                draws = "" if action.seconds is None else f" (it draws for {in_minutes(action.seconds)})"
                self.say(f"{action.told(COMMAND_LINE)}, and press Enter{draws}; s and Enter stop")
                answer = sys.stdin.readline()
            if not answer:
                raise InputError(f"nobody is there to {action.message}; run it in a terminal")
            if answer.strip().lower() == "s":
                self.stop()
        finally:
            self._asking = False
            self._bars.start()

    def say(self, sentence: str) -> None:
        """Print a sentence for the operator."""
        self._console.print(sentence, soft_wrap=True)

    def note(self, sentence: str) -> None:
        """As in `Operator`."""
        self.say(f"note: {sentence}")

    def show(self, photograph: Path) -> None:
        """Do nothing: a terminal shows no pictures."""

    def expect_plan(self, painting: Painting) -> None:
        """Do nothing: the progress bar shows lengths."""

    def leave(self, photograph: Path) -> None:
        """As in `Operator`."""
        print(photograph, flush=True)

    def wants_a_look(self) -> bool:
        """Return False: the camera looks after every so many strokes."""
        return False

    def _listen(self, over: threading.Event) -> None:
        if not sys.stdin.isatty():
            return
        from prompt_toolkit.input import create_input

        keyboard = create_input(sys.stdin)
        while not over.is_set():
            if self._asking:
                over.wait(_LOOK)
                continue
            with self._keyboard, keyboard.raw_mode():
                while not (over.wait(_LOOK) or self._asking):
                    self._press([key.key for key in keyboard.read_keys()])

    def _press(self, keys: list[str]) -> None:
        for key in keys:
            if key in ("c-c", "s"):
                signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
            elif key == " ":
                self.pause.toggle()
                self.say("paused after this stroke; space goes on" if self.pause.held else "going on")
            elif key in _PACES:
                self.pace.change(_PACES[key])
                self._bars.update(self._task, pace=self._shown_pace())


def in_words(estimate: Estimate) -> str:
    """Return an estimate as a sentence."""
    if not estimate.strokes:
        return "all strokes are painted"
    what = f"{counted(estimate.strokes, 'stroke')}, {1e3 * estimate.metres:.0f} mm"
    painted = f"; {estimate.painted} are painted" if estimate.painted else ""
    more = f"; then {counted(estimate.more_sheets, 'more sheet')}" if estimate.more_sheets else ""
    return f"{what}, {counted(estimate.paints, 'paint')}, about {ceil(estimate.seconds / 60)} min{painted}{more}"


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"


def confirm(console: Console, question: str, otherwise: str) -> bool:
    """Ask a question until the answer is yes or no; returns whether it is yes.

    Raises InputError where nobody answers, which says what to do `otherwise`.
    """
    while True:
        console.print(f"{question} [y/n]", soft_wrap=True)
        answer = sys.stdin.readline()
        if not answer:
            raise InputError(f"{question} Nobody answers; {otherwise}")
        if answer.strip().lower() in ("y", "yes", "n", "no"):
            return answer.strip().lower().startswith("y")
