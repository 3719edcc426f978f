"""Pictures too large to be planned in one piece: window by window, in memory that the window and the strokes bound.

All strokes are first planned together on a small image of the whole: how many go where, and their paints, are settled
there. Then each window in turn is planned at full resolution with a margin around it. Strokes whose centres end up in
its core are finished; those in the margin are planned again, and better, with the window whose core they lie in. What
a window does not plan is painted in its place among what it does, but stays as it is. So every stroke is planned with
all that it touches, and the order, paint by paint, is the same in all windows.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from math import ceil

import numpy as np
import torch
from torch import Generator, Tensor

from maulstick.colour.palette import lightness
from maulstick.errors import InputError
from maulstick.painting.brush import Brush
from maulstick.planning.features.efficientnet import EfficientNetLite0
from maulstick.planning.features.network import Network
from maulstick.planning.from_picture import importance_of, problem_of
from maulstick.planning.layout import Layout
from maulstick.planning.losses import LossOptions
from maulstick.planning.mural.windows import Mural, Windows, enlarged
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.placement import Places, start_strokes
from maulstick.planning.planner import PlanProgress, PlanResult, plan
from maulstick.planning.problem import Neighbours, PlannerSettings, PlanningProblem
from maulstick.planning.state import State
from maulstick.planning.stroke_canvas import as_array
from maulstick.storage.arrays import Image
from maulstick.style import Style

_DEFAULT_LOSSES = LossOptions()
_TRIED, _NEARLY_ALL = 256, 0.95
_SLACK = 1e-6  # metres, to which strokes are known to end within a sheet
_ALL, _BEGUN = "all.", "begun."

Watch = Callable[[PlanProgress], bool]


def plan_mural(
    mural: Mural,
    brush: Brush,
    style: Style,
    options: PlannerSettings,
    watch: Watch = lambda progress: True,
    *,
    loss_options: LossOptions = _DEFAULT_LOSSES,
    network: Callable[[], Network] = EfficientNetLite0,
    window_px: int = 1024,
    resume: State | None = None,
) -> PlanResult:
    """Plan a mural in windows whose cores have at most `window_px` a side; so has the small image of the whole.

    The steps are those of each window, and of the whole.
    watch: called after every step, and shown the window that is being planned; once it returns False, that is finished
    in a few more steps, and later windows stay as they were planned in the whole.
    resume: what `PlanProgress.state` said in an earlier run that was asked for the same; planning goes on from there.
    Raises InputError for a text: every window would be made to show it.
    """
    if "text" in loss_options.weights_of_terms(has_picture=True):
        raise InputError("a text is about a whole picture, and a mural is planned in windows; leave the text out")
    if window_px < 1:
        raise InputError.of_range("the side of a window", f"{window_px} pixels", "at least 1")
    planning = _Planning(mural, brush, style, options, loss_options, cache(network), window_px)
    begun = None if resume is None else planning.restore(resume)
    while not planning.done and planning.advance(watch, begun):
        begun = None
    return planning.finish()


class _Planning:
    """A mural in the making: all its strokes on the sheet, which of them are finished, and how many windows are."""

    def __init__(
        self,
        mural: Mural,
        brush: Brush,
        style: Style,
        options: PlannerSettings,
        loss_options: LossOptions,
        network: Callable[[], Network],
        window_px: int,
    ) -> None:
        self._mural, self._brush, self._style, self._options = mural, brush, style, options
        self._loss_options, self._network = loss_options, network
        self._whole = mural.overview(window_px)
        self._importance = importance_of(self._whole)
        self._windows = Windows.of(mural.canvas, window_px, _margin(mural, brush, style, options))
        self._all: PlanResult | None = None
        self._finished, self._over = torch.zeros(0, dtype=torch.bool), 0

    @property
    def done(self) -> bool:
        """Whether no window is left."""
        return self._over == len(self._windows)

    def advance(self, watch: Watch, begun: State | None) -> bool:
        """Plan the whole, or else the next window, from the state where that was begun; whether to go on."""
        stage = 0 if self._all is None else self._over + 1
        wanted = True

        def watch_stage(progress: PlanProgress) -> bool:
            nonlocal wanted
            done = (stage + progress.done) / (len(self._windows) + 1)
            wanted = watch(replace(progress, done=done, state=lambda: self._state(progress.state())))
            return wanted

        if self._all is None:
            self._plan_whole(watch_stage, begun)
        else:
            self._plan_window(self._all, watch_stage, begun)
        return wanted

    def restore(self, state: State) -> State:
        """Go on from there; the state of what was begun."""
        tensors = {name: torch.from_numpy(array) for name, array in _below(_ALL, state).items()}
        if tensors:
            self._finished, self._over = tensors.pop("finished").bool(), int(state["over"])
            paints, paint_of = tensors.pop("paints"), tensors.pop("paint_of")
            self._all = PlanResult(StrokeParameters(**tensors), paints, paint_of)
        return _below(_BEGUN, state)

    def finish(self) -> PlanResult:
        """All strokes, paint by paint."""
        assert self._all is not None
        order = torch.argsort(self._all.paint_of, stable=True)
        return PlanResult(self._all.strokes[order], self._all.paints, self._all.paint_of[order])

    def _state(self, begun: State) -> State:
        """All that the next step depends on."""
        state = {_BEGUN + name: array for name, array in begun.items()}
        if self._all is None:
            return state
        numbers = {"paints": self._all.paints, "paint_of": self._all.paint_of, "finished": self._finished.byte()}
        tensors = {**self._all.strokes.each(), **numbers}
        return {**state, "over": np.array(self._over), **{_ALL + name: each.numpy() for name, each in tensors.items()}}

    def _plan_whole(self, watch: Watch, begun: State | None) -> None:
        asked = self._problem(self._whole, self._importance, self._options)
        planned = plan(asked, self._options, watch, resume=begun)
        light_first = np.argsort(-lightness(as_array(planned.paints)), kind="stable")  # as the planner sorts a palette
        paint_of = torch.from_numpy(np.argsort(light_first))[planned.paint_of]
        paints = planned.paints[torch.from_numpy(light_first)]
        self._all = PlanResult(replace(planned.strokes, colours=paints[paint_of]), paints, paint_of)
        self._finished = torch.zeros(len(paint_of), dtype=torch.bool)

    def _plan_window(self, before: PlanResult, watch: Watch, begun: State | None) -> None:
        """Plan the strokes anew that lie in the next window whole, but for those that earlier windows finished."""
        box, paints = self._windows.box(self._over), before.paints
        canvas, corner = self._mural.part(box), torch.tensor(box[:2]) / self._mural.canvas.pixels_per_metre
        trajectories = before.strokes.trajectories(self._style)
        trajectories[..., :2] -= corner
        first, last = trajectories[..., :2].amin(dim=1), trajectories[..., :2].amax(dim=1)
        size, reach = torch.tensor([canvas.width, canvas.height]), self._brush.widest
        mine = ((first > -_SLACK) & (last < size + _SLACK)).all(dim=1) & ~self._finished
        near = ((last > -reach) & (first < size + reach)).all(dim=1) & ~mine
        if mine.any():
            options = self._options_for(int(mine.sum()), paints)
            importance = enlarged(self._importance, self._mural.canvas, box)
            asked = self._problem(self._mural.window(box), importance, options)
            asked = replace(asked, neighbours=Neighbours(trajectories[near], paints[before.paint_of[near]]))
            start = before.strokes[mine]
            start = replace(start, centres=start.centres - corner)
            planned = plan(asked, options, watch, start=start, resume=begun)
            self._put(before, ~mine, planned, planned.strokes.centres + corner)
        self._over += 1

    def _options_for(self, strokes: int, paints: Tensor) -> PlannerSettings:
        """Those of the next window."""
        seed = int(np.random.SeedSequence((self._options.seed, self._over)).generate_state(1)[0])
        palette = tuple((red, green, blue) for red, green, blue in paints.tolist())
        return replace(self._options, strokes=strokes, paints=None, palette=palette, seed=seed)

    def _put(self, before: PlanResult, others: Tensor, planned: PlanResult, centres: Tensor) -> None:
        """Take what was planned, with its centres (N, 2) on the sheet, beside the other strokes that there were."""
        x, y = as_array(centres).T * self._mural.canvas.pixels_per_metre
        finished = torch.from_numpy(self._windows.owner(x, y) <= self._over)
        now = replace(planned.strokes, centres=centres, colours=before.paints[planned.paint_of])
        both = {name: torch.cat([x, getattr(now, name)]) for name, x in before.strokes[others].each().items()}
        paint_of = torch.cat([before.paint_of[others], planned.paint_of])
        self._all = PlanResult(StrokeParameters(**both), before.paints, paint_of)
        self._finished = torch.cat([self._finished[others], finished])

    def _problem(self, layout: Layout, importance: Image, options: PlannerSettings) -> PlanningProblem:
        """Of all or a part of the sheet."""
        return problem_of(layout, self._brush, self._style, options, self._loss_options, self._network, importance)


def _margin(mural: Mural, brush: Brush, style: Style, options: PlannerSettings) -> int:
    """How far from a stroke's centre the centre of the farthest may be that it touches, pixels."""
    spacing = (mural.canvas.width_px * mural.canvas.height_px / options.strokes) ** 0.5
    nowhere = np.zeros((_TRIED, 2))
    places = Places(nowhere, nowhere[:, 0], np.full(_TRIED, spacing), np.zeros((_TRIED, 3)))
    torch_rng, resolution = Generator().manual_seed(options.seed), mural.canvas.pixels_per_metre
    usual = start_strokes(places, style, brush, resolution, torch_rng)
    reaches = usual.trajectories(style)[..., :2].norm(dim=-1).amax(dim=1) + brush.widest
    return ceil(2 * torch.quantile(reaches, _NEARLY_ALL).item() * resolution)


def _below(prefix: str, state: State) -> State:
    return {name.removeprefix(prefix): array for name, array in state.items() if name.startswith(prefix)}
