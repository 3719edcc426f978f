"""Planning: gradient descent on all strokes of a painting at once (paper: Painting and Drawing Planning).

The order of the strokes is part of the plan. While colours are free it goes from light to dark; then colours become
paints, all strokes of a paint stand together, and shapes go on adapting to what now lies on top of what.
"""

from collections.abc import Callable
from math import exp

import numpy as np
import torch
from torch import Tensor

from maulstick.colour.palette import lightness, mix_paints
from maulstick.errors import InputError
from maulstick.planning.arranging import Arranging
from maulstick.planning.brush_choice import best_brushes
from maulstick.planning.descent import Descent
from maulstick.planning.initialise import Initialiser
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.problem import PlannerSettings, PlanningProblem
from maulstick.planning.result import PlanProgress, PlanResult
from maulstick.planning.room import surface_of
from maulstick.planning.schedule import GIVEN_PAINTS, Schedule
from maulstick.planning.state import State, restore_rng, rng_state
from maulstick.planning.stroke_canvas import StrokeCanvas, as_array
from maulstick.planning.stroke_effects import TargetView, coverage, recolouring_costs, removal_costs
from maulstick.planning.surrogate import Surrogate
from maulstick.rendering.threads import one_torch_thread
from maulstick.storage.arrays import Bools
from maulstick.style.lengths import keep_lengths
from maulstick.style.regional import RegionalStyle
from maulstick.style.traits import path_length

_STYLE_WEIGHT = 1e-5  # least weight of the style's cost, and the first: next to nothing beside a loss of tones
_STYLE_WEIGHT_GROWTH = 30.0  # exponent of that weight per plan while strokes cost twice what the style allows
_COST_SAMPLES = 256  # strokes, at least, whose mean cost counts as usual for the style: enough for a steady mean
_RELOCATED_SHARE = 0.1  # share of the strokes that one relocation moves: few, since each move changes the rest
_TURNING_OF_GROUPS = 0.2  # of the usual rate: strokes lie side by side already, and would turn out of their hatching
_NOTHING = 1e-6  # loss of a sheet that already shows its picture: a difference of a quarter of an 8-bit step
_HURRY_FROM = 0.75  # share of the plan that counts as over once it is to end: colours are paints from there on
_HURRY_STEPS = 60  # steps that a hurried plan takes at most: about a second of 400 strokes


@one_torch_thread()
def plan(
    problem: PlanningProblem,
    options: PlannerSettings,
    watch: Callable[[PlanProgress], bool] = lambda progress: True,
    *,
    schedule: Schedule | None = None,
    start: StrokeParameters | None = None,
    resume: State | None = None,
) -> PlanResult:
    """Plan strokes that turn the paper into what the problem asks for.

    watch: called after every step; once it returns False, colours become paints at once and the plan is finished in
    a few more steps.  start: the strokes to begin with; those that are left out are drawn from the picture.
    schedule: `Schedule()`, or for paints that are given `GIVEN_PAINTS`, when left out.
    resume: what `PlanProgress.state` returned in an earlier run of the same problem; planning goes on from there.
    Raises InputError for more strokes to start with than are planned, and a state of another plan.
    """
    if start is not None and len(start) > options.strokes:
        allowed = f"at most the {options.strokes} that are asked for"
        raise InputError.of_range("the number of strokes to start with", len(start), allowed)
    schedule = schedule or (Schedule() if options.paints is not None or options.one_ink else GIVEN_PAINTS)
    planning = _Planning(problem, options, schedule, start)
    if resume is not None:
        try:
            planning.restore(resume)
        except (KeyError, ValueError, RuntimeError) as error:
            raise InputError("what there is to go on from is no plan of the same request; plan anew") from error
    while not planning.done:
        if not watch(planning.advance()):
            planning.hurry()
    return planning.finish()


class _Planning:
    """A plan in the making: strokes, their descent, and the next entries of the schedule."""

    def __init__(
        self, problem: PlanningProblem, options: PlannerSettings, schedule: Schedule, start: StrokeParameters | None
    ) -> None:
        self._problem, self._options, self._schedule = problem, options, schedule
        self._canvas, self._style = problem.canvas, problem.style
        self._rng = np.random.default_rng(options.seed)
        self._torch_rng = torch.Generator().manual_seed(options.seed)
        self._pool = 1
        if options.one_ink:  # greys are made of lines, which only a blurred view shows as grey
            self._pool = max(1, round(4 * problem.brushes[0].widest * self._canvas.pixels_per_metre))
        self._style_weight = _STYLE_WEIGHT
        self._spacing = (surface_of(problem.room, self._canvas) / options.strokes) ** 0.5
        arrangement = self._style.arrangement if options.one_ink and options.arrange and start is None else None
        self._initialiser = Initialiser(problem, options, arrangement, self._rng, self._torch_rng)
        self._lengths = self._style.lengths(options.strokes)  # that strokes are to have, by their ranks
        self._arranging = None
        if start is not None and len(start) < options.strokes:
            start = self._initialiser.completed(start, self._pool)
        if start is None:
            start, self._spacing = self._initialiser.first()
            if arrangement is not None:
                self._arranging = Arranging(arrangement, problem, start, self._spacing, options.arrange)
        elif self._lengths is not None:
            self._lengths = path_length(self._style.decode(start.codes)).sort().values
        usual = self._style.usual_cost(max(_COST_SAMPLES, options.strokes), torch.Generator().manual_seed(options.seed))
        self._allowed_cost = self._style.max_mean_cost * usual  # nats
        trained = {
            "codes": True,
            "centres": True,
            "angles": True,
            "pressure_knots": any(brush.pressure_matters for brush in problem.brushes),
            "colours": not options.one_ink,
            "brush_of": False,
        }
        strokes = StrokeParameters(**{k: x.clone().requires_grad_(trained[k]) for k, x in start.each().items()})
        self._stroke_canvas = StrokeCanvas(strokes, problem)
        if options.one_ink:
            self._stroke_canvas.paints = torch.tensor(options.palette)
        turning = 1.0 if self._arranging is None else _TURNING_OF_GROUPS
        self._descent = Descent(strokes, self._spacing, turning)
        self._surrogate = Surrogate(problem.network_losses, problem.paper) if problem.network_losses else None
        self._progress, self._stride = schedule.begins, (1 - schedule.begins) / options.steps
        self._steps = 0  # steps so far
        self._sorted = self._relocated = self._repainted = 0  # how many of each in the schedule are over

    @property
    def done(self) -> bool:
        """Whether no step is left."""
        return self._progress >= 1 - self._stride / 2

    def hurry(self) -> None:
        """Let the plan end after a few more steps."""
        if self._progress < _HURRY_FROM:
            self._progress = _HURRY_FROM
        self._stride = max(self._stride, (1 - self._progress) / _HURRY_STEPS)
        self._relocated = len(self._schedule.relocations)
        self._repainted = sum(share < self._progress for share in self._schedule.repaints)

    def advance(self) -> PlanProgress:
        """Do what the schedule has for now, take a step, and return the progress."""
        schedule, now = self._schedule, self._progress
        if (
            self._relocated < len(schedule.relocations)
            and schedule.relocations[self._relocated] <= now < schedule.quantise
        ):
            self._relocated += 1
            self._relocate_useless()
        if self._sorted < len(schedule.sorts) and now >= schedule.sorts[self._sorted]:
            self._sorted += 1
            self._stroke_canvas.sort()
        if now >= schedule.quantise:
            self._quantise_colours()
        if self._repainted < len(schedule.repaints) and now >= schedule.repaints[self._repainted]:
            self._repainted += 1
            self._repaint()
        loss, parts, canvas = self._step(now)
        self._progress += self._stride
        self._steps += 1
        return PlanProgress(now, loss, parts, canvas, self.state)

    def state(self) -> State:
        """Return copies of all that the next step depends on."""
        counts = (self._steps, self._sorted, self._relocated, self._repainted)
        numbers = (self._progress, self._stride, self._style_weight, *counts)
        surrogate = {} if self._surrogate is None else self._surrogate.state()
        state = {
            "progress": np.array(numbers),
            **self._stroke_canvas.state(),
            **self._descent.state(),
            **surrogate,
            **rng_state(self._rng, self._torch_rng),
        }
        return {name: array.copy() for name, array in state.items()}

    def restore(self, state: State) -> None:
        """Go on from a state that `state` returned."""
        self._progress, self._stride, self._style_weight, *counts = state["progress"].tolist()
        self._steps, self._sorted, self._relocated, self._repainted = (int(count) for count in counts)
        self._stroke_canvas.restore(state)
        if "paints" in state and self._stroke_canvas.paints is None:
            self._stroke_canvas.paints = self._paints_to_use(torch.from_numpy(state["paints"].copy()))
        self._descent.restore(state)
        if self._surrogate is not None and "slope" in state:  # there may have been no network losses before
            self._surrogate.restore(state)
        restore_rng(state, self._rng, self._torch_rng)

    def _step(self, now: float) -> tuple[float, dict[str, float], Tensor]:
        """Take a step with all strokes; return the loss before it, its parts, and the canvas.

        The style's weight grows while strokes are less likely than the style allows, and falls afterwards, so that
        strokes keep to a style alike with a broad brush or a thin pen.
        """
        strokes = self._stroke_canvas.strokes
        canvas = self._stroke_canvas.render()
        if self._surrogate is not None and self._steps % self._options.ask_every == 0:
            self._surrogate.ask(canvas, self._torch_rng)
        loss, parts = self._loss(canvas, now)
        if self._arranging is not None:
            loss = loss + self._arranging.price(strokes, self._torch_rng).to(loss.device)
        costs = self._style.cost(strokes.codes, strokes.pressure_knots)
        price = (costs * (1 + costs / self._allowed_cost)).mean()  # few strokes far off cost more
        self._descent.step(loss + self._style_weight * price.to(loss.device), now)
        excess = min(costs.mean().item() / self._allowed_cost - 1, 1.0)
        self._style_weight = max(self._style_weight * exp(_STYLE_WEIGHT_GROWTH * self._stride * excess), _STYLE_WEIGHT)
        if isinstance(self._style, RegionalStyle):
            self._style.keep_lengths(strokes.codes)
        elif self._lengths is not None:
            keep_lengths(strokes.codes, self._style, self._lengths)
        if self._problem.guides is not None and self._arranging is None:
            self._problem.guides.keep(strokes)  # arranged strokes lie in groups, which are turned whole
        self._stroke_canvas.keep_inside()
        return loss.item(), parts, canvas.detach()

    def _loss(self, canvas: Tensor, now: float) -> tuple[Tensor, dict[str, float]]:
        """Return the loss without the style, and its weighted terms by name; network losses' as last evaluated."""
        parts = {each.term.name: each.weight * each.term.loss(canvas, now) for each in self._problem.objectives}
        values = {name: part.item() for name, part in parts.items()}
        loss = sum(parts.values(), torch.zeros((), device=canvas.device))
        if self._surrogate is not None:
            loss, values = loss + self._surrogate.loss(canvas), values | self._surrogate.parts
        return loss, values

    def _view(self) -> TargetView:
        """Return how the canvas is compared with the target, or without one, with what the surrogate proposes."""
        target = self._problem.target
        if target is None:
            assert self._surrogate is not None
            target = self._surrogate.proposal
        return TargetView(target, self._problem.weights, self._pool)

    def _relocate_useless(self) -> None:
        """Move the strokes that would be missed least to where the canvas is furthest from the target.

        Of several brushes each takes the one that serves best there.
        """
        costs, view = self._removal_costs(), self._view()
        useless = torch.argsort(costs, stable=True)[: max(1, int(_RELOCATED_SHARE * len(costs)))]
        with torch.no_grad():
            density = self._initialiser.missing(view, self._stroke_canvas.render())
        left = torch.ones(len(costs), dtype=torch.bool).index_fill(0, useless, False)
        own = self._stroke_canvas.strokes[left]
        for rows, there in self._initialiser.by_pool(useless, self._stroke_canvas.strokes, density):
            if len(self._problem.brushes) == 1:
                strokes = self._initialiser.pooled(view.target, there, len(rows), self._spacing)[0]
            else:
                candidates = self._initialiser.candidates(view.target, there, len(rows), self._spacing)
                strokes = best_brushes(self._problem, view, own, candidates, self._torch_rng)
            self._descent.replace(rows, strokes)

    def _removal_costs(self) -> Tensor:
        """Return an estimate of the cost of removing each stroke, (N,), by row."""
        marks, colours = self._stroke_canvas.drawn()
        return self._stroke_canvas.by_row(
            removal_costs(self._view(), self._problem.paper, marks, colours, self._torch_rng)
        )

    def _quantise_colours(self) -> None:
        """Turn free colours into paints: mixed ones, which go on adapting, or those of the palette."""
        if self._stroke_canvas.paints is not None:
            return
        options = self._options
        if options.paints is None:
            palette = np.array(options.palette)
            paints = torch.tensor(palette[np.argsort(-lightness(palette), kind="stable")], dtype=torch.float32)
        else:
            marks, colours = self._stroke_canvas.drawn()
            shown = as_array(self._stroke_canvas.by_row(coverage(self._view(), self._problem.paper, marks, colours)))
            free, own = as_array(self._stroke_canvas.strokes.colours), self._stroke_canvas.mixes
            amounts = np.sqrt(shown.clip(min=1))
            mixed = mix_paints(free[own], amounts[own], options.paints, options.seed, options.pinned)
            paints = torch.tensor(mixed, dtype=torch.float32)
        self._stroke_canvas.quantise(self._paints_to_use(paints), self._schedule.grouped)

    @torch.no_grad()
    def _repaint(self) -> None:
        """Give strokes other paints of the palette, to as many strokes as makes the loss smaller."""
        stroke_canvas, grouped = self._stroke_canvas, self._schedule.grouped
        if stroke_canvas.paints is None or len(stroke_canvas.paints) < 2 or self._options.paints is not None:
            return
        with torch.enable_grad():
            marks, colours = stroke_canvas.drawn()
            costs = recolouring_costs(
                self._view(), self._problem.paper, marks, colours, stroke_canvas.paints, self._torch_rng
            )
        gain = -stroke_canvas.by_row(costs)
        if (allowed := stroke_canvas.allowed_paints()) is not None:
            gain = gain.masked_fill(~torch.from_numpy(allowed), -torch.inf)
        gains, better = gain.max(dim=1)
        candidates = torch.argsort(gains, descending=True, stable=True)[: int((gains > 0).sum())]
        before, was = self._loss(stroke_canvas.render(), self._progress)[0], stroke_canvas.paint_of
        while len(candidates):
            stroke_canvas.repaint(was.index_copy(0, candidates, better[candidates]), grouped)
            if self._loss(stroke_canvas.render(), self._progress)[0] < before:
                return
            candidates = candidates[: len(candidates) // 2]
        stroke_canvas.repaint(was, grouped)

    def _paints_to_use(self, paints: Tensor) -> Tensor:
        """Return the paints (k, C), which go on adapting if they are still to be mixed."""
        if self._options.paints is not None:
            pinned = torch.tensor(self._options.pinned).reshape(-1, 3)
            self._descent.add_paints(paints.requires_grad_(), (paints[:, None] == pinned[None]).all(dim=2).any(dim=1))
        return paints

    def finish(self) -> PlanResult:
        """Return the plan in painting order, without useless strokes unless the number is to be exact."""
        self._quantise_colours()
        assert self._stroke_canvas.paints is not None
        order, count = self._stroke_canvas.order_of_all, len(self._stroke_canvas.strokes)
        needed = np.ones(count, dtype=bool) if self._options.exact else self._needed()
        own = order < count
        kept = torch.from_numpy(order[own][needed[order[own]]])
        painted = np.cumsum([is_own and needed[row] for row, is_own in zip(order, own, strict=True)])
        before = np.zeros(len(order) - count, dtype=np.int64)
        before[order[~own] - count] = painted[~own]
        return PlanResult(
            self._stroke_canvas.strokes[kept],
            self._stroke_canvas.paints.detach(),
            self._stroke_canvas.paint_of[kept],
            torch.from_numpy(before),
        )

    @torch.no_grad()
    def _needed(self) -> Bools:
        """Return which strokes, (N,), to keep: the loss does not grow without the others."""
        with torch.enable_grad():
            costs = self._removal_costs().numpy()
        before, _ = self._loss(self._stroke_canvas.render(), 1.0)
        needed = np.zeros(len(costs), dtype=bool)
        if self._loss(self._stroke_canvas.render(needed), 1.0)[0].item() <= min(before.item(), _NOTHING):
            return needed  # the sheet shows the picture as it is
        candidates = np.argsort(costs, kind="stable")[: int((costs <= 0).sum())]
        while len(candidates):
            needed[:] = True
            needed[candidates] = False
            if self._loss(self._stroke_canvas.render(needed), 1.0)[0] <= before:
                return needed
            candidates = candidates[: len(candidates) // 2]
        needed[:] = True
        return needed
