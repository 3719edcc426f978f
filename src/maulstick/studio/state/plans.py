"""The plans of the studio: those there are, and those that are being made, each in a process of its own."""

import json
import os
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from enum import Enum
from pathlib import Path
from typing import final

from nicegui import Event

from maulstick.errors import InputError
from maulstick.jobs.plan.request import PlanRequest, state_files
from maulstick.robot.journal import journal_of
from maulstick.storage.files import atomic_write
from maulstick.storage.folders import as_output_error
from maulstick.studio.state.folder import Folder
from maulstick.studio.workers.planner import Leave, Planned, Step, Stop, Weigh, order_frame
from maulstick.studio.workers.planner import plan as plan_in_process
from maulstick.studio.workers.process import Failed, Process

_AT_ONCE = max(1, (os.cpu_count() or 2) // 2)
_NICENESS = 10
_PATIENCE = 20.0  # seconds for plans to keep what they have
_REQUEST, _STORY = "request.json", "story.json"
_CURVE = 400  # steps of a loss that are kept at most


class Phase(Enum):
    """What a plan is doing, in a person's words."""

    WAITING = "waiting for its turn"
    PLANNING = "planning"
    STOPPING = "finishing what there is"
    PLANNED = "planned"
    STOPPED = "stopped early"
    FAILED = "not planned"


@final
class Plan:
    """One of them.

    asked: its words.  curve: (done, parts of the loss) so far.  canvas: the newest, a JPEG, and `seen` how many came.
    left: seconds, as far as one can tell.  metrics: once it is planned.  why: it failed.
    stepped: at every word from its process.
    """

    def __init__(self, name: str, folder: Path, asked: PlanRequest) -> None:
        self.name, self.folder, self.asked = name, folder, asked
        self.stepped = Event[[]]()
        self.phase = Phase.WAITING
        self.curve: list[tuple[float, Mapping[str, float]]] = []
        self.canvas, self.seen = b"", 0
        self.left: float | None = None
        self.metrics: tuple[str, ...] = ()
        self.why = ""
        self._began: tuple[float, float] | None = None

    @property
    def done(self) -> float:
        """How far it is, in [0, 1]."""
        return 1.0 if self.phase is Phase.PLANNED else self.curve[-1][0] if self.curve else 0.0

    @property
    def frames(self) -> int:
        """How many pictures show the order of its strokes."""
        return len(list(order_frame(self.folder, 0).parent.glob("*.jpg"))) if self.is_painting else 0

    @property
    def is_painting(self) -> bool:
        """Whether there is something to paint."""
        return (self.folder / "painting.json").is_file()

    @property
    def is_busy(self) -> bool:
        """Whether it has a process, or waits for one."""
        return self.phase in (Phase.WAITING, Phase.PLANNING, Phase.STOPPING)

    @property
    def planned(self) -> int:
        """Another number whenever what is there was planned anew."""
        return (self.folder / "painting.json").stat().st_mtime_ns

    def keep_words(self) -> None:
        """Let its folder know what was asked."""
        atomic_write(self.folder / _REQUEST, json.dumps(self.asked.as_json(), indent=1).encode())

    def keep_story(self) -> None:
        """Let its folder know how planning went, for a studio that is opened later."""
        story = {"metrics": self.metrics, "curve": [[done, dict(parts)] for done, parts in self.curve]}
        atomic_write(self.folder / _STORY, json.dumps(story).encode())

    def begin(self) -> None:
        """It is planned from now on."""
        self.phase, self.curve, self._began, self.left, self.why = Phase.PLANNING, [], None, None, ""

    def take(self, step: Step) -> None:
        """It made a step."""
        now = time.monotonic()
        began, done = self._began = self._began or (now, step.done)
        if step.done > done:
            self.left = (now - began) * (1 - step.done) / (step.done - done)
        self.curve.append((step.done, step.parts))
        if len(self.curve) > _CURVE:
            self.curve = self.curve[::2]
        self.canvas, self.seen = step.canvas, self.seen + 1


@final
class Plans:
    """All of them by name, oldest first. changed: when there are others, or one is in another phase."""

    def __init__(self, folder: Folder) -> None:
        self.changed = Event[[]]()
        self._folder = folder
        self._processes: dict[str, Process] = {}
        self.plans: dict[str, Plan] = {}
        for name in folder.names("plans"):
            if (plan := _found(name, folder.of("plans", name))) is not None:
                self.plans[name] = plan

    @property
    def doing(self) -> str:
        """What is being planned, in a line."""
        going = [plan for plan in self.plans.values() if plan.is_busy]
        if not going:
            return ""
        return f"planning {going[0].name}" if len(going) == 1 else f"planning {len(going)} pictures"

    def add(self, asked: PlanRequest) -> Plan:
        """Plan what is asked, at once or when others are finished."""
        wish = asked.picture.parent.name if asked.picture is not None else asked.options.text or "plan"
        name = self._folder.free_name("plans", wish)
        plan = Plan(name, self._folder.of("plans", name), asked)
        with as_output_error(plan.folder):
            plan.folder.mkdir()
        plan.keep_words()
        self.plans[name] = plan
        self._next()
        return plan

    def of(self, name: str) -> Plan:
        """The plan of that name. Raises InputError where there is none."""
        if name not in self.plans:
            raise InputError(f"there is no plan {name} any more")
        return self.plans[name]

    def stop(self, plan: Plan) -> None:
        """Finish with what there is; `go_on` can go on from there."""
        if plan.phase is Phase.WAITING:
            plan.phase = Phase.STOPPED
        elif plan.phase is Phase.PLANNING:
            plan.phase = Phase.STOPPING
            self._processes[plan.name].tell(Stop())
        self.changed.emit()

    def go_on(self, plan: Plan) -> None:
        """Go on with a plan that was stopped, or that failed. Raises InputError where it is already being painted."""
        if journal_of(plan.folder / "painting.json").exists():
            raise InputError(f"{plan.name} was begun on paper, so its strokes must stay; plan the picture once more")
        if not plan.is_busy:
            plan.phase = Phase.WAITING
            self._next()

    def weigh(self, plan: Plan, weights: dict[str, float]) -> None:
        """Let terms count more, or less, from now on."""
        if plan.phase is Phase.PLANNING:
            plan.asked = replace(plan.asked, options=replace(plan.asked.options, weights=weights))
            plan.keep_words()
            self._processes[plan.name].tell(Weigh(weights))
            plan.stepped.emit()

    def throw_away(self, plan: Plan) -> Path:
        """Put it into the trash; where it is there."""
        if plan.is_busy:
            raise InputError(f"{plan.name} is being planned; stop it first")
        grave = self._folder.throw_away(plan.folder)
        del self.plans[plan.name]
        self.changed.emit()
        return grave

    def take_back(self, grave: Path) -> None:
        """Take it out of the trash."""
        for path in self._folder.take_back(grave, self._folder.root / "plans"):
            if (plan := _found(path.name, path)) is not None:
                self.plans[path.name] = plan
        self.changed.emit()

    def close(self) -> None:
        """Let all that are being planned keep what they have."""
        for plan in self.plans.values():
            if plan.phase is Phase.WAITING:
                plan.phase = Phase.STOPPED
        processes = list(self._processes.values())
        for process in processes:
            process.tell(Leave())
        until = time.monotonic() + _PATIENCE
        for process in processes:
            if not process.join(max(0.0, until - time.monotonic())):
                process.kill()

    def _next(self) -> None:
        """Begin with those whose turn it is."""
        for plan in self.plans.values():
            if plan.phase is Phase.WAITING and len(self._processes) < _AT_ONCE:
                self._begin(plan)
        self.changed.emit()

    def _begin(self, made: Plan) -> None:
        outcome = Phase.STOPPED

        def hear(word: Step | Planned | Failed) -> None:
            nonlocal outcome
            match word:
                case Step():
                    made.take(word)
                    made.stepped.emit()
                case Planned(metrics=metrics):
                    outcome = Phase.STOPPED if state_files(made.folder) else Phase.PLANNED
                    made.metrics = metrics
                    made.keep_story()
                case Failed(why=why):
                    outcome, made.why = Phase.FAILED, why

        def ended() -> None:
            made.phase = outcome
            del self._processes[made.name]
            self._next()

        self._processes[made.name] = Process(
            plan_in_process, made.asked, made.folder, hear=hear, ended=ended, niceness=_NICENESS
        )
        made.begin()


def _found(name: str, folder: Path) -> Plan | None:
    """A plan that an earlier studio left, if that is what is in the folder."""
    path = folder / _REQUEST
    try:
        plan = Plan(name, folder, PlanRequest.from_json(json.loads(path.read_bytes()), path))
    except (OSError, ValueError):  # InputError is one: of another version of Maulstick
        return None
    with suppress(OSError, ValueError, KeyError):  # without it there is less to see
        story = json.loads((folder / _STORY).read_bytes())
        plan.metrics, plan.curve = tuple(story["metrics"]), [(done, parts) for done, parts in story["curve"]]
    plan.phase = Phase.PLANNED if plan.is_painting and not state_files(folder) else Phase.STOPPED
    return plan
