"""Plan of one picture or text, as the studio has it: what was asked for, how far it is, and what came of it."""

import json
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from enum import Enum
from pathlib import Path
from typing import final

from nicegui import Event

from maulstick.jobs.plan.request import PlanRequest, state_files
from maulstick.storage.files import atomic_write
from maulstick.studio.state.carrying import REQUEST, carried_off, read_request
from maulstick.studio.state.own_pictures import with_own
from maulstick.studio.state.titles import title_of
from maulstick.studio.workers.planner import KEPT, Step, order_frame

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
    def is_finished(self) -> bool:
        """Whether its folder holds a painting with nothing left to plan."""
        return self.is_painting and not state_files(self.folder)

    @property
    def is_busy(self) -> bool:
        """Whether it has a process, or waits for one."""
        return self.phase in (Phase.WAITING, Phase.PLANNING, Phase.STOPPING)

    @property
    def can_be_weighed(self) -> bool:
        """Whether its weights can be changed: while it waits or is planned; several tries stay comparable."""
        is_planned = self.request.tries == 1 and not (self.folder / KEPT).is_file()
        return is_planned and self.phase in (Phase.WAITING, Phase.PLANNING)

    @property
    def planned(self) -> int:
        """Time of its painting, in nanoseconds; it differs after each planning."""
        return (self.folder / "painting.json").stat().st_mtime_ns

    def weigh(self, weights: Mapping[str, float]) -> None:
        """Ask for other weights of the terms, by name."""
        self.request = replace(self.request, options=replace(self.request.options, weights=dict(weights)))
        self.write_request()

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
        if self.curve and step.done < self.curve[-1][0]:  # it goes on from an earlier step
            began, done = self._began = now, step.done
            self.left = None
        if step.done > done:
            self.left = (now - began) * (1 - step.done) / (step.done - done)
        while self.curve and self.curve[-1][0] >= step.done:  # of steps that are taken again
            self.curve.pop()
        self.curve.append((step.done, step.parts))
        if len(self.curve) > _MOST_POINTS:
            self.curve = self.curve[::2]
        self.canvas, self.seen, self.attempt = step.canvas, self.seen + 1, step.attempt


def read_plan(name: str, folder: Path) -> Plan | None:
    """Return the plan that an earlier studio left in the folder, or None where there is none of this version."""
    try:
        plan = Plan(name, folder, read_request(folder / REQUEST, folder.parent.parent))
    except (OSError, ValueError):  # InputError is one: of another version of Maulstick
        return None
    with suppress(OSError, ValueError, KeyError):  # without it there is less to see
        story = json.loads((folder / _STORY).read_bytes())
        plan.metrics, plan.curve = tuple(story["metrics"]), [(done, parts) for done, parts in story["curve"]]
        plan.notes = tuple(story["notes"])
    plan.phase = Phase.PLANNED if plan.is_finished else Phase.STOPPED
    return plan
