"""A window of a mural: all that its plan needs, so that any process can plan it, and to the same bits."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial

import torch

from maulstick.painting.brush import Brush
from maulstick.planning.features.network import Network
from maulstick.planning.from_picture import problem_of
from maulstick.planning.layout import Layout
from maulstick.planning.losses import LossOptions
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.planner import plan
from maulstick.planning.problem import Neighbours, PlannerSettings, PlanningProblem
from maulstick.planning.result import PlanProgress, PlanResult
from maulstick.planning.state import State
from maulstick.planning.tones import Tones
from maulstick.rendering.threads import one_thread_for_networks
from maulstick.storage.arrays import Image
from maulstick.style import Style

Watch = Callable[[PlanProgress], bool]
"""Function that is called with the progress after a step, and returns whether to go on."""


@dataclass(frozen=True)
class Window:
    """What one window is planned from; places are on the window's own canvas.

    index: among all windows of the mural.  importance: (H, W), how much each pixel counts.
    start: the strokes that it plans.  neighbours: those of other windows.  resume: its plan in the making, if any.
    """

    index: int
    layout: Layout
    importance: Image
    settings: PlannerSettings
    start: StrokeParameters
    neighbours: Neighbours
    resume: State | None


@dataclass(frozen=True)
class WindowPlanner:
    """What all windows of a mural, and the small image of the whole, are planned with: see `problem_of`."""

    brushes: tuple[Brush, ...]
    style: Style
    loss_options: LossOptions
    network: Callable[[], Network]
    device: torch.device
    tones: Tones | None

    def problem(self, layout: Layout, importance: Image, settings: PlannerSettings) -> PlanningProblem:
        """Return the planning problem of a layout of all or a part of the sheet."""
        return problem_of(
            layout,
            self.brushes,
            self.style,
            settings,
            self.loss_options,
            self.network,
            importance,
            self.device,
            self.tones,
        )

    @one_thread_for_networks()
    def plan(self, window: Window, watch: Watch) -> PlanResult:
        """Return the plan of a window."""
        problem = self.problem(window.layout, window.importance, window.settings)
        problem = replace(problem, neighbours=window.neighbours)
        return plan(problem, window.settings, watch, start=window.start, resume=window.resume)


WatchWindow = Callable[[int, PlanProgress], bool]
"""Function that is called with the index of a window and its progress, and returns whether to go on."""

PlanWindows = Callable[[WindowPlanner, Iterator[Window], WatchWindow], Iterator[tuple[int, PlanResult]]]
"""Function that plans windows, none of which needs another, and yields the index and the plan of each as it is ready.

It takes the next window when it can begin with it, so that no more are in memory than are in work. Once the watch
returns False, those in work end after a few more steps.
"""


def in_turn(planner: WindowPlanner, windows: Iterator[Window], watch: WatchWindow) -> Iterator[tuple[int, PlanResult]]:
    """Plan windows one after another in this process: the plainest `PlanWindows`."""
    for window in windows:
        yield window.index, planner.plan(window, partial(watch, window.index))
