"""Plans of pictures too large for one piece: window by window, in memory that the windows and the strokes bound.

All strokes are first planned together on a small image of the whole: how many go where, and their paints, are settled
there. Then each window is planned at full resolution with a margin around it. Strokes whose centres end up in its core
are finished; those in the margin are planned again, and better, with the window whose core they lie in. What a window
does not plan is painted in its place among what it does, but stays as it is. So every stroke is planned with all that
it touches, and the order, paint by paint, is the same in all windows.

Windows are planned in rounds. Those of one round lie apart and all begin from the same strokes, so no one needs another
and any number can be planned at the same time; their strokes are put together in the order of the windows. So the plan
is the same to the bit, whoever plans which window and when.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from math import ceil

import numpy as np
import torch
from torch import Generator, Tensor

from maulstick.colour.palette import light_first
from maulstick.errors import InputError
from maulstick.ordering.layers import by_paint
from maulstick.painting.brush import Brush
from maulstick.planning.features.efficientnet import EfficientNetLite0
from maulstick.planning.features.network import LoadedOnce, Network
from maulstick.planning.from_picture import importance_of
from maulstick.planning.losses import LossOptions
from maulstick.planning.mural.progress import MuralProgress
from maulstick.planning.mural.window import PlanWindows, Watch, Window, WindowPlanner, in_turn
from maulstick.planning.mural.windows import Box, Mural, Windows, enlarged
from maulstick.planning.parameters import joined
from maulstick.planning.placement import Places, start_strokes
from maulstick.planning.planner import plan
from maulstick.planning.problem import Neighbours, PlannerSettings
from maulstick.planning.result import PlanResult
from maulstick.planning.state import State
from maulstick.planning.stroke_canvas import as_array
from maulstick.planning.tones import Tones
from maulstick.style import Style

_DEFAULT_LOSSES = LossOptions()
_CPU = torch.device("cpu")
_REACH_SAMPLES = 256  # strokes of the style whose reach sets the margin of windows: enough for its quantile
_REACH_QUANTILE = 0.95  # of these strokes, the margin holds so many: the few longest would widen every window
_LARGEST_WINDOW = 8192**2  # pixels, margins among them: an image of so many is 0.8 GB, and planning has several
_SLACK = 1e-6  # metres: rounding by which a stroke that was kept inside a sheet may end beyond its edge


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
    plan_windows: PlanWindows = in_turn,
) -> PlanResult:
    """Plan a mural in windows whose cores have at most `window_px` per side, as has the small image of the whole.

    The steps of the options are taken in each window, and in the whole.
    watch: called with the progress of the whole, or of a window, after every step, or now and then where windows are
    planned at the same time; once it returns False, what is in work ends after a few more steps, and later windows
    stay as they were planned in the whole.
    resume: what `PlanProgress.state` returned in an earlier run of the same mural; planning goes on from there.
    device: renders, and compares with the picture.  tones: those of inks that the whole is planned in, if any.
    plan_windows: plans the windows of a round; the result does not depend on how.
    Raises InputError for a text, since every window would be made to show it, for a side below one pixel, for strokes
    that reach so far that a window would be too large, and for a state of another plan.
    """
    if "text" in loss_options.weights_of_terms(has_picture=True):
        raise InputError("a text is about a whole picture, and a mural is planned in windows; leave the text out")
    if window_px < 1:
        raise InputError.of_range("the side of a window", f"{window_px} pixels", "at least 1")
    planner = WindowPlanner(brushes, style, loss_options, LoadedOnce(network), device, tones)
    planning = _Planning(mural, planner, options, window_px, watch, resume)
    planning.plan_whole()
    for windows in planning.rounds:
        planning.plan_round(windows, plan_windows)
    return planning.finish()


class _Planning:
    """A mural in the making."""

    def __init__(
        self,
        mural: Mural,
        planner: WindowPlanner,
        options: PlannerSettings,
        window_px: int,
        watch: Watch,
        resume: State | None,
    ) -> None:
        self._mural, self._planner, self._options = mural, planner, options
        self._whole = mural.overview(window_px)
        self._importance = importance_of(self._whole, planner.loss_options.faces)
        self._windows = Windows.of(mural.canvas, window_px, _margin(mural, planner, options))
        if (largest := self._windows.largest) > _LARGEST_WINDOW:
            raise InputError(
                f"strokes of this mural reach so far that a window would have {largest / 1e6:,.0f} million pixels, and "
                f"at most {_LARGEST_WINDOW / 1e6:.0f} are planned at once; take more strokes, fewer pixels, or a "
                "smaller hand"
            )
        self._progress = MuralProgress(len(self._windows), watch, resume)
        self.rounds = self._windows.rounds()

    def plan_whole(self) -> None:
        """Plan all strokes together on the small image of the whole, unless they are."""
        if self._progress.all is not None:
            return
        problem = self._planner.problem(self._whole, self._importance, self._options)
        planned = plan(problem, self._options, self._progress.watch_whole, resume=self._progress.state_of_whole())
        order = light_first(as_array(planned.paints))  # as the planner sorts a palette
        paint_of = torch.from_numpy(np.argsort(order))[planned.paint_of]
        paints = planned.paints[torch.from_numpy(order)]
        self._progress.begin(PlanResult(replace(planned.strokes, colours=paints[paint_of]), paints, paint_of))

    def plan_round(self, windows: list[int], plan_windows: PlanWindows) -> None:
        """Plan again the strokes that lie entirely in a window, for each that is left of a round."""
        progress = self._progress
        left = [index for index in windows if index not in progress.done]
        if not left or not progress.wanted:
            return
        before = _Snapshot(progress, self._planner, self._mural)
        tasks = self._windows_of(before, [index for index in left if index not in progress.planned])
        for index, planned in plan_windows(self._planner, tasks, progress.watch_window):
            centres = planned.strokes.centres + before.corner(self._windows.box(index))
            strokes = replace(planned.strokes, centres=centres, colours=before.all.paints[planned.paint_of])
            progress.keep(index, PlanResult(strokes, before.all.paints, planned.paint_of))
        self._put_together(before, left)

    def _windows_of(self, before: "_Snapshot", indices: list[int]) -> Iterator[Window]:
        """Make the windows of these indices, each when it is asked for, as long as planning is to go on."""
        for index in indices:
            box, progress = self._windows.box(index), self._progress
            rows = before.rows_within(box)
            if progress.wanted and len(rows):
                start, corner = before.all.strokes[rows], before.corner(box)
                yield Window(
                    index,
                    self._mural.window(box),
                    enlarged(self._importance, self._mural.canvas, box),
                    self._settings_for(index, len(rows), before.all.paints),
                    replace(start, centres=start.centres - corner),
                    before.neighbours(box),
                    progress.state_of_window(index),
                )

    def _settings_for(self, index: int, strokes: int, paints: Tensor) -> PlannerSettings:
        """Return the settings of a window, for so many strokes in the given paints (k, 3)."""
        seed = int(np.random.SeedSequence((self._options.seed, index)).generate_state(1)[0])
        palette = tuple((red, green, blue) for red, green, blue in paints.tolist())
        settled = replace(self._options, paints=None, palette=palette, pinned=(), in_colours=not self._options.in_ink)
        return replace(settled, strokes=strokes, seed=seed)

    def _put_together(self, before: "_Snapshot", windows: list[int]) -> None:
        """End a round: put the strokes of its windows, in their order, behind those that no window planned."""
        planned = sorted(self._progress.planned.items())
        others = torch.ones(len(before.all.paint_of), dtype=torch.bool)
        for index, _ in planned:
            others[before.rows_within(self._windows.box(index))] = False
        strokes = joined([before.all.strokes[others], *(each.strokes for _, each in planned)])
        paint_of = torch.cat([before.all.paint_of[others], *(each.paint_of for _, each in planned)])
        done = self._progress.done | set(windows)
        x, y = as_array(strokes.centres).T * self._mural.canvas.pixels_per_metre
        in_cores = torch.from_numpy(np.isin(self._windows.owner(x, y), list(done)))
        finished = torch.cat([before.finished[others], in_cores[int(others.sum()) :]])
        self._progress.end_round(PlanResult(strokes, before.all.paints, paint_of), finished, done)

    def finish(self) -> PlanResult:
        """Return all strokes, brush by brush and paint by paint."""
        planned = self._progress.all
        assert planned is not None
        paint_of, brush_of = planned.paint_of.numpy(), planned.strokes.brush_of.numpy()
        order = torch.from_numpy(by_paint(paint_of, brush_of, np.arange(len(paint_of))))
        return PlanResult(planned.strokes[order], planned.paints, planned.paint_of[order])


class _Snapshot:
    """All strokes as they are when a round begins."""

    def __init__(self, progress: MuralProgress, planner: WindowPlanner, mural: Mural) -> None:
        assert progress.all is not None
        self.all, self.finished = progress.all, progress.finished
        self._mural, self._reach = mural, _widest(planner.brushes)
        self._trajectories = self.all.strokes.trajectories(planner.style)
        path = self._trajectories[..., :2]
        self._first, self._last = path.amin(dim=1), path.amax(dim=1)

    def corner(self, box: Box) -> Tensor:
        """Return where the upper left corner of a box lies on the sheet, (2,) metres."""
        return torch.tensor(box[:2]) / self._mural.canvas.pixels_per_metre

    def rows_within(self, box: Box) -> Tensor:
        """Return the rows of the strokes that lie entirely in a box, but for those that are finished."""
        return self._is_planned_in(box).nonzero()[:, 0]

    def neighbours(self, box: Box) -> Neighbours:
        """Return the other strokes that may reach into a box, on its canvas."""
        first, last, size = self._on(box)
        near = ((last > -self._reach) & (first < size + self._reach)).all(dim=1) & ~self._is_planned_in(box)
        trajectories = self._trajectories[near]
        trajectories[..., :2] -= self.corner(box)
        return Neighbours(trajectories, self.all.paints[self.all.paint_of[near]], self.all.strokes.brush_of[near])

    def _is_planned_in(self, box: Box) -> Tensor:
        first, last, size = self._on(box)
        return ((first > -_SLACK) & (last < size + _SLACK)).all(dim=1) & ~self.finished

    def _on(self, box: Box) -> tuple[Tensor, Tensor, Tensor]:
        """Return the upper left and lower right ends of strokes, (N, 2), on a box's canvas, and its size, (2,)."""
        canvas, corner = self._mural.part(box), self.corner(box)
        return self._first - corner, self._last - corner, torch.tensor([canvas.width, canvas.height])


def _margin(mural: Mural, planner: WindowPlanner, options: PlannerSettings) -> int:
    """Return the largest usual distance in pixels between the centres of two strokes that touch."""
    spacing = (mural.canvas.width_px * mural.canvas.height_px / options.strokes) ** 0.5
    origin = np.zeros((_REACH_SAMPLES, 2))
    places = Places(origin, origin[:, 0], np.full(_REACH_SAMPLES, spacing), np.zeros((_REACH_SAMPLES, 3)))
    torch_rng, resolution = Generator().manual_seed(options.seed), mural.canvas.pixels_per_metre
    usual = start_strokes(places, planner.style, planner.brushes[0], resolution, torch_rng)
    reaches = usual.trajectories(planner.style)[..., :2].norm(dim=-1).amax(dim=1) + _widest(planner.brushes)
    return ceil(2 * torch.quantile(reaches, _REACH_QUANTILE).item() * resolution)


def _widest(brushes: tuple[Brush, ...]) -> float:
    return max(brush.widest for brush in brushes)
