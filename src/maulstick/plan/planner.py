"""Planning: gradient descent on all strokes of a painting at once (paper: Painting and Drawing Planning).

The order of the strokes is part of the plan. While colours are free it goes from light to dark; then colours become
paints, all strokes of a paint stand together, and shapes go on adapting to what now lies on top of what.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import exp

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter
from torch import Tensor

from maulstick.brush.kernels.render import composite
from maulstick.brush.traj2stroke import Marks, Traj2Stroke
from maulstick.canvas import Canvas
from maulstick.errors import InputError
from maulstick.medium import Brush
from maulstick.order import by_paint, light_to_dark
from maulstick.palette import mix_paints, nearest_paint
from maulstick.plan.descent import Descent
from maulstick.plan.objectives import Objective
from maulstick.plan.parameters import StrokeParameters
from maulstick.plan.start import detail, find_places, ink_density, start_strokes
from maulstick.plan.worth import View, coverage, removal_costs
from maulstick.style import Style
from maulstick.threads import one_torch_thread

_STYLE_WEIGHT = 1e-5
_HOLD = 30.0
_JUDGED_BY = 256
_RESPENT = 0.1
_HURRIED_FROM, _HURRIED_STEPS = 0.75, 60


@dataclass(frozen=True)
class Schedule:
    """When what happens, each as a share of all steps.

    sorts: strokes are put in order from light to dark.  respends: the strokes that would be missed least begin anew.
    snap: free colours become paints; with `grouped`, all strokes of a paint then stand together.
    """

    sorts: tuple[float, ...] = tuple(0.025 * i for i in range(24))
    respends: tuple[float, ...] = (0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5)
    snap: float = 0.6
    grouped: bool = True


@dataclass(frozen=True)
class PlanOptions:
    """How to plan.

    strokes: at most so many; exactly so many with `exact`.
    paints: how many colours to mix; None paints with one ink.  ink: its colour, sRGB in [0, 1].
    steps: of the optimiser.  seed: repeats a plan to the bit.
    """

    strokes: int = 400
    exact: bool = False
    paints: int | None = 12
    ink: tuple[float, float, float] = (0.0, 0.0, 0.0)
    steps: int = 1500
    seed: int = 0

    def __post_init__(self) -> None:
        if self.strokes < 1:
            raise InputError.of_range("the number of strokes", self.strokes, "at least 1")
        if self.paints is not None and not 1 <= self.paints <= self.strokes:
            raise InputError.of_range("the number of paints", self.paints, f"1 to the {self.strokes} strokes")
        if self.steps < 1:
            raise InputError.of_range("the number of steps", self.steps, "at least 1")
        if not all(0 <= channel <= 1 for channel in self.ink):
            raise InputError.of_range("the colour of the ink", self.ink, "sRGB in [0, 1]")
        if not 0 <= self.seed < 2**32:
            raise InputError.of_range("the seed", self.seed, "in 0 to 4294967295")


@dataclass(frozen=True)
class Commission:
    """What is to be painted, and with what.

    target, paper: (3, H, W) of the canvas' pixels, sRGB in [0, 1].  weights: (H, W), how much each place matters.
    objective: sees the canvas, and says how good it is.
    """

    target: Tensor
    paper: Tensor
    weights: Tensor
    canvas: Canvas
    brush: Brush
    style: Style
    objective: Objective


@dataclass(frozen=True)
class Progress:
    """After a step: how far planning is in [0, 1], the loss, and the canvas (C, H, W)."""

    done: float
    loss: float
    canvas: Tensor


@dataclass(frozen=True)
class Plan:
    """N strokes in painting order, the paints (k, 3) and which of them each stroke takes, (N,)."""

    strokes: StrokeParameters
    paints: Tensor
    paint_of: Tensor


@one_torch_thread()
def plan(
    commission: Commission,
    options: PlanOptions,
    watch: Callable[[Progress], bool] = lambda progress: True,
    *,
    schedule: Schedule = Schedule(),
    start: StrokeParameters | None = None,
) -> Plan:
    """Plan strokes that turn the paper into the target.

    watch: called after every step; once it returns False, colours become paints at once and the plan is finished in
    a few more steps.  start: the strokes to begin with; when left out they are drawn from the picture.
    """
    if start is not None and len(start) != options.strokes:
        raise InputError.of_range("the number of strokes to start with", len(start), f"{options.strokes}, as asked for")
    planning = _Planning(commission, options, start)
    sorts, respends = list(schedule.sorts), list(schedule.respends)
    progress, stride, wanted = 0.0, 1 / options.steps, True
    while progress < 1 - stride / 2:
        if respends and progress >= respends[0] and progress < schedule.snap:
            respends.pop(0)
            planning.respend()
        if sorts and progress >= sorts[0]:
            sorts.pop(0)
            planning.sort()
        if progress >= schedule.snap:
            planning.snap(schedule.grouped)
        if not watch(planning.step(progress, stride)) and wanted:
            wanted = False
            progress = max(progress, _HURRIED_FROM)
            stride = max(stride, (1 - progress) / _HURRIED_STEPS)
            respends.clear()
        progress += stride
    planning.snap(schedule.grouped)
    return planning.finish()


class _Planning:
    """The state of a plan in the making. Strokes keep their rows; `_order` says how they are painted."""

    def __init__(self, commission: Commission, options: PlanOptions, start: StrokeParameters | None) -> None:
        self._options = options
        self._paper, self._canvas = commission.paper, commission.canvas
        self._brush, self._style, self._objective = commission.brush, commission.style, commission.objective
        self._image, self._weights = _array(commission.target), _array(commission.weights)
        self._rng = np.random.default_rng(options.seed)
        self._chance = torch.Generator().manual_seed(options.seed)
        self._brushes = Traj2Stroke.of([self._brush] * options.strokes)
        self._order = np.arange(options.strokes)
        self._paints: Tensor | None = None
        self._paint_of = torch.zeros(options.strokes, dtype=torch.long)
        pool = 1
        if options.paints is None:  # greys are made of lines, and only seen from further off
            self._paints = torch.tensor([options.ink])
            pool = max(1, round(4 * self._brush.widest * self._canvas.pixels_per_metre))
        self._view = View(commission.target, commission.weights, pool)
        self._style_weight = _STYLE_WEIGHT
        self._allowed_cost = self._style.leeway * self._usual_cost()
        self._spacing = (self._canvas.width * self._canvas.height / options.strokes) ** 0.5
        if start is None:
            start, self._spacing = self._begin(self._blank_paper_density(), options.strokes)
        trained = {
            "codes": True,
            "centres": True,
            "angles": True,
            "press_knots": self._brush.presses,
            "colours": self._paints is None,
        }
        strokes = StrokeParameters(**{k: x.clone().requires_grad_(trained[k]) for k, x in start.each().items()})
        self._descent = Descent(strokes, self._spacing)

    @property
    def _strokes(self) -> StrokeParameters:
        return self._descent.strokes

    def _usual_cost(self) -> float:
        """Of as many strokes as are planned, when the style draws them by itself."""
        chance, count = torch.Generator().manual_seed(self._options.seed), self._options.strokes
        groups = [self._style.sample(count, chance) for _ in range(max(1, _JUDGED_BY // count))]
        return float(torch.stack([self._style.cost(*group).mean() for group in groups]).mean())

    def _blank_paper_density(self) -> NDArray[np.float64]:
        """Where strokes belong on the empty sheet, (H, W); nowhere that the target is paper."""
        paper = _array(self._paper)
        if self._paints is not None:
            return ink_density(self._image, paper, np.array(self._options.ink))
        differs = np.abs(self._image - paper).max(axis=0) > 2 / 255
        return detail(self._image) * gaussian_filter(differs.astype(np.float64), 1) * self._weights

    def _begin(self, density: NDArray[np.float64], count: int, room: float = np.inf) -> tuple[StrokeParameters, float]:
        """New strokes where the density asks, and the median of their spacing, metres; none takes more than `room`."""
        places = find_places(self._image, density, count, self._rng, room * self._canvas.pixels_per_metre)
        strokes = start_strokes(places, self._style, self._brush, self._canvas.pixels_per_metre, self._chance)
        return strokes, float(np.median(places.spacing)) / self._canvas.pixels_per_metre

    def _colours(self) -> Tensor:
        return self._strokes.colours if self._paints is None else self._paints[self._paint_of]

    def _drawn(self) -> tuple[Marks, Tensor]:
        """Marks and colours in painting order."""
        trajectories = self._strokes.trajectories(self._style)[self._order]
        return self._brushes.marks(trajectories, self._canvas.pixels_per_metre), self._colours()[self._order]

    def _render(self, wanted: NDArray[np.bool_] | None = None) -> Tensor:
        """The canvas (C, H, W) with all strokes, or with those `wanted`, (N,), alone."""
        marks, colours = self._drawn()
        shown = slice(None) if wanted is None else torch.from_numpy(np.flatnonzero(wanted[self._order]))
        points, thickness, colours = marks.points[shown], marks.thickness[shown], colours[shown]
        return composite(self._paper, points, thickness, colours, marks.c[shown], marks.q[shown], marks.o[shown])

    def step(self, progress: float, stride: float) -> Progress:
        """One step of all strokes, of size `stride` in progress.

        The style weighs more as long as the strokes are less likely than it allows, and less afterwards: it is held
        alike with a broad brush or a thin pen.
        """
        canvas = self._render()
        loss = self._objective.loss(canvas, progress)
        costs = self._style.cost(self._strokes.codes, self._strokes.press_knots)
        price = (costs * (1 + costs / self._allowed_cost)).mean()  # few that go far pay more than many that go a little
        self._descent.step(loss + self._style_weight * price, progress)
        excess = min(costs.mean().item() / self._allowed_cost - 1, 1.0)
        self._style_weight = max(self._style_weight * exp(_HOLD * stride * excess), _STYLE_WEIGHT)
        self._strokes.keep_inside(self._style, self._canvas.width, self._canvas.height)
        return Progress(progress, loss.item(), canvas.detach())

    def sort(self) -> None:
        """Light to dark, while colours are free."""
        if self._paints is None:
            self._order = light_to_dark(_array(self._strokes.colours))

    def respend(self) -> None:
        """Move the strokes that would be missed least to where the picture is furthest from the target."""
        costs = self._removal_costs()
        count = max(1, int(_RESPENT * len(costs)))
        rows = torch.argsort(costs, stable=True)[:count]
        canvas = _array(self._render())
        blur = self._image.shape[1] / 100
        if self._paints is not None:
            density = ink_density(self._image, _array(self._paper), np.array(self._options.ink))
            density -= ink_density(canvas, _array(self._paper), np.array(self._options.ink))
            density = gaussian_filter(density, blur + self._view.pool).clip(min=0)
        else:
            density = np.sum([gaussian_filter(x, blur) ** 2 for x in canvas - self._image], axis=0)
        self._descent.replace(rows, self._begin(density * self._weights, count, room=self._spacing)[0])

    def _removal_costs(self) -> Tensor:
        marks, colours = self._drawn()
        costs = removal_costs(self._view, self._paper, marks, colours, self._chance)
        by_row = torch.empty_like(costs)
        by_row[self._order] = costs
        return by_row

    def snap(self, grouped: bool) -> None:
        """Turn free colours into paints, and if they are to be grouped, paint the lightest first."""
        if self._paints is not None or self._options.paints is None:
            return
        marks, colours = self._drawn()
        shown = np.empty(len(self._order))
        shown[self._order] = coverage(self._view, self._paper, marks, colours).numpy()
        free = _array(self._strokes.colours)
        paints = mix_paints(free, np.sqrt(shown.clip(min=1)), self._options.paints, self._options.seed)
        self._paint_of = torch.from_numpy(nearest_paint(free, paints))
        if grouped:
            self._order = by_paint(self._paint_of.numpy(), self._order)
        self._paints = torch.tensor(paints, dtype=torch.float32, requires_grad=True)
        self._descent.add_paints(self._paints)

    def finish(self) -> Plan:
        """The plan in painting order, without the strokes that do nothing unless their number is to be exact."""
        assert self._paints is not None
        kept = self._order if self._options.exact else self._order[self._needed()[self._order]]
        rows = torch.from_numpy(kept)
        return Plan(self._strokes[rows], self._paints.detach(), self._paint_of[rows])

    def _needed(self) -> NDArray[np.bool_]:
        """Which strokes (N,) to keep: without the others together the loss does not grow."""
        costs = self._removal_costs().numpy()
        candidates = np.argsort(costs, kind="stable")[: int((costs <= 0).sum())]
        before = self._objective.loss(self._render(), 1.0)
        needed = np.ones(len(self._order), dtype=bool)
        while len(candidates):
            needed[:] = True
            needed[candidates] = False
            if self._objective.loss(self._render(needed), 1.0) <= before:
                return needed
            candidates = candidates[: len(candidates) // 2]
        needed[:] = True
        return needed


def _array(tensor: Tensor) -> NDArray[np.float64]:
    return tensor.detach().numpy().astype(np.float64)
