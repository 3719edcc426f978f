"""How few calls of a network do, for `plan.py --objective network`.

Three plans of 400 strokes at 256 pixels, with the same brush, style and paints, are compared by the same network
through the same 16 views, which none of them was planned with:

plain: the published way: strokes begin anywhere, RMSprop, a rate that rises and falls, 2,000 steps, and at each of them
    the network is asked through two of 32 views.
warm: the same with our start, and with tones beside the network.
few_calls: Maulstick's way, whose 2,000 steps ask the network 200 times, with the same weights of both terms as `warm`.
"""

import time
from collections.abc import Callable
from itertools import count

import numpy as np
import torch
from frida import anywhere, plan_plainly
from photographs import BRUSH, laid_out
from torch import Generator, Tensor

from maulstick.planning.features.efficientnet import EfficientNetLite0
from maulstick.planning.features.network import Network
from maulstick.planning.features.views import random_views
from maulstick.planning.from_picture import problem_of
from maulstick.planning.initialise import Initialiser
from maulstick.planning.losses import LossOptions
from maulstick.planning.objectives import Likeness, NetworkLoss
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings, PlanningProblem, Weighted
from maulstick.planning.result import PlanProgress, PlanResult
from maulstick.planning.stroke_canvas import StrokeCanvas
from maulstick.rendering.threads import usual_torch_threads
from maulstick.style import load_style

PX, STEPS, EVERY = 256, 2000, 10
AT_ONCE, EXAM, EXAMINED_EVERY = 2, 16, 100
LIKENESS = LossOptions(weights={"likeness": 1.0})
Row = dict[str, object]
Curve = list[tuple[int, float]]
Seen = Callable[[Tensor], None]


class Stopwatch:
    """Seconds of the processor within its blocks, all together."""

    def __init__(self) -> None:
        self.seconds = 0.0

    def __enter__(self) -> None:
        self._started = time.process_time()

    def __exit__(self, *_: object) -> None:
        self.seconds += time.process_time() - self._started


class Counted(NetworkLoss):
    """Another network loss, and how often it was asked."""

    def __init__(self, network_loss: NetworkLoss) -> None:
        self._network_loss, self.calls = network_loss, 0

    @property
    def name(self) -> str:
        """What the network loss is called."""
        return self._network_loss.name

    @property
    def views(self) -> int:
        """As many as the network loss has."""
        return self._network_loss.views

    @usual_torch_threads()
    def losses(self, canvas: Tensor, which: list[int]) -> Tensor:
        """What the network loss says."""
        self.calls += 1
        return self._network_loss.losses(canvas, which)


def few_calls(image: str, seed: int) -> tuple[Row, dict[str, Curve]]:
    """A row, and of each way the loss after so many calls."""
    options = PlannerSettings(exact=True, steps=STEPS, ask_every=EVERY, seed=seed)
    problem = _problem(image, options, EfficientNetLite0())
    assert problem.target is not None
    unseen = random_views(EXAM, *problem.weights.shape, Generator().manual_seed(1))
    exam = Likeness(EfficientNetLite0(), problem.target, unseen, torch.ones(3))
    row: Row = {"name": "few_calls", "image": image, "seed": seed, "network": EfficientNetLite0().name}
    curves: dict[str, Curve] = {}
    for name, way in {"few_calls": _few, "plain": _plain, "warm": _warm}.items():
        prefix = "" if name == "few_calls" else f"{name}_"
        network_loss, curve, examining = Counted(problem.network_losses[0].term), [], Stopwatch()

        def seen(
            canvas: Tensor, network_loss: Counted = network_loss, curve: Curve = curve, watch: Stopwatch = examining
        ) -> None:
            with watch:
                curve.append((network_loss.calls, _examined(canvas, exam)))

        planning = Stopwatch()
        with planning:
            network_losses = (Weighted(network_loss, problem.network_losses[0].weight),)
            planned = way(PlanningProblem(**{**vars(problem), "network_losses": network_losses}), options, seen)
        row[f"{prefix}calls"] = network_loss.calls
        row[f"{prefix}seconds"] = round(planning.seconds - examining.seconds, 1)
        seen(_rendered(problem, planned))
        row[f"{prefix}loss"] = round(curve[-1][1], 4)
        curves[name] = curve
    return row, curves


def _problem(image: str, options: PlannerSettings, network: Network) -> PlanningProblem:
    layout = laid_out(image, PX)
    style = load_style("free", layout.canvas)
    return problem_of(layout, (BRUSH,), style, options, LIKENESS, lambda: network)


def _few(problem: PlanningProblem, options: PlannerSettings, seen: Seen) -> PlanResult:
    steps = count()

    def watch(progress: PlanProgress) -> bool:
        if next(steps) % EXAMINED_EVERY == 0:
            seen(progress.canvas)
        return True

    return plan(problem, options, watch)


def _plain(problem: PlanningProblem, options: PlannerSettings, seen: Seen) -> PlanResult:
    torch_rng = Generator().manual_seed(options.seed)
    start = anywhere(problem, options.strokes, torch_rng)
    return _plainly(problem, start, lambda canvas: _said(problem, canvas, torch_rng), seen)


def _warm(problem: PlanningProblem, options: PlannerSettings, seen: Seen) -> PlanResult:
    torch_rng = Generator().manual_seed(options.seed)
    tone, network_loss = problem.objectives[0], problem.network_losses[0]
    start, _ = Initialiser(problem, options, False, np.random.default_rng(options.seed), torch_rng).first()

    def loss(canvas: Tensor) -> Tensor:
        return tone.weight * tone.term.loss(canvas, 1.0) + network_loss.weight * _said(problem, canvas, torch_rng)

    return _plainly(problem, start, loss, seen)


def _plainly(
    problem: PlanningProblem, start: StrokeParameters, loss: Callable[[Tensor], Tensor], seen: Seen
) -> PlanResult:
    def watch(step: int, _: float, canvas: Tensor) -> None:
        if step % EXAMINED_EVERY == 0:
            seen(canvas)

    return plan_plainly(problem, start, loss, steps=STEPS, even_pressure=False, watch=watch)


def _said(problem: PlanningProblem, canvas: Tensor, torch_rng: Generator) -> Tensor:
    """What the network loss says through a few of its views."""
    network_loss = problem.network_losses[0].term
    return network_loss.losses(
        canvas, torch.randperm(network_loss.views, generator=torch_rng)[:AT_ONCE].tolist()
    ).mean()


@torch.no_grad()
def _examined(canvas: Tensor, exam: NetworkLoss) -> float:
    return float(exam.losses(canvas, range(exam.views)).mean())


def _rendered(problem: PlanningProblem, planned: PlanResult) -> Tensor:
    stroke_canvas = StrokeCanvas(planned.strokes, problem)
    stroke_canvas.paints, stroke_canvas.paint_of = planned.paints, planned.paint_of
    return stroke_canvas.render().detach()
