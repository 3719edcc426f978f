"""Run of a machine, which all pages show alike."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, final

from nicegui import Event

from maulstick.errors import InputError
from maulstick.jobs.paint.estimate import Estimate
from maulstick.jobs.paint.options import PaintOptions
from maulstick.jobs.paint.request import PaintRequest
from maulstick.jobs.paint.status import PaintStatus, status_of
from maulstick.robot.journal import journal_of
from maulstick.studio.state.easels import Easels
from maulstick.studio.state.folder import PAINTED, Folder
from maulstick.studio.state.mixing import Mixing
from maulstick.studio.state.plans import Plans
from maulstick.studio.wording import LOOK_AT_IT
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.messages import (
    PLANNING,
    Command,
    Done,
    Ended,
    Held,
    Note,
    OperatorRequest,
    Photograph,
    RunProgress,
)
from maulstick.studio.workers.painter import paint_in_process, rehearse_in_process
from maulstick.studio.workers.planned_paints import PlannedPaint
from maulstick.studio.workers.process import CLOSING, LONGEST_STOP, Failed, Process

_MOST_NOTES = 50  # shown on the page; older ones are dropped
_PEN = {True: "The pen is lifted.", False: "The pen may still be down: lift it by hand."}

Phase = Literal["idle", "checking", "starting", "painting", "stopping", "ended"]


@dataclass(frozen=True)
class State:
    """State of the run that is on, or of the last one.

    plan: name of the plan or the drawing.  options: of the machine.  estimate: of the whole run.
    progress: newest of the run.
    photograph: the sheet as it was last seen, a JPEG.  seen: its number in this studio.
    question: what a person has to do before the run goes on, or "".  question_number: its number in this run.
    held: whether the run waits after this stroke.  silent: whether it was stopped and does not answer.
    will_look: whether the camera was asked to look after this stroke.
    sentence: outcome of a check or a run.  fault: whether it is a fault.
    """

    phase: Phase = "idle"
    plan: str = ""
    options: PaintOptions = field(default_factory=PaintOptions)
    estimate: Estimate | None = None
    progress: RunProgress | None = None
    photograph: bytes = b""
    seen: int = 0
    question: str = ""
    question_number: int = 0
    held: bool = False
    silent: bool = False
    will_look: bool = False
    notes: tuple[str, ...] = ()
    sentence: str = ""
    fault: bool = False

    @property
    def is_on(self) -> bool:
        """Whether a machine paints, or is about to."""
        return self.phase in ("starting", "painting", "stopping")


@final
class Run:
    """Runs of a machine, one at a time. changed: event at each new state."""

    def __init__(self, folder: Folder, desk: Desk, mixing: Mixing, plans: Plans) -> None:
        self.changed = Event[[]]()
        self.state = State()
        self.easels = Easels(folder)
        self._folder, self._desk, self._mixing, self._plans = folder, desk, mixing, plans
        self._process: Process | None = None
        self._stops = 0

    @property
    def is_busy(self) -> bool:
        """Whether a process drives or checks a machine."""
        return self._process is not None

    @property
    def doing(self) -> str:
        """Description of the run in a few words; "" where no machine paints."""
        state = self.state
        if not state.is_on:
            return ""
        if state.question:
            return f"painting {self.title}: waits for you"
        if state.phase != "painting" or state.progress is None:
            return f"{state.phase} {self.title}"
        of = "" if state.progress.strokes is None else f" of {state.progress.strokes}"
        return f"{'paused' if state.held else 'painting'} {self.title}: stroke {state.progress.stroke}{of}"

    @property
    def title(self) -> str:
        """Title of the plan or the drawing that is painted, or was last."""
        return self._folder.title("plans", self.state.plan)

    def plans(self) -> dict[str, str]:
        """Return the titles of the plans and drawings that can be painted, by name, newest first."""
        titles = reversed(self._folder.titles(*PAINTED).items())
        return {name: title for name, title in titles if self._folder.painting(name).is_file()}

    async def status(self, plan: str) -> PaintStatus | None:
        """Return how far a plan is painted, or None where it was not begun. Raises InputError as `status_of`."""
        painting = self._painting(plan)
        return await self._desk.do(status_of, painting) if journal_of(painting).exists() else None

    def check(self, plan: str, options: PaintOptions, *, resume: bool = False, restart: bool = False) -> None:
        """Check whether a plan, or with `resume` its rest, can be painted, without moving anything.

        restart: on a new sheet, where it was begun before.
        """
        request = self._request(plan, options, resume=resume, restart=restart)
        options.check()
        self._check_free()
        self._begin("checking", request, rehearse_in_process)

    async def begin(self, plan: str, options: PaintOptions, *, restart: bool = False) -> None:
        """Paint a plan from its first stroke. restart: on a new sheet, where it was begun before.

        Raises InputError where a machine is busy, the plan is planned again, or paints for a real one are not mixed.
        """
        await self._start(self._request(plan, options, restart=restart), None)

    async def resume(self, plan: str, options: PaintOptions, is_painted: bool | None) -> None:
        """Go on where it stopped, with its earlier options where `options` leave them out; raises as `begin`.

        is_painted: whether the unfinished stroke is on the paper.
        """
        await self._start(self._request(plan, options, resume=True), is_painted)

    def stop(self) -> str:
        """Stop the machine at once and lift its pen, whatever it does; return what was stopped, for people."""
        self._stops += 1
        if self._process is None:
            return "Nothing moves: there was nothing to stop."
        if self.state.phase == "checking":  # nothing moves
            self._process.kill()
            self._end("The check was stopped.", fault=False)
            return "The check was stopped; nothing had moved."
        self._process.tell(Command.STOP)
        if self.state.phase != "stopping":
            asyncio.get_running_loop().call_later(LONGEST_STOP, self._note_silence, self._process)
        self._change(phase="stopping")
        return "The machine stops and lifts its pen."

    def give_up(self) -> None:
        """Kill the process of a run that was stopped and does not answer."""
        if self._process is not None and self.state.silent:
            self._process.kill()
            self._end(f"It was ended without an answer. {LOOK_AT_IT}", fault=True)

    def pause(self) -> None:
        """Let the machine wait after this stroke."""
        self._command(Command.PAUSE, held=True)

    def go_on(self) -> None:
        """Go on after a pause."""
        self._command(Command.GO_ON, held=False)

    def replan_now(self) -> None:
        """Look at the sheet after this stroke, and plan the rest again."""
        self._command(Command.LOOK, will_look=True)

    def done(self, question: int) -> None:
        """Note that the request of that number is done; ignored where another one is asked by now."""
        if self.state.question and question == self.state.question_number:
            self._command(Done(question), question="")

    async def close(self) -> None:
        """Stop the machine, and wait until its pen is lifted."""
        process = self._process
        self.stop()
        if process is not None:
            await asyncio.to_thread(process.join, CLOSING)

    def _painting(self, plan: str) -> Path:
        path = self._folder.painting(plan)
        if not path.is_file():
            raise InputError(f"{self._folder.title('plans', plan)} is not finished; let it be planned to its end first")
        return path

    def _request(
        self, plan: str, options: PaintOptions, *, resume: bool = False, restart: bool = False
    ) -> PaintRequest:
        """Return the request, whose journal lets the studio's folder be moved."""
        painting, home = self._painting(plan), self._folder.root
        return PaintRequest(painting, options, resume=resume, restart=restart, home=home, asks_for_one_pen=True)

    def _check_free(self) -> None:
        if self.is_busy:
            raise InputError(f"a machine is busy with {self.title}; wait until it has finished, or stop it")

    def _check_planned(self, plan: str) -> None:
        """Raise InputError for a plan that is planned again, which replaces its file."""
        if plan in self._plans.plans and self._plans.of(plan).is_busy:
            title = self._folder.title("plans", plan)
            raise InputError(f"{title} is being planned; wait until it has finished, or stop it first")

    async def _start(self, request: PaintRequest, is_painted: bool | None) -> None:
        plan = request.painting.parent.name
        request.options.check()
        self._check_free()
        self._check_planned(plan)
        stops = self._stops
        if not request.options.simulated and (missing := await self._mixing.missing(plan)):
            raise InputError(_unmixed_fault(self._folder.title("plans", plan), missing))
        if stops != self._stops:
            raise InputError(f"{self._folder.title('plans', plan)} was stopped before it began; start it once more")
        self._check_free()  # another page may have been quicker
        self._check_planned(plan)
        self._begin("starting", request, paint_in_process, is_painted)

    def _begin(self, phase: Phase, request: PaintRequest, work: Callable[..., None], *more: object) -> None:
        def ended() -> None:
            self._end(f"It ended without a word. {LOOK_AT_IT}", fault=True)

        self._process = Process(work, request, *more, hear=self._hear, ended=ended)
        self.state = State(phase, request.painting.parent.name, request.options, seen=self.state.seen + 1)
        self.changed.emit()

    def _note_silence(self, process: Process) -> None:
        if process is self._process:
            self._change(silent=True)

    def _hear(self, received: object) -> None:
        state = self.state
        match received:
            case Estimate() if state.phase == "checking":
                self._change(estimate=received)
                self._end("It fits." if received.strokes else "All strokes are painted.", fault=False)
            case Estimate():
                self._change(estimate=received, phase="painting" if state.phase == "starting" else state.phase)
            case RunProgress():
                self._change(progress=received, will_look=state.will_look and received.doing != PLANNING)
            case OperatorRequest(number=number, message=message):
                self._change(question=message or "", question_number=number)
            case Photograph(jpeg=jpeg):
                self._change(photograph=jpeg, seen=state.seen + 1)
            case Held(held=held):
                self._change(held=held)
            case Note(sentence=sentence):
                self._change(notes=(*state.notes, sentence)[-_MOST_NOTES:])
            case Ended(why=None):
                self._end(f"{self.title} is painted.", fault=False)
            case Ended(why="", lifted=lifted):
                self._end(f"You stopped it. {_PEN[lifted]}", fault=not lifted)
            case Ended(why=why) if state.phase == "starting":
                self._end(str(why), fault=True)
            case Ended(why=why, lifted=lifted):
                self._end(f"It stopped: {why}. {_PEN[lifted]}", fault=True)
            case Failed(why=why):
                self._end(f"{why}. {LOOK_AT_IT}" if state.phase in ("painting", "stopping") else why, fault=True)

    def _end(self, sentence: str, *, fault: bool) -> None:
        if self._process is not None:
            self._process.forget()
            self._process = None
        self._change(
            phase="ended", sentence=sentence, fault=fault, question="", held=False, silent=False, will_look=False
        )

    def _command(self, command: Command | Done, **changes: Any) -> None:
        if self._process is not None and self.state.phase == "painting":
            self._process.tell(command)
            self._change(**changes)

    def _change(self, **changes: Any) -> None:
        self.state = replace(self.state, **changes)
        self.changed.emit()


def _unmixed_fault(title: str, missing: list[PlannedPaint]) -> str:
    more = "" if len(missing) == 1 else f" and {len(missing) - 1} more"
    return f"{missing[0].display_name}{more} of {title} must be mixed first; tick what is mixed under Mix"
