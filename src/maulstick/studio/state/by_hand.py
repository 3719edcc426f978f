"""Machine that a person sets up on the page, before anything is painted."""

import asyncio
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, Literal, final

from nicegui import Event

from maulstick.errors import InputError
from maulstick.jobs.paint.options import PaintOptions
from maulstick.studio.state.easels import Easels
from maulstick.studio.wording import LOOK_AT_IT, machine_name
from maulstick.studio.workers.by_hand import Deed, Locked, Loose, Standing, Word, move_by_hand
from maulstick.studio.workers.messages import Ended
from maulstick.studio.workers.process import CLOSING, LONGEST_STOP, Failed, Process

_MOST_WAITING = 3  # words that wait for their turn: a person who clicks faster does not see where the pen will be

Phase = Literal["off", "connecting", "locked", "ready", "moving", "loose", "stopping"]
_TAKEN: Final[dict[Phase, tuple[Word, ...]]] = {
    "locked": (Deed.FIND_HOME, Deed.UNLOCK, Deed.LEAVE),
    "loose": (Deed.TAKE_HOLD, Deed.LEAVE),
}
"""Words that are taken in some phases; in others all are, or none."""

_LOCKED = (
    "The machine is locked, as its place may be lost. Let it find home by its switches, where its way is free and the "
    "pen off the paper; or unlock it, if the pen stands where it was left."
)


@dataclass(frozen=True)
class HandState:
    """State of the machine in hand. machine: its spec.  standing: where it was last, once it is entered.

    sentence: what was said last.  fault: whether it is a fault.
    """

    phase: Phase = "off"
    machine: str = ""
    standing: Standing | None = None
    sentence: str = ""
    fault: bool = False


@final
class ByHand:
    """Machine that all pages move alike, one at a time. changed: event at each new state."""

    def __init__(self, easels: Easels) -> None:
        self.changed = Event[[]]()
        self.state = HandState()
        self._easels = easels
        self._process: Process | None = None
        self._waiting = 0

    @property
    def is_on(self) -> bool:
        """Whether a machine is in hand."""
        return self._process is not None

    @property
    def doing(self) -> str:
        """Description of it in a few words; "" where no machine is in hand."""
        return f"{machine_name(self.state.machine)} is moved by hand" if self.is_on else ""

    def begin(self, options: PaintOptions, painting: Path | None) -> None:
        """Take hold of the machine of these options. painting: file whose sheet lies before it, if any.

        Raises InputError where the machine is simulated, or one is in hand already.
        """
        if options.simulated:
            raise InputError("the simulated easel has its sheet in place and no pen to set; choose a real machine")
        if self.is_on:
            raise InputError(f"{machine_name(self.state.machine)} is in hand already; let it go first")

        def ended() -> None:
            self._end(f"It ended without a word. {LOOK_AT_IT}", fault=True)

        self._waiting = 0
        self._process = Process(move_by_hand, options.machine, options.easel, painting, hear=self._hear, ended=ended)
        self.state = HandState("connecting", options.machine)
        self.changed.emit()

    def do(self, word: Word) -> None:
        """Pass a word on to the machine, which acts on one after another; more than a few are not taken.

        With its motors off, only `Deed.TAKE_HOLD` and `Deed.LEAVE` are, and while it is locked, what unlocks it.
        """
        if self._process is None or self.state.phase in ("connecting", "stopping"):
            return
        if word not in _TAKEN.get(self.state.phase, (word,)):
            return
        if self._waiting < _MOST_WAITING:
            self._waiting += 1
            self._process.tell(word)
            said = {"sentence": "Finding home …", "fault": False} if word is Deed.FIND_HOME else {}
            self._change(phase="moving", **said)

    def stop(self) -> str:
        """Stop the machine at once and lift its pen; return what was stopped, or "" where none is in hand."""
        if self._process is None:
            return ""
        self._process.tell(Deed.STOP)
        if self.state.phase != "stopping":
            asyncio.get_running_loop().call_later(LONGEST_STOP, self._give_up, self._process)
        self._change(phase="stopping")
        return "The machine stops and lifts its pen."

    def keep(self, name: str) -> str:
        """Keep where the sheet lies, and the servo's numbers, as an easel; return its name here.

        Raises InputError where nothing is in hand, OutputError where it cannot be written.
        """
        if self.state.standing is None:
            raise InputError("no machine is in hand; take hold of one first")
        kept = self._easels.keep(name, self.state.standing.easel.model_dump_json().encode())
        self._change(standing=replace(self.state.standing, changed=False), sentence=f"{kept} is kept", fault=False)
        return kept

    async def close(self) -> None:
        """Stop the machine, and wait until its pen is lifted."""
        process = self._process
        self.stop()
        if process is not None:
            await asyncio.to_thread(process.join, CLOSING)

    def _hear(self, received: object) -> None:
        match received:
            case Standing(said=said, fault=fault):
                self._waiting = max(self._waiting - 1, 0)
                phase = "stopping" if self.state.phase == "stopping" else "moving" if self._waiting else "ready"
                self._change(phase=phase, standing=received, sentence=said, fault=fault)
            case Locked(fault=fault):
                self._waiting = 0
                self._change(phase="locked", standing=None, sentence=fault or _LOCKED, fault=bool(fault))
            case Loose():
                self._waiting = 0
                self._change(phase="loose", sentence="The motors are off: push the pen to its home corner by hand.")
            case Ended(why=None):
                self._end("", fault=False)
            case Ended(why="", lifted=lifted):
                self._end("You stopped it." + ("" if lifted else f" {LOOK_AT_IT}"), fault=not lifted)
            case Ended(why=why, lifted=lifted):
                self._end(f"{why}." + ("" if lifted else f" {LOOK_AT_IT}"), fault=True)
            case Failed(why=why):
                self._end(why, fault=True)

    def _give_up(self, process: Process) -> None:
        if process is self._process:
            process.kill()
            self._end(f"It did not answer. {LOOK_AT_IT}", fault=True)

    def _end(self, sentence: str, *, fault: bool) -> None:
        if self._process is not None:
            self._process.forget()
            self._process = None
        standing = self.state.standing
        if standing is not None and standing.changed:
            sentence = f"{sentence} The pen's new numbers or place were not kept.".strip()
        self.state = HandState(sentence=sentence, fault=fault)
        self.changed.emit()

    def _change(self, **changes: Any) -> None:
        self.state = replace(self.state, **changes)
        self.changed.emit()
