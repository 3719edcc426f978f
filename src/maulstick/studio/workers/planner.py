"""A plan in a process of its own."""

import shutil
import signal
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from maulstick.jobs.plan.request import PlanRequest, state_files
from maulstick.painting.painting import Painting
from maulstick.painting.picture import encode_jpeg
from maulstick.painting.raster import Canvas
from maulstick.storage.files import atomic_write, held
from maulstick.studio.workers.process import Line

if TYPE_CHECKING:
    from maulstick.planning.planner import PlanProgress

_TOLD_EVERY = 0.25  # seconds between two words
_FRAMES, _FRAME_PX = 48, 640
_PATIENCE = 30.0  # seconds for one to leave whose studio was killed

TARGET = "target.jpg"
"""In a plan's folder: the picture as it lies on the sheet, where there is one."""


@dataclass(frozen=True)
class Stop:
    """Finish now, with what there is."""


@dataclass(frozen=True)
class Leave:
    """Keep what there is to go on from, and end."""


@dataclass(frozen=True)
class Weigh:
    """Go on with these weights of the terms."""

    weights: dict[str, float]


@dataclass(frozen=True)
class Step:
    """How far planning is in [0, 1], what each term of the loss comes to, and the canvas, a JPEG."""

    done: float
    parts: Mapping[str, float]
    canvas: bytes


@dataclass(frozen=True)
class Planned:
    """The last word. figures: of the painting, for people."""

    metrics: tuple[str, ...]


def order_frame(folder: Path, number: int) -> Path:
    """A picture of a plan's first strokes; number: of such pictures, from 0."""
    return folder / "order" / f"{number:02}.jpg"


class _Wishes:
    """What the studio wants by now. weights: new ones, once."""

    def __init__(self) -> None:
        self.wanted, self.leaves = True, False
        self._weights: dict[str, float] | None = None

    def hear(self, word: object) -> None:
        """Take a word for it."""
        match word:
            case Weigh(weights=weights):
                self._weights = weights
            case Stop():
                self.wanted = False
            case Leave():
                self.leave()

    def leave(self) -> None:
        """Nobody wants it any more, for now."""
        self.wanted, self.leaves = False, True

    def reweighed(self) -> Mapping[str, float] | None:
        """The new weights, if there are any."""
        weights, self._weights = self._weights, None
        return weights


def plan(line: Line, request: PlanRequest, folder: Path) -> None:
    """Plan, or go on with the plan in its folder; once the studio is gone, all that going on needs is kept there."""
    from maulstick.jobs.plan.checkpoints import plan_with  # these load torch, which the server goes without
    from maulstick.jobs.plan.prepare import prepare
    from maulstick.jobs.plan.results import write_results

    loss_options, told, kept = _Wishes(), 0.0, False

    def watch(progress: "PlanProgress") -> bool:
        nonlocal told, kept
        if loss_options.leaves and kept:
            sys.exit()
        if time.monotonic() - told > _TOLD_EVERY:
            told = time.monotonic()
            canvas = progress.canvas.clamp(0, 1).permute(1, 2, 0).cpu().numpy()
            line.say(Step(progress.done, progress.parts, encode_jpeg(canvas)))
        kept = not loss_options.wanted  # since it is not, `plan_with` keeps it before the next step
        return loss_options.wanted

    line.heard_by(loss_options.hear, alone=loss_options.leave)
    signal.signal(signal.SIGHUP, signal.SIG_IGN)  # a terminal that closes ends the studio, which is heard
    taken = "an earlier studio still works on this plan; try again in a minute"
    with held(folder / ".plan.lock", taken, f"cannot write into {folder}", "make room there", _PATIENCE):
        prepared = prepare(request)
        if prepared.layout.target is not None:
            atomic_write(folder / TARGET, encode_jpeg(prepared.layout.target))
        painting = plan_with(prepared, folder, request, watch, loss_options.reweighed)
        write_results(painting, folder, None)
        _write_order(painting, folder)
        if loss_options.wanted:
            for file in state_files(folder):
                file.unlink()
        line.say(Planned(_metrics(painting)))


def _write_order(painting: Painting, folder: Path) -> None:
    """Pictures of its first strokes, ever more of them."""
    from maulstick.rendering.preview import preview

    width, height = painting.sheet.width, painting.sheet.height
    canvas = Canvas(width, height, _FRAME_PX / max(width, height))
    ends = np.unique(np.linspace(0, len(painting.strokes), _FRAMES).astype(int))
    shutil.rmtree(order_frame(folder, 0).parent, ignore_errors=True)
    order_frame(folder, 0).parent.mkdir()
    for number, end in enumerate(ends.tolist()):
        atomic_write(order_frame(folder, number), encode_jpeg(preview(painting, canvas, end)))


def _metrics(painting: Painting) -> tuple[str, ...]:
    paints = len(painting.paints)
    metres = f"{painting.metres_of_paints().sum():.1f} m drawn"
    return f"{len(painting.strokes)} strokes", metres, "1 paint" if paints == 1 else f"{paints} paints"
