"""Plans of pictures too large for one piece: window by window, in memory that the window and the strokes bound.

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
from maulstick.ordering.layers import by_paint
from maulstick.painting.brush import Brush
from maulstick.planning.features.efficientnet import EfficientNetLite0
from maulstick.planning.features.network import Network
from maulstick.planning.from_picture import importance_of, problem_of
from maulstick.planning.layout import Layout
from maulstick.planning.losses import LossOptions
from maulstick.planning.mural.windows import Mural, Windows, enlarged
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.placement import Places, start_strokes
from maulstick.planning.planner import plan
from maulstick.planning.problem import Neighbours, PlannerSettings, PlanningProblem
from maulstick.planning.result import PlanProgress, PlanResult
from maulstick.planning.state import State
from maulstick.planning.stroke_canvas import as_array
from maulstick.planning.tones import Tones
from maulstick.storage.arrays import Image
from maulstick.style import Style

_DEFAULT_LOSSES = LossOptions()
_CPU = torch.device("cpu")
_REACH_SAMPLES = 256  # strokes of the style whose reach sets the margin of windows: enough for its quantile
_REACH_QUANTILE = 0.95  # of these strokes, the margin holds so many: the few longest would widen every window
_SLACK = 1e-6  # metres: rounding by which a stroke that was kept inside a sheet may end beyond its edge
_ALL, _CURRENT = "all.", "current."  # prefixes in a state: all strokes of the mural, and the plan of the present window

Watch = Callable[[PlanProgress], bool]


def plan_mural(
    mural: Mural,
    brushes: tuple[Brush, ...],
    style: Style,
    options: PlannerSettings,
    watch: Watch = lambda progress: True,
    *,
    loss_options: LossOptions = _DEFAULT_LOSSES,
    network: Callable[[], Network] = EfficientNetLite0,
    window_px: int = 1024,
    resume: State | None = None,
    device: torch.device = _CPU,
    tones: Tones | None = None,
) -> PlanResult:
    """Plan a mural in windows whose cores have at most `window_px` per side, as has the small image of the whole.

    The steps of the options are taken in each window, and in the whole.
    watch: called after every step with the progress of the present window; once it returns False, this window ends
    after a few more steps, and later windows stay as they were planned in the whole.
    resume: what `PlanProgress.state` returned in an earlier run of the same mural; planning goes on from there.
    device: renders, and compares with the picture.  tones: those of one ink that the whole is planned in, if any.
    Raises InputError for a text, since every window would be made to show it, and for a side below one pixel.
    """
    if "text" in loss_options.weights_of_terms(has_picture=True):
        raise InputError("a text is about a whole picture, and a mural is planned in windows; leave the text out")
    if window_px < 1:
        raise InputError.of_range("the side of a window", f"{window_px} pixels", "at least 1")
    planning = _Planning(mural, brushes, style, options, loss_options, cache(network), window_px, device, tones)
    current = None if resume is None else planning.restore(resume)
    while not planning.done and planning.advance(watch, current):
        current = None
    return planning.finish()


class _Planning:
    """A mural in the making: all strokes on the sheet, which of them are finished, and how many windows are done."""

    def __init__(
        self,
        mural: Mural,
        brushes: tuple[Brush, ...],
        style: Style,
        options: PlannerSettings,
        loss_options: LossOptions,
        network: Callable[[], Network],
        window_px: int,
        device: torch.device,
        tones: Tones | None,
    ) -> None:
        self._mural, self._brushes, self._style, self._options = mural, brushes, style, options
        self._loss_options, self._network, self._device, self._tones = loss_options, network, device, tones
        self._whole = mural.overview(window_px)
        self._importance = importance_of(self._whole, loss_options.faces)
        self._windows = Windows.of(mural.canvas, window_px, _margin(mural, brushes, style, options))
        self._all: PlanResult | None = None
        self._finished, self._windows_done = torch.zeros(0, dtype=torch.bool), 0

    @property
    def done(self) -> bool:
        """Whether no window is left."""
        return self._windows_done == len(self._windows)

    def advance(self, watch: Watch, current: State | None) -> bool:
        """Plan the whole, or else the next window, from its current state if there is one; return whether to go on."""
        stage = 0 if self._all is None else self._windows_done + 1
        wanted = True

        def watch_stage(progress: PlanProgress) -> bool:
            nonlocal wanted
            done = (stage + progress.done) / (len(self._windows) + 1)
            wanted = watch(replace(progress, done=done, state=lambda: self._state(progress.state())))
            return wanted

        if self._all is None:
            self._plan_whole(watch_stage, current)
        else:
            self._plan_window(self._all, watch_stage, current)
        return wanted

    def restore(self, state: State) -> State:
        """Go on from a state; return that of the present window's plan."""
        tensors = {name: torch.from_numpy(array) for name, array in _below(_ALL, state).items()}
        if tensors:
            self._finished, self._windows_done = tensors.pop("finished").bool(), int(state["windows_done"])
            paints, paint_of = tensors.pop("paints"), tensors.pop("paint_of")
            self._all = PlanResult(StrokeParameters(**tensors), paints, paint_of)
        return _below(_CURRENT, state)

    def finish(self) -> PlanResult:
        """Return all strokes, brush by brush and paint by paint."""
        assert self._all is not None
        paint_of, brush_of = self._all.paint_of.numpy(), self._all.strokes.brush_of.numpy()
        order = torch.from_numpy(by_paint(paint_of, brush_of, np.arange(len(paint_of))))
        return PlanResult(self._all.strokes[order], self._all.paints, self._all.paint_of[order])

    def _state(self, current: State) -> State:
        """Return all that the next step depends on; `current` is the state of the present window's plan."""
        state = {_CURRENT + name: array for name, array in current.items()}
        if self._all is None:
            return state
        numbers = {"paints": self._all.paints, "paint_of": self._all.paint_of, "finished": self._finished.byte()}
        tensors = {**self._all.strokes.each(), **numbers}
        return {
            **state,
            "windows_done": np.array(self._windows_done),
            **{_ALL + name: each.numpy() for name, each in tensors.items()},
        }

    def _plan_whole(self, watch: Watch, current: State | None) -> None:
        problem = self._problem(self._whole, self._importance, self._options)
        planned = plan(problem, self._options, watch, resume=current)
        light_first = np.argsort(-lightness(as_array(planned.paints)), kind="stable")  # as the planner sorts a palette
        paint_of = torch.from_numpy(np.argsort(light_first))[planned.paint_of]
        paints = planned.paints[torch.from_numpy(light_first)]
        self._all = PlanResult(replace(planned.strokes, colours=paints[paint_of]), paints, paint_of)
        self._finished = torch.zeros(len(paint_of), dtype=torch.bool)

    def _plan_window(self, before: PlanResult, watch: Watch, current: State | None) -> None:
        """Plan again the strokes that lie entirely in the next window, but for those that earlier windows finished."""
        box, paints = self._windows.box(self._windows_done), before.paints
        canvas, corner = self._mural.part(box), torch.tensor(box[:2]) / self._mural.canvas.pixels_per_metre
        trajectories = before.strokes.trajectories(self._style)
        trajectories[..., :2] -= corner
        first, last = trajectories[..., :2].amin(dim=1), trajectories[..., :2].amax(dim=1)
        size, reach = torch.tensor([canvas.width, canvas.height]), _widest(self._brushes)
        mine = ((first > -_SLACK) & (last < size + _SLACK)).all(dim=1) & ~self._finished
        near = ((last > -reach) & (first < size + reach)).all(dim=1) & ~mine
        if mine.any():
            options = self._options_for(int(mine.sum()), paints)
            importance = enlarged(self._importance, self._mural.canvas, box)
            problem = self._problem(self._mural.window(box), importance, options)
            neighbours = Neighbours(trajectories[near], paints[before.paint_of[near]], before.strokes.brush_of[near])
            problem = replace(problem, neighbours=neighbours)
            start = before.strokes[mine]
            start = replace(start, centres=start.centres - corner)
            planned = plan(problem, options, watch, start=start, resume=current)
            self._put(before, ~mine, planned, planned.strokes.centres + corner)
        self._windows_done += 1

    def _options_for(self, strokes: int, paints: Tensor) -> PlannerSettings:
        """Return the settings of the next window, for so many strokes in the given paints (k, 3)."""
        seed = int(np.random.SeedSequence((self._options.seed, self._windows_done)).generate_state(1)[0])
        palette = tuple((red, green, blue) for red, green, blue in paints.tolist())
        return replace(self._options, strokes=strokes, paints=None, palette=palette, seed=seed)

    def _put(self, before: PlanResult, others: Tensor, planned: PlanResult, centres: Tensor) -> None:
        """Keep the `others` of the strokes before, and add those planned, with their centres (N, 2) on the sheet."""
        x, y = as_array(centres).T * self._mural.canvas.pixels_per_metre
        finished = torch.from_numpy(self._windows.owner(x, y) <= self._windows_done)
        now = replace(planned.strokes, centres=centres, colours=before.paints[planned.paint_of])
        both = {name: torch.cat([x, getattr(now, name)]) for name, x in before.strokes[others].each().items()}
        paint_of = torch.cat([before.paint_of[others], planned.paint_of])
        self._all = PlanResult(StrokeParameters(**both), before.paints, paint_of)
        self._finished = torch.cat([self._finished[others], finished])

    def _problem(self, layout: Layout, importance: Image, options: PlannerSettings) -> PlanningProblem:
        """Return the planning problem of a layout of all or a part of the sheet."""
        return problem_of(
            layout,
            self._brushes,
            self._style,
            options,
            self._loss_options,
            self._network,
            importance,
            self._device,
            self._tones,
        )


def _margin(mural: Mural, brushes: tuple[Brush, ...], style: Style, options: PlannerSettings) -> int:
    """Return the largest usual distance in pixels between the centres of two strokes that touch."""
    spacing = (mural.canvas.width_px * mural.canvas.height_px / options.strokes) ** 0.5
    origin = np.zeros((_REACH_SAMPLES, 2))
    places = Places(origin, origin[:, 0], np.full(_REACH_SAMPLES, spacing), np.zeros((_REACH_SAMPLES, 3)))
    torch_rng, resolution = Generator().manual_seed(options.seed), mural.canvas.pixels_per_metre
    usual = start_strokes(places, style, brushes[0], resolution, torch_rng)
    reaches = usual.trajectories(style)[..., :2].norm(dim=-1).amax(dim=1) + _widest(brushes)
    return ceil(2 * torch.quantile(reaches, _REACH_QUANTILE).item() * resolution)


def _widest(brushes: tuple[Brush, ...]) -> float:
    return max(brush.widest for brush in brushes)


def _below(prefix: str, state: State) -> State:
    """Return the part of a state whose names begin with the prefix, without it."""
    return {name.removeprefix(prefix): array for name, array in state.items() if name.startswith(prefix)}
