"""Plans of the studio, finished or in the making, each made in a process of its own."""

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
from maulstick.studio.state.carrying import REQUEST, carried_off, read_request
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.own_pictures import keep_own, keep_own_in_trash, with_own
from maulstick.studio.state.titles import clean_title, relabel, retitle, title_of
from maulstick.studio.state.versions import Around
from maulstick.studio.workers.planner import TAKEN, Begun, Leave, Planned, Step, Stop, Weigh, order_frame
from maulstick.studio.workers.planner import plan as plan_in_process
from maulstick.studio.workers.process import Failed, Process
from maulstick.studio.workers.spare import Spare

_AT_ONCE = max(1, (os.cpu_count() or 2) // 2)  # processes, so that the server and a machine have cores left
_NICENESS = 10  # below the server and a run, whose machine must not wait
_PATIENCE = 20.0  # seconds that plans get to store what they have when the studio closes
_STORY = "story.json"  # in a plan's folder
_MOST_POINTS = 400  # of a loss curve, more than a page shows; every other one is dropped beyond


class Phase(Enum):
    """Phase of a plan, with its name for people."""

    WAITING = "waiting for its turn"
    PLANNING = "planning"
    STOPPING = "finishing what there is"
    PLANNED = "planned"
    STOPPED = "stopped early"
    FAILED = "not planned"


@final
class Plan:
    """Plan of one picture or text.

    curve: (done, parts of the loss) so far.  attempt: number of the try that is planned, from 1.
    canvas: the newest, a JPEG.  seen: number of canvases that came.
    left: estimated seconds, None while unknown.  metrics: of the painting, once there is one.
    notes: sentences on what may be other than people expect.  why: reason of a failure.
    stepped: event at every message of its process.
    """

    def __init__(self, name: str, folder: Path, request: PlanRequest) -> None:
        self.name, self.folder, self.request = name, folder, request
        self.stepped = Event[[]]()
        self.phase = Phase.WAITING
        self.curve: list[tuple[float, Mapping[str, float]]] = []
        self.canvas, self.seen, self.attempt = b"", 0, 1
        self.left: float | None = None
        self.metrics: tuple[str, ...] = ()
        self.notes: tuple[str, ...] = ()
        self.why = ""
        self._began: tuple[float, float] | None = None

    @property
    def title(self) -> str:
        """Title for people."""
        return title_of(self.folder)

    @property
    def picture(self) -> Path | None:
        """File of the picture that it is of, its own where that was thrown away, or None."""
        return with_own(self.request, self.folder).picture

    @property
    def done(self) -> float:
        """Share of planning that is done, in [0, 1]."""
        return 1.0 if self.phase is Phase.PLANNED else self.curve[-1][0] if self.curve else 0.0

    @property
    def frames(self) -> int:
        """Number of pictures that show the order of its strokes."""
        return len(list(order_frame(self.folder, 0).parent.glob("*.jpg"))) if self.is_painting else 0

    @property
    def is_painting(self) -> bool:
        """Whether its folder holds a painting."""
        return (self.folder / "painting.json").is_file()

    @property
    def is_busy(self) -> bool:
        """Whether it has a process, or waits for one."""
        return self.phase in (Phase.WAITING, Phase.PLANNING, Phase.STOPPING)

    @property
    def planned(self) -> int:
        """Time of its painting, in nanoseconds; it differs after each planning."""
        return (self.folder / "painting.json").stat().st_mtime_ns

    def write_request(self) -> None:
        """Write its request into its folder."""
        plain = carried_off(self.request.as_json(), self.folder.parent.parent)
        atomic_write(self.folder / REQUEST, json.dumps(plain, indent=1).encode())

    def write_story(self) -> None:
        """Write its metrics, curve and notes into its folder, for a studio that is opened later."""
        curve = [[done, dict(parts)] for done, parts in self.curve]
        story = {"metrics": self.metrics, "curve": curve, "notes": self.notes}
        atomic_write(self.folder / _STORY, json.dumps(story).encode())

    def begin(self) -> None:
        """Note that its process begins to plan, or to go on."""
        self.phase, self._began, self.left, self.why = Phase.PLANNING, None, None, ""
        self.notes = ()

    def take(self, step: Step) -> None:
        """Take a step of its process."""
        now = time.monotonic()
        began, done = self._began = self._began or (now, step.done)
        if self.curve and step.done < self.curve[-1][0]:  # more steps follow, for other weights
            began, done = self._began = now, step.done
        if step.done > done:
            self.left = (now - began) * (1 - step.done) / (step.done - done)
        while self.curve and self.curve[-1][0] >= step.done:  # of steps that are taken again
            self.curve.pop()
        self.curve.append((step.done, step.parts))
        if len(self.curve) > _MOST_POINTS:
            self.curve = self.curve[::2]
        self.canvas, self.seen, self.attempt = step.canvas, self.seen + 1, step.attempt


@final
class Plans:
    """All plans by name, oldest first. changed: event when a plan comes, goes or is in another phase."""

    def __init__(self, folder: Folder) -> None:
        self.changed = Event[[]]()
        self._folder = folder
        self._processes: dict[str, Process] = {}
        self._spare = Spare(plan_in_process, *TAKEN, niceness=_NICENESS)
        self.plans: dict[str, Plan] = {}
        for name in folder.names("plans"):
            if (plan := _read_plan(name, folder.of("plans", name))) is not None:
                self.plans[name] = plan

    @property
    def doing(self) -> str:
        """Plans in the making, in one line; "" where there are none."""
        busy = [plan for plan in self.plans.values() if plan.is_busy]
        if not busy:
            return ""
        return f"planning {self.titles()[busy[0].name]}" if len(busy) == 1 else f"planning {len(busy)} pictures"

    def be_ready(self) -> None:
        """Let a process load what planning takes, since a plan may come soon; not while others need the cores.

        Called again and again while a panel is open on which plans begin.
        """
        if len(self._processes) < _AT_ONCE:
            self._spare.be_ready()

    def add(self, request: PlanRequest, title: str = "", around: Around | None = None) -> Plan:
        """Add a plan, and begin it at once or when others are finished.

        title: another than that of its picture or text.  around: what it is planned around, if anything.
        """
        picture, text = request.picture, request.options.text or ""
        usual = clean_title(text) if picture is None else title_of(picture.parent)
        title = self._folder.title_for("plans", title or usual)
        name = self._folder.free_name("plans", title)
        plan = Plan(name, self._folder.of("plans", name), request)
        with as_output_error(plan.folder):
            plan.folder.mkdir()
            if around is not None:
                plan.request = around.move_to(plan.folder, request)
                plan.canvas, plan.seen = around.frame, 1
        plan.write_request()
        retitle(plan.folder, title)
        self.plans[name] = plan
        self._next()
        return plan

    def of(self, name: str) -> Plan:
        """Return the plan of that name. Raises InputError where there is none."""
        if name not in self.plans:
            raise InputError(f"there is no plan {name} any more")
        return self.plans[name]

    def stop(self, plan: Plan) -> None:
        """Finish a plan with the strokes as they are; `go_on` can go on from there."""
        if plan.phase is Phase.WAITING:
            plan.phase = Phase.STOPPED
        elif plan.phase is Phase.PLANNING:
            plan.phase = Phase.STOPPING
            self._processes[plan.name].tell(Stop())
        self.changed.emit()

    def go_on(self, plan: Plan) -> None:
        """Go on with a plan that was stopped or failed. Raises InputError where it was begun on paper."""
        if journal_of(plan.folder / "painting.json").exists():
            raise InputError(f"{plan.title} was begun on paper, so its strokes must stay; plan the picture once more")
        if not plan.is_busy:
            plan.phase = Phase.WAITING
            self._next()

    def weigh(self, plan: Plan, weights: dict[str, float]) -> None:
        """Change the weights of the terms, by name, until a plan is made; those of several tries stay comparable."""
        if plan.phase in (Phase.WAITING, Phase.PLANNING) and plan.request.tries == 1:
            plan.request = replace(plan.request, options=replace(plan.request.options, weights=weights))
            plan.write_request()
            if plan.phase is Phase.PLANNING:
                self._processes[plan.name].tell(Weigh(weights))
            plan.stepped.emit()

    def titles(self) -> dict[str, str]:
        """Return the titles of all plans by name, told apart."""
        return self._folder.titles("plans")

    def relabel(self, plan: Plan, **changes: str | bool) -> None:
        """Change fields of a plan's `titles.Label`, while it is planned or painted, too."""
        relabel(plan.folder, **changes)
        self.changed.emit()

    def part_with(self, picture: Path) -> None:
        """Let all plans that are made from a picture keep it, before it is thrown away; those in the trash, too.

        Raises InputError while one is being made, and OutputError where one cannot keep it.
        """
        using = [plan for plan in self.plans.values() if picture in plan.request.files]
        if busy := [plan.title for plan in using if plan.is_busy]:
            raise InputError(f"{busy[0]} is being planned from that picture; stop it first")
        for plan in using:
            keep_own(plan.folder, plan.request, picture)
        keep_own_in_trash(self._folder.root, picture)

    def throw_away(self, plan: Plan) -> Path:
        """Move a plan into the trash; return its place there. Raises InputError while it is planned."""
        if plan.is_busy:
            raise InputError(f"{plan.title} is being planned; stop it first")
        trashed = self._folder.throw_away(plan.folder)
        del self.plans[plan.name]
        self.changed.emit()
        return trashed

    def take_back(self, trashed: Path, name: str = "") -> None:
        """Move a plan back out of the trash; raises, and name, as `Folder.take_back`."""
        for path in self._folder.take_back(trashed, self._folder.root / "plans", name):
            if (plan := _read_plan(path.name, path)) is not None:
                self.plans[path.name] = plan
        self.changed.emit()

    def close(self) -> None:
        """Let all plans in the making store what they have, and end their processes."""
        self._spare.close()
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
        """Begin the plans whose turn it is."""
        for plan in self.plans.values():
            if plan.phase is Phase.WAITING and len(self._processes) < _AT_ONCE:
                self._begin(plan)
        self.changed.emit()

    def _begin(self, plan: Plan) -> None:
        outcome = Phase.STOPPED

        def hear(message: Begun | Step | Planned | Failed) -> None:
            nonlocal outcome
            match message:
                case Begun(notes=notes):
                    plan.notes = notes
                    plan.stepped.emit()
                case Step():
                    plan.take(message)
                    plan.stepped.emit()
                case Planned(metrics=metrics):
                    outcome = Phase.STOPPED if state_files(plan.folder) else Phase.PLANNED
                    plan.metrics = metrics
                    plan.write_story()
                case Failed(why=why):
                    outcome, plan.why = Phase.FAILED, why

        def ended() -> None:
            plan.phase = outcome
            del self._processes[plan.name]
            self._next()

        request = with_own(plan.request, plan.folder)
        self._processes[plan.name] = self._spare.begin(request, plan.folder, hear=hear, ended=ended)
        plan.begin()


def _read_plan(name: str, folder: Path) -> Plan | None:
    """Return the plan that an earlier studio left in the folder, or None where there is none of this version."""
    try:
        plan = Plan(name, folder, read_request(folder / REQUEST, folder.parent.parent))
    except (OSError, ValueError):  # InputError is one: of another version of Maulstick
        return None
    with suppress(OSError, ValueError, KeyError):  # without it there is less to see
        story = json.loads((folder / _STORY).read_bytes())
        plan.metrics, plan.curve = tuple(story["metrics"]), [(done, parts) for done, parts in story["curve"]]
        plan.notes = tuple(story["notes"])
    plan.phase = Phase.PLANNED if plan.is_painting and not state_files(folder) else Phase.STOPPED
    return plan
