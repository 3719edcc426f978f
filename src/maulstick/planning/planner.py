"""Planning: gradient descent on all strokes of a painting at once (paper: Painting and Drawing Planning).

The order of the strokes is part of the plan. While colours are free it goes from light to dark; then colours become
paints, all strokes of a paint stand together, and shapes go on adapting to what now lies on top of what.
"""

from collections.abc import Callable

import numpy as np
import torch
from torch import Tensor

from maulstick.errors import InputError
from maulstick.planning.arranging import Arranging
from maulstick.planning.brush_choice import best_brushes
from maulstick.planning.canvas_loss import CanvasLoss
from maulstick.planning.descent import Descent
from maulstick.planning.drawn_pixels import coarsest, finest, to_drawn
from maulstick.planning.improvements import mix_colours, needed, repaint, thinned
from maulstick.planning.initialise import Initialiser
from maulstick.planning.lights import across_lights
from maulstick.planning.memory import keep_freed_memory
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.problem import PlannerSettings, PlanningProblem
from maulstick.planning.result import PlanProgress, PlanResult
from maulstick.planning.schedule import GIVEN_PAINTS, IN_INK, Schedule
from maulstick.planning.state import State, restore_rng, rng_state
from maulstick.planning.stroke_canvas import StrokeCanvas, as_array
from maulstick.planning.stroke_effects import recolouring_costs, removal_costs
from maulstick.planning.style_price import StylePrice
from maulstick.rendering.threads import one_torch_thread
from maulstick.storage.arrays import Bools
from maulstick.style.lengths import keep_lengths
from maulstick.style.regional import RegionalStyle
from maulstick.style.traits import path_length

_RELOCATED_SHARE = 0.1  # share of the strokes that one relocation moves: few, since each move changes the rest
_TURNING_OF_GROUPS = 0.2  # of the usual rate: strokes lie side by side already, and would turn out of their hatching
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
    a few more steps.  start: the strokes to begin with; too few are completed from the picture, and of too
    many those that would be missed least are left out.
    schedule: `Schedule()`, for inks `IN_INK`, or for paints that are given `GIVEN_PAINTS`, when left out.
    resume: what `PlanProgress.state` returned in an earlier run of the same problem; planning goes on from there.
    Raises InputError for a state of another plan.
    """
    keep_freed_memory()
    in_paints = Schedule() if options.paints is not None else GIVEN_PAINTS
    schedule = schedule or (IN_INK if options.in_ink else in_paints)
    if resume is None:
        planning = _Planning(problem, options, schedule, start)
    else:
        try:
            planning = _Planning(problem, options, schedule, start, resume)
            planning.restore(resume)
        except (KeyError, ValueError, RuntimeError) as error:
            raise InputError("what there is to go on from is no plan of the same request; plan anew") from error
    while not planning.done:
        if not watch(planning.advance()):
            planning.hurry()
    return planning.finish()


class _Planning:
    """A plan in the making: strokes, their descent, and the next entries of the schedule.

    resume: of a state that `restore` puts back, so that no strokes are looked for where none are needed.
    """

    def __init__(
        self,
        problem: PlanningProblem,
        options: PlannerSettings,
        schedule: Schedule,
        start: StrokeParameters | None,
        resume: State | None = None,
    ) -> None:
        self._problem, self._options, self._schedule = problem, options, schedule
        self._canvas, self._style = problem.canvas, problem.style
        self._rng = np.random.default_rng(options.seed)
        self._torch_rng = torch.Generator().manual_seed(options.seed)
        self._loss = CanvasLoss(problem, options)
        hands = self._style.hands if isinstance(self._style, RegionalStyle) else (self._style,)
        known = any(hand.arrangement is not None for hand in hands)
        arranged = options.in_ink and options.arrange > 0 and known
        self._initialiser = Initialiser(problem, options, arranged, self._rng, self._torch_rng)
        self._spacing = self._initialiser.usual_spacing
        self._lengths = self._style.lengths(options.strokes)  # that strokes are to have, by their ranks
        if start is not None and len(start) < options.strokes:
            start = self._initialiser.completed(start, self._loss.pool)
        elif start is not None and len(start) > options.strokes:
            start = thinned(start, options.strokes, problem, self._loss, self._torch_rng)
        self._style_price = StylePrice(self._style, options.strokes, options.seed, start)
        kept = {"spacing", "densities"} if arranged else {"spacing"}  # older files have none
        if start is None and resume is not None and kept <= resume.keys():
            start, self._spacing = StrokeParameters.in_state(resume), resume["spacing"].item()
            if len(start) != options.strokes:
                raise ValueError("the state has another number of strokes")
        elif start is None:
            start, self._spacing = self._initialiser.first()
        elif self._lengths is not None:
            self._lengths = path_length(self._style.decode(start.codes)).sort().values
        trained = {
            "codes": True,
            "centres": True,
            "angles": True,
            "pressure_knots": any(brush.pressure_matters for brush in problem.brushes),
            "colours": not options.in_ink,
            "brush_of": False,
        }
        strokes = StrokeParameters(**{k: x.clone().requires_grad_(trained[k]) for k, x in start.each().items()})
        self._stroke_canvas = StrokeCanvas(strokes, problem, in_groups=arranged)
        if options.in_ink:
            self._stroke_canvas.quantise(torch.tensor(self._initialiser.palette), schedule.grouped)
        self._arranging = None
        if arranged:
            densities = None if resume is None else resume.get("densities")
            paint_of, share = self._stroke_canvas.paint_of, options.arrange
            self._arranging = Arranging(problem, start, paint_of, self._spacing, share, densities)
        self._coarsest = coarsest(problem, options, self._spacing)
        self._finest = 1.0  # side of the pixels that the last steps are drawn on, in the canvas' own
        turning = _TURNING_OF_GROUPS if arranged else 1.0
        lightest = torch.tensor([brush.lightest for brush in problem.brushes])
        self._descent = Descent(strokes, self._spacing, lightest, turning)
        self._progress = schedule.begins
        self._stride = self._usual_stride = (1 - schedule.begins) / options.steps
        self._steps = 0  # steps so far
        self._sorted = self._relocated = self._repainted = 0  # how many of each in the schedule are over

    @property
    def done(self) -> bool:
        """Whether no step is left."""
        return self._progress >= 1 - self._stride / 2

    @property
    def _side(self) -> int:
        """Pixels, each way, of the squares that are drawn as one for now."""
        coarse, half = self._schedule.coarse
        if self._progress < coarse:
            return self._coarsest
        return max(1, self._coarsest // 2) if self._progress < half else 1

    def hurry(self) -> None:
        """Let the plan end after a few more steps."""
        if self._progress < _HURRY_FROM:
            self._progress = _HURRY_FROM
        self._stride = max(self._stride, (1 - self._progress) / _HURRY_STEPS)
        self._relocated = len(self._schedule.relocations)
        self._repainted = self._repaints_before(self._progress)

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
        if now - self._stride < schedule.fine <= now:
            self._finest = finest(self._problem.target, lambda side: self._stroke_canvas.render(side=side))
        loss, parts, canvas = self._step(now)
        self._progress += self._stride
        self._steps += 1
        return PlanProgress(now, loss, parts, canvas, self.state)

    def state(self) -> State:
        """Return copies of all that the next step depends on."""
        counts = (self._steps, self._sorted, self._relocated, self._repainted)
        numbers = (self._progress, self._stride, self._style_price.weight, *counts)
        state = {
            "progress": np.array(numbers),
            "spacing": np.array(self._spacing),
            "usual_stride": np.array(self._usual_stride),
            **self._stroke_canvas.state(),
            **self._descent.state(),
            "finest": np.array(self._finest),
            **({} if self._arranging is None else {"densities": self._arranging.densities}),
            **self._loss.state(),
            **rng_state(self._rng, self._torch_rng),
        }
        return {name: array.copy() for name, array in state.items()}

    def restore(self, state: State) -> None:
        """Go on from a state that `state` returned."""
        self._progress, self._stride, self._style_price.weight, *counts = state["progress"].tolist()
        self._steps, self._sorted, self._relocated, repainted = (int(count) for count in counts)
        self._repainted = min(repainted, self._repaints_before(self._progress))  # fewer where it was set back
        self._stroke_canvas.restore(state)
        if "paints" in state and self._stroke_canvas.paints is None:
            self._stroke_canvas.paints = self._paints_to_use(torch.from_numpy(state["paints"].copy()))
        self._descent.restore(state)
        self._finest = state["finest"].item()
        self._loss.restore(state)
        restore_rng(state, self._rng, self._torch_rng)

    def _step(self, now: float) -> tuple[float, dict[str, float], Tensor]:
        """Take a step with all strokes; return the loss before it, its parts, and the canvas."""
        strokes = self._stroke_canvas.strokes
        canvas = self._stroke_canvas.render(side=self._side if now < self._schedule.fine else self._finest)
        self._loss.ask(canvas, self._steps, self._torch_rng)
        loss, parts = self._loss.of(canvas, now)
        if self._arranging is not None:
            loss = loss + self._arranging.price(strokes, self._torch_rng).to(loss.device)
        self._descent.step(loss + self._style_price.of(strokes).to(loss.device), now)
        self._style_price.adapt(self._stride)
        if isinstance(self._style, RegionalStyle):
            self._style.keep_lengths(strokes.codes)
        elif self._lengths is not None:
            keep_lengths(strokes.codes, self._style, self._lengths)
        self._stroke_canvas.keep_inside()
        return loss.item(), parts, canvas.detach()

    def _relocate_useless(self) -> None:
        """Move the strokes that would be missed least to where the canvas is furthest from the target.

        Of several brushes each takes the one that serves best there.
        """
        stroke_canvas, view = self._stroke_canvas, self._loss.view
        costs = self._removal_costs(self._side)
        useless = torch.argsort(costs, stable=True)[: max(1, int(_RELOCATED_SHARE * len(costs)))]
        with torch.no_grad():
            canvas = stroke_canvas.render(side=self._side)
        density = self._initialiser.missing(view, canvas)
        left = torch.ones(len(costs), dtype=torch.bool).index_fill(0, useless, False)
        own = stroke_canvas.strokes[left]
        for rows, there in self._initialiser.by_pool(useless, stroke_canvas.strokes, stroke_canvas.paint_of, density):
            strokes = stroke_canvas.strokes[rows]
            moved = self._initialiser.moved(strokes, view.target, canvas, there, self._spacing)
            if len(moved) > 1:
                moved = [best_brushes(self._problem, view, own, moved, self._torch_rng)]
            self._descent.replace(rows, moved[0])

    def _removal_costs(self, side: float) -> Tensor:
        """Return an estimate of the cost of removing each stroke, (N,), by row; side: as in `StrokeCanvas.render`."""
        marks, colours = self._stroke_canvas.drawn(side)
        view, paper = self._loss.view.drawn(side), to_drawn(self._problem.paper, side)
        return self._stroke_canvas.by_row(removal_costs(view, paper, marks, colours, self._torch_rng))

    def _quantise_colours(self) -> None:
        """Turn free colours into paints: mixed ones, which go on adapting, or those of the palette."""
        if self._stroke_canvas.paints is not None:
            return
        options = self._options
        if options.paints is None:
            paints = torch.tensor(self._initialiser.palette)
        else:
            mixed = mix_colours(self._stroke_canvas, self._loss.view, options)
            paints = torch.tensor(mixed, dtype=torch.float32)
        self._stroke_canvas.quantise(self._paints_to_use(paints), self._schedule.grouped)

    def _repaint(self) -> None:
        """Give strokes other paints of the palette where that makes the loss smaller."""
        stroke_canvas = self._stroke_canvas
        if stroke_canvas.paints is None or self._options.paints is not None or self._options.in_ink:
            return
        marks, colours = stroke_canvas.drawn()
        costs = recolouring_costs(
            self._loss.view, self._problem.paper, marks, colours, stroke_canvas.paints, self._torch_rng
        )
        loss = self._loss.at(self._progress)
        repaint(stroke_canvas, loss, stroke_canvas.by_row(costs), grouped=self._schedule.grouped)

    def _paints_to_use(self, paints: Tensor) -> Tensor:
        """Return the paints (k, C), which go on adapting if they are still to be mixed."""
        if self._options.paints is not None:
            pinned = torch.tensor(self._options.pinned).reshape(-1, 3)
            self._descent.add_paints(paints.requires_grad_(), (paints[:, None] == pinned[None]).all(dim=2).any(dim=1))
        return paints

    def _across_lights(self, target: Tensor) -> Bools:
        """Return which strokes, (N,), lie far across lights of the target (C, H, W)."""
        scale = self._canvas.pixels_per_metre
        paths = scale * as_array(self._stroke_canvas.strokes.trajectories(self._style)[..., :2])
        spacing = scale * self._initialiser.usual_spacing
        return across_lights(paths, target, self._problem.paper, self._options.palette, spacing)

    def _repaints_before(self, progress: float) -> int:
        return sum(share < progress for share in self._schedule.repaints)

    def finish(self) -> PlanResult:
        """Return the plan in painting order, without useless strokes unless the number is to be exact."""
        self._quantise_colours()
        kept = np.ones(len(self._stroke_canvas.strokes), dtype=bool)
        if not self._options.exact:
            costs = self._removal_costs(self._finest).numpy()
            kept = needed(self._stroke_canvas, self._loss.at(1.0), costs, self._finest)
            if self._options.in_ink and self._problem.target is not None:
                kept &= ~self._across_lights(self._problem.target)
        return self._stroke_canvas.result(kept)
