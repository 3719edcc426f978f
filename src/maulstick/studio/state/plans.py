"""Plans of the studio, finished or in the making, each made in a process of its own."""

import os
import time
from pathlib import Path
from typing import final

from nicegui import Event

from maulstick.errors import InputError
from maulstick.jobs.plan.request import PlanRequest, state_files
from maulstick.robot.journal import journal_of
from maulstick.storage.folders import as_output_error
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.own_pictures import keep_own, keep_own_in_trash, with_own
from maulstick.studio.state.plan import Phase, Plan, read_plan
from maulstick.studio.state.titles import clean_title, relabel, retitle, title_of
from maulstick.studio.state.versions import Around
from maulstick.studio.workers.planner import TAKEN, Begun, Leave, Planned, Step, Stop, Weigh
from maulstick.studio.workers.planner import plan as plan_in_process
from maulstick.studio.workers.process import Failed, Process
from maulstick.studio.workers.spare import Spare

_AT_ONCE = max(1, (os.cpu_count() or 2) // 2)  # processes, so that the server and a machine have cores left
_NICENESS = 10  # below the server and a run, whose machine must not wait
_PATIENCE = 20.0  # seconds that plans get to store what they have when the studio closes


@final
class Plans:
    """All plans by name, oldest first. changed: event when a plan comes, goes or is in another phase."""

    def __init__(self, folder: Folder) -> None:
        self.changed = Event[[]]()
        self._folder = folder
        self._processes: dict[str, Process] = {}
        self._spare = Spare(plan_in_process, *TAKEN, niceness=_NICENESS)
        self.plans: dict[str, Plan] = {}
        self.look_again()

    def look_again(self) -> None:
        """Take in plans whose folders were put here by hand, and let go of those whose folders are gone."""
        before, names = self.plans, self._folder.names("plans")
        known = [name for name, plan in before.items() if name in names or plan.is_busy]
        self.plans = {}
        for name in dict.fromkeys((*known, *names)):
            plan = before.get(name)
            if plan is None or (plan.phase is Phase.STOPPED and plan.is_finished):  # its files were still on their way
                plan = read_plan(name, self._folder.of("plans", name))
            if plan is not None:
                self.plans[name] = plan
        if {*self.plans.values()} != {*before.values()}:
            self.changed.emit()

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
        """Go on with a plan that was stopped or failed. Raises InputError where a machine began it."""
        if journal_of(plan.folder / "painting.json").exists():
            raise InputError(
                f"{plan.title} was begun on paper, or rehearsed, so its strokes must stay; plan the picture once more"
            )
        if not plan.is_busy:
            plan.phase = Phase.WAITING
            self._next()

    def weigh(self, plan: Plan, weights: dict[str, float]) -> None:
        """Change the weights of the terms, by name, of a plan that `can_be_weighed`; do nothing for others."""
        if plan.can_be_weighed:
            plan.weigh(weights)
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
            if (plan := read_plan(path.name, path)) is not None:
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
                case Planned(metrics=metrics, weights=weights, notes=notes):
                    outcome = Phase.STOPPED if state_files(plan.folder) else Phase.PLANNED
                    plan.metrics, plan.notes = metrics, (*plan.notes, *notes)
                    if weights != plan.request.options.weights:  # the last change came too late
                        plan.weigh(weights)
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
