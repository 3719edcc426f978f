"""Planning in a process of its own."""

import shutil
import signal
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from maulstick.jobs.plan.request import PlanRequest, state_file, state_files
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import read_painting, write_painting
from maulstick.painting.picture import encode_jpeg
from maulstick.painting.raster import Canvas
from maulstick.storage.files import atomic_write, held
from maulstick.storage.text import counted
from maulstick.studio.workers.process import Line
from maulstick.studio.workers.unchanged import check_or_keep_sums

if TYPE_CHECKING:
    from maulstick.planning.result import PlanProgress

_STEP_PERIOD = 0.25  # seconds between two messages: fluent on the page, and cheap beside planning
_FRAMES, _FRAME_PX = 48, 640  # pictures of the order of strokes, one per step of a slider; pixels of the longer side
_PATIENCE = 30.0  # seconds that the process of a killed studio gets to store its plan

TAKEN = (
    "maulstick.jobs.plan.checkpoints",
    "maulstick.jobs.plan.results",
    "maulstick.jobs.plan.tries",
    "maulstick.planning.planner",
    "maulstick.rendering.preview",
    "sklearn.cluster",
)
"""Modules that planning takes, and that take seconds to load."""

TARGET = "target.jpg"
"""File in a plan's folder: the picture as it lies on the sheet, where there is one."""

KEPT = "kept.json"
"""File in the folder of a version that is not planned: its painting, as a person left it."""


@dataclass(frozen=True)
class Stop:
    """Message to the process: finish now, with the strokes as they are."""


@dataclass(frozen=True)
class Leave:
    """Message to the process: store what going on later needs, and end."""


@dataclass(frozen=True)
class Weigh:
    """Message to the process: go on with these weights of the terms."""

    weights: dict[str, float]


@dataclass(frozen=True)
class Begun:
    """First message of a plan. notes: sentences for people on what may be other than they expect."""

    notes: tuple[str, ...]


@dataclass(frozen=True)
class Step:
    """Progress of planning.

    attempt: number of the try, from 1.  done: share of all tries in [0, 1].  parts: weighted terms of the loss by name.
    canvas: a JPEG.
    """

    attempt: int
    done: float
    parts: Mapping[str, float]
    canvas: bytes


@dataclass(frozen=True)
class Planned:
    """Last message of a plan that was finished or stopped.

    metrics: of the painting, for people.  weights: of the terms, by name, that it was planned with at last.
    notes: further sentences for people on what is other than they expect.
    """

    metrics: tuple[str, ...]
    weights: Mapping[str, float]
    notes: tuple[str, ...]


def order_frame(folder: Path, number: int) -> Path:
    """Return the path of a picture of a plan's first strokes. number: of the picture, from 0."""
    return folder / "order" / f"{number:02}.jpg"


class _Control:
    """Control of planning by messages of the studio.

    goes_on: whether to plan further.  leaves: whether to store the plan and end.
    weights: that are planned with, at first those of the request.
    """

    def __init__(self, weights: Mapping[str, float]) -> None:
        self.goes_on, self.leaves, self.weights = True, False, weights
        self._wanted: dict[str, float] | None = None

    def hear(self, word: object) -> None:
        """Take a message of the studio."""
        match word:
            case Weigh(weights=weights):
                self._wanted = weights
            case Stop():
                self.goes_on = False
            case Leave():
                self.leave()

    def leave(self) -> None:
        """Let planning store what it has, and end."""
        self.goes_on, self.leaves = False, True

    def take_weights(self) -> Mapping[str, float] | None:
        """Return the weights that came since the last call, or None."""
        wanted, self._wanted = self._wanted, None
        if wanted is not None:
            self.weights = wanted
        return wanted


class _Watch:
    """Watch over the steps of planning, which it shows to the studio until that ends it. attempt: number of the try."""

    def __init__(self, line: Line, control: _Control, tries: int) -> None:
        self.attempt, self.is_stopped = 1, False
        self._line, self._control, self._tries = line, control, tries
        self._sent = 0.0

    def __call__(self, progress: "PlanProgress") -> bool:
        """Show a step, and return whether to go on; ends the process once what going on later needs is stored."""
        if self._control.leaves and self.is_stopped:
            sys.exit()
        if time.monotonic() - self._sent > _STEP_PERIOD:
            self._sent = time.monotonic()
            canvas = progress.canvas.clamp(0, 1).permute(1, 2, 0).cpu().numpy()
            done = (self.attempt - 1 + progress.done) / self._tries
            self._line.say(Step(self.attempt, done, progress.parts, encode_jpeg(canvas)))
        self.is_stopped = not self._control.goes_on  # where it is, `plan_with` stores the plan before the next step
        return self._control.goes_on


def plan(line: Line, request: PlanRequest, folder: Path) -> None:
    """Plan, or go on with the plan in its folder; store there what going on later needs, once the studio is gone.

    Of a painting that is kept as it is, write the files that a plan has.
    """
    from maulstick.jobs.plan.results import notes_on, write_results  # these load torch, which the server goes without
    from maulstick.jobs.plan.tries import best_of, seeds_of

    control = _Control(request.options.weights)
    watch = _Watch(line, control, request.tries)
    line.heard_by(control.hear, alone=control.leave)
    signal.signal(signal.SIGHUP, signal.SIG_IGN)  # a terminal that closes ends the studio, which is heard
    notes: tuple[str, ...] = ()
    taken = "an earlier studio still works on this plan; try again in a minute"
    with held(folder / ".plan.lock", taken, f"cannot write into {folder}", "make room there", _PATIENCE):
        if (kept := folder / KEPT).is_file():
            painting = read_painting(kept)
        else:
            made: list[Painting] = []
            for watch.attempt, seed in enumerate(seeds_of(request), start=1):
                made.append(_tried(line, request, folder, seed, watch, control))
                if watch.is_stopped:
                    break
            painting = best_of(made)
            notes = tuple(notes_on(painting))
        write_results(painting, folder, None)
        _write_order(painting, folder)
        if not watch.is_stopped:
            for file in (*state_files(folder), *map(partial(_try_file, folder), seeds_of(request))):
                file.unlink(missing_ok=True)
        line.say(Planned(_metrics(painting), control.weights, notes))


def _tried(line: Line, request: PlanRequest, folder: Path, seed: int, watch: _Watch, control: _Control) -> Painting:
    """Return the painting of one try, which is kept in the folder where others follow, for when they are stopped."""
    from maulstick.jobs.plan.checkpoints import plan_with
    from maulstick.jobs.plan.tries import prepare_try

    if (kept := _try_file(folder, seed)).is_file():
        return read_painting(kept)
    prepared = prepare_try(request, seed)
    check_or_keep_sums(prepared.request, folder, is_begun=any(folder.glob("try-*.json")))
    line.say(Begun(tuple(prepared.notes)))
    if prepared.layout.target is not None:
        atomic_write(folder / TARGET, encode_jpeg(prepared.layout.target))
    painting = plan_with(prepared, folder, request, watch, control.take_weights)
    if request.tries > 1 and not watch.is_stopped:
        write_painting(painting, kept)
        state_file(folder, seed).unlink(missing_ok=True)
    return painting


def _try_file(folder: Path, seed: int) -> Path:
    """Return the path of the painting of a try that is over, while others follow."""
    return folder / f"try-{seed}.json"


def _write_order(painting: Painting, folder: Path) -> None:
    """Write pictures of the first strokes, each with more of them than the one before."""
    from maulstick.rendering.preview import growing

    width, height = painting.sheet.width, painting.sheet.height
    canvas = Canvas(width, height, _FRAME_PX / max(width, height))
    ends = np.unique(np.linspace(0, len(painting.strokes), _FRAMES).astype(int))
    shutil.rmtree(order_frame(folder, 0).parent, ignore_errors=True)
    order_frame(folder, 0).parent.mkdir()
    for number, image in enumerate(growing(painting, canvas, ends.tolist())):
        atomic_write(order_frame(folder, number), encode_jpeg(image))


def _metrics(painting: Painting) -> tuple[str, ...]:
    metres = f"{painting.metres_of_paints().sum():.1f} m drawn"
    return counted(len(painting.strokes), "stroke"), metres, counted(len(painting.colours()), "paint")
