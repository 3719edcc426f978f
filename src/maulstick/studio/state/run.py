"""The machine, if it paints, which all pages show alike."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, final

from nicegui import Event

from maulstick.errors import InputError
from maulstick.jobs.paint.estimate import Estimate
from maulstick.jobs.paint.options import PaintOptions
from maulstick.jobs.paint.session import PaintRequest
from maulstick.jobs.paint.status import PaintStatus, status_of
from maulstick.robot.journal import journal_of
from maulstick.studio.state.easels import Easels
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.mixing import Mixing
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.messages import PLANNING, Asking, Command, Done, Ended, Going, Note, Photograph
from maulstick.studio.workers.painter import paint_in_process, rehearse_in_process
from maulstick.studio.workers.planned_paints import PlannedPaint
from maulstick.studio.workers.process import Failed, Process

_FAREWELL = 8.0  # seconds for the pen to be lifted when the studio closes
_LONGEST_STOP = 10.0  # seconds until people are told that the machine does not answer
_MOST_NOTES = 50
_PEN = {True: "The pen is lifted.", False: "The pen may still be down: lift it by hand."}
_LOOK_AT_IT = "Look at the machine: its pen may still be down."

Phase = Literal["idle", "checking", "starting", "painting", "stopping", "ended"]


@dataclass(frozen=True)
class State:
    """What is known of the run that is on, or of the last one.

    plan: what it is or was of.  options: of the machine.  estimate: what it will come to.  going: where it is.
    photograph: the sheet as it was last seen, a JPEG, the `seen`-th one of this studio.
    question: what a person has to do before it goes on, the `asked_for`-th thing in this run.
    held: whether it waits after this stroke.  silent: whether it was stopped and does not answer.
    will_look: whether the camera was asked to look after this stroke.
    sentence: how a check or a run came out, and whether that is a `fault`.
    """

    phase: Phase = "idle"
    plan: str = ""
    options: PaintOptions = field(default_factory=PaintOptions)
    estimate: Estimate | None = None
    going: Going | None = None
    photograph: bytes = b""
    seen: int = 0
    question: str = ""
    asked_for: int = 0
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
    """One run at a time. changed: whenever its state is another one."""

    def __init__(self, folder: Folder, desk: Desk, mixing: Mixing) -> None:
        self.changed = Event[[]]()
        self.state = State()
        self.easels = Easels(folder)
        self._folder, self._desk, self._mixing = folder, desk, mixing
        self._process: Process | None = None

    @property
    def is_busy(self) -> bool:
        """Whether a machine is asked for anything, be it its limits."""
        return self._process is not None

    @property
    def doing(self) -> str:
        """In a few words; none where no machine paints."""
        state = self.state
        if not state.is_on:
            return ""
        if state.question:
            return f"painting {state.plan}: waits for you"
        if state.phase != "painting" or state.going is None:
            return f"{state.phase} {state.plan}"
        of = "" if state.going.strokes is None else f" of {state.going.strokes}"
        return f"{'paused' if state.held else 'painting'} {state.plan}: stroke {state.going.stroke}{of}"

    def plans(self) -> list[str]:
        """Those that can be painted, newest first."""
        return self._mixing.plans()

    async def status(self, plan: str) -> PaintStatus | None:
        """How far a plan is painted, as its journal says; None where it was not begun. Raises InputError as that."""
        painting = self._painting(plan)
        return await self._desk.do(status_of, painting) if journal_of(painting).exists() else None

    def check(self, plan: str, options: PaintOptions, *, resume: bool = False) -> None:
        """Find out whether it, or the rest of it, can be painted, without moving anything."""
        request = PaintRequest(self._painting(plan), options, resume=resume)
        options.check()
        self._see_that_it_is_free()
        self._begin("checking", request, rehearse_in_process)

    async def begin(self, plan: str, options: PaintOptions, *, restart: bool = False) -> None:
        """Paint a plan from its first stroke. anew: though it was begun before, on a new sheet.

        Raises InputError where a machine is busy, or paints are not mixed.
        """
        await self._start(PaintRequest(self._painting(plan), options, restart=restart), None)

    async def resume(self, plan: str, options: PaintOptions, is_painted: bool | None) -> None:
        """Go on where it stopped, with what was asked then and is not asked now; raises as `begin`.

        is_painted: whether the unfinished stroke is on the paper.
        """
        await self._start(PaintRequest(self._painting(plan), options, resume=True), is_painted)

    def stop(self) -> None:
        """Stop the machine at once, and lift the pen; at any time."""
        if self._process is None:
            return
        if self.state.phase == "checking":  # nothing moves
            self._process.kill()
            self._end("The check was stopped.", fault=False)
            return
        self._process.tell(Command.STOP)
        if self.state.phase != "stopping":
            asyncio.get_running_loop().call_later(_LONGEST_STOP, self._wonder_about, self._process)
        self._now(phase="stopping")

    def give_up(self) -> None:
        """End what was stopped and does not answer, whatever its machine does."""
        if self._process is not None and self.state.silent:
            self._process.kill()
            self._end(f"It was ended without an answer. {_LOOK_AT_IT}", fault=True)

    def pause(self) -> None:
        """Wait after this stroke."""
        self._wish(Command.PAUSE, held=True)

    def go_on(self) -> None:
        """After a pause."""
        self._wish(Command.GO_ON, held=False)

    def replan_now(self) -> None:
        """Look at the sheet after this stroke, and plan what is left again."""
        self._wish(Command.LOOK, will_look=True)

    def done(self, question: int) -> None:
        """What a person was asked for in that question is done; nothing where another one is asked by now."""
        if self.state.question and question == self.state.asked_for:
            self._wish(Done(question), question="")

    async def close(self) -> None:
        """Stop the machine, and wait until its pen is lifted."""
        process = self._process
        self.stop()
        if process is not None:
            await asyncio.to_thread(process.join, _FAREWELL)

    def _painting(self, plan: str) -> Path:
        path = self._folder.of("plans", plan) / "painting.json"
        if not path.is_file():
            raise InputError(f"the plan {plan!r} is not finished; let it be planned to its end first")
        return path

    def _see_that_it_is_free(self) -> None:
        if self.is_busy:
            raise InputError(f"a machine is busy with {self.state.plan}; wait until it has finished, or stop it")

    async def _start(self, request: PaintRequest, is_painted: bool | None) -> None:
        plan = request.painting.parent.name
        request.options.check()
        self._see_that_it_is_free()
        if missing := await self._mixing.missing(plan):
            raise InputError(_to_be_mixed(plan, missing, len(await self._mixing.paints(plan)) == 1))
        self._see_that_it_is_free()  # another page may have been quicker
        self._begin("starting", request, paint_in_process, is_painted)

    def _begin(self, phase: Phase, request: PaintRequest, work: Callable[..., None], *more: object) -> None:
        process: Process | None = None

        def hear(word: object) -> None:
            if process is self._process:
                self._hear(word)

        def ended() -> None:
            if process is self._process:
                self._end(f"It ended without a word. {_LOOK_AT_IT}", fault=True)

        self._process = process = Process(work, request, *more, hear=hear, ended=ended)
        self.state = State(phase, request.painting.parent.name, request.options, seen=self.state.seen + 1)
        self.changed.emit()

    def _wonder_about(self, process: Process) -> None:
        if process is self._process:
            self._now(silent=True)

    def _hear(self, word: object) -> None:
        state = self.state
        match word:
            case Estimate() if state.phase == "checking":
                self._now(estimate=word)
                self._end("It fits." if word.strokes else "All strokes are painted.", fault=False)
            case Estimate():
                self._now(estimate=word, phase="painting" if state.phase == "starting" else state.phase)
            case Going():
                self._now(going=word, will_look=state.will_look and word.doing != PLANNING)
            case Asking(question=number, message=message):
                self._now(question=message or "", asked_for=number)
            case Photograph(jpeg=jpeg):
                self._now(photograph=jpeg, seen=state.seen + 1)
            case Note(sentence=sentence):
                self._now(notes=(*state.notes, sentence)[-_MOST_NOTES:])
            case Ended(why=None):
                self._end(f"{state.plan} is painted.", fault=False)
            case Ended(why="", lifted=lifted):
                self._end(f"You stopped it. {_PEN[lifted]}", fault=not lifted)
            case Ended(why=why) if state.phase == "starting":
                self._end(str(why), fault=True)
            case Ended(why=why, lifted=lifted):
                self._end(f"It stopped: {why}. {_PEN[lifted]}", fault=True)
            case Failed(why=why):
                self._end(f"{why}. {_LOOK_AT_IT}" if state.phase in ("painting", "stopping") else why, fault=True)

    def _end(self, sentence: str, *, fault: bool) -> None:
        self._process = None
        self._now(phase="ended", sentence=sentence, fault=fault, question="", held=False, silent=False, will_look=False)

    def _wish(self, command: Command | Done, **changes: Any) -> None:
        if self._process is not None and self.state.phase == "painting":
            self._process.tell(command)
            self._now(**changes)

    def _now(self, **changes: Any) -> None:
        self.state = replace(self.state, **changes)
        self.changed.emit()


def _to_be_mixed(plan: str, missing: list[PlannedPaint], is_pen: bool) -> str:
    if is_pen:
        return f"{plan} is drawn in one ink; put the pen into the holder first, and tick that under Paints"
    more = "" if len(missing) == 1 else f" and {len(missing) - 1} more"
    return f"{missing[0].called}{more} of {plan} must be mixed first; tick what is mixed under Paints"
