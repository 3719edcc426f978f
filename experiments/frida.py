"""FRIDA's method next to ours, written from the papers alone: its stroke, and how it plans.

Source: Spline-FRIDA, Background, and Painting and Drawing Planning, which say how FRIDA works.
"""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from math import inf, log
from typing import NoReturn, Self

import numpy as np
import torch
from torch import Generator, Tensor
from torch.nn.functional import logsigmoid

from maulstick.colour.palette import mix_paints
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.problem import PlanningProblem
from maulstick.planning.result import PlanResult
from maulstick.planning.stroke_canvas import StrokeCanvas, as_array
from maulstick.rendering.threads import one_torch_thread
from maulstick.strokes.strokes import POINTS
from maulstick.style import Style
from maulstick.style.hand import by_length
from maulstick.style.pressure import KNOTS

RATES = {"codes": 0.02, "centres": 0.004, "angles": 0.08, "pressure_knots": 0.04, "colours": 0.02}
"""At the peak, found by search: halves and doubles do worse. centres: in heights of the sheet."""
MIXED = 0.9
"""Share of the steps after which colours become paints."""
STEEPNESS = 4.0
"""Steepness of a curve's numbers over its code, so that our planner's steps suit codes."""
EVEN = 1e4
"""Cost of an uneven pressure: enough for our planner to draw each stroke at one pressure, as FRIDA always does."""


@dataclass(frozen=True)
class Bezier(Style):
    """Quadratic Bézier curves of a length and a bend.

    The length is the chord's, 1 to 5 cm, and the bend is how far the middle control point lies beside the chord's
    middle, up to 2 cm. A code (2,) says where both lie between their limits, by a sigmoid: 0 is halfway.
    """

    shortest: float = 0.01
    longest: float = 0.05
    most_bent: float = 0.02
    name: str = field(default="bezier", init=False)
    max_mean_cost: float = field(default=inf, init=False)

    @property
    def hash(self) -> str:
        """Hash of everything that decoding depends on."""
        return hashlib.sha256(f"{self!r} {STEEPNESS} {POINTS}".encode()).hexdigest()[:16]

    def encode(self, paths: Tensor) -> Tensor:
        """The curve with each path's chord, and as far beside it in the middle as the path is on average."""
        length = (paths[:, -1, 0] - self.shortest) / (self.longest - self.shortest)
        weights = 2 * self._along(paths) * (1 - self._along(paths))
        bend = (paths[..., 1] @ weights) / weights.square().sum()
        return _codes(torch.stack([length, bend / (2 * self.most_bent) + 0.5], dim=1))

    def decode(self, codes: Tensor) -> Tensor:
        """Paths (N, 32, 2) of codes (N, 2), at equal steps of the curve's parameter."""
        shares, along = (STEEPNESS * codes).sigmoid()[..., None], self._along(codes)
        length = self.shortest + (self.longest - self.shortest) * shares[:, 0]
        bend = self.most_bent * (2 * shares[:, 1] - 1)
        return torch.stack([length * along, 2 * bend * along * (1 - along)], dim=-1)

    def _along(self, like: Tensor) -> Tensor:
        return torch.linspace(0, 1, POINTS).to(like)

    def sample(self, k: int, generator: Generator) -> tuple[Tensor, Tensor]:
        """Of any length, bend and pressure alike; the pressure is even."""
        return _codes(torch.rand(k, 2, generator=generator)), _even(torch.rand(k, 1, generator=generator))

    def sample_for(self, lengths: Tensor, generator: Generator, rows: Tensor | None = None) -> tuple[Tensor, Tensor]:
        """As `sample`, the longest where there is most room."""
        codes, pressure_knots = self.sample(len(lengths), generator)
        chosen = by_length(codes[:, 0], lengths)
        return codes[chosen], pressure_knots[chosen]

    def sample_around(self, rows: Tensor, generator: Generator) -> NoReturn:
        """Raise NotImplementedError: there are no strokes of a hand."""
        raise NotImplementedError

    def nearest(self, paths: Tensor) -> None:
        """Return None: there are no strokes of a hand that they could be like."""

    @property
    def arrangement(self) -> None:
        """None: there is no hand that arranges strokes."""
        return None

    def lengths(self, count: int) -> None:
        """Return None: curves may have any length within the limits."""

    def resize(self, codes: Tensor, lengths: Tensor, own: Tensor) -> None:
        """Change codes (N, 2) in place, so that their curves have chords of these lengths (N,), metres."""
        shares = (lengths.to(codes) - self.shortest) / (self.longest - self.shortest)
        codes[:, 0] = _codes(shares)

    def scaled(self, times: float) -> Self:
        """Return curves whose limits are so many times as large."""
        return replace(
            self, shortest=self.shortest * times, longest=self.longest * times, most_bent=self.most_bent * times
        )

    def usual_cost(self, k: int, generator: Generator) -> float:
        """Mean cost of k samples."""
        return float(self.cost(*self.sample(k, generator)).mean())

    def cost(self, codes: Tensor, pressure_knots: Tensor) -> Tensor:
        """The cost of uniform lengths and bends, which keeps codes from where gradients vanish; uneven pressure."""
        shares = logsigmoid(STEEPNESS * codes) + logsigmoid(-STEEPNESS * codes) + log(4)
        uneven = pressure_knots - pressure_knots.mean(dim=1, keepdim=True)
        return EVEN * uneven.square().sum(dim=1) - shares.sum(dim=1)

    def speeds(self, codes: Tensor) -> Tensor | None:
        """Return None: these curves have no recorded speeds."""
        return None


def anywhere(problem: PlanningProblem, count: int, generator: Generator) -> StrokeParameters:
    """Return strokes of the style at random: places, directions, pressure and colours."""
    codes, pressure_knots = problem.style.sample(count, generator)
    size = torch.tensor([problem.canvas.width, problem.canvas.height])
    return StrokeParameters(
        codes=codes,
        centres=torch.rand(count, 2, generator=generator) * size,
        angles=torch.rand(count, generator=generator) * 2 * torch.pi,
        pressure_knots=pressure_knots,
        colours=torch.rand(count, 3, generator=generator),
        brush_of=torch.zeros(count, dtype=torch.long),
    )


def evenly_pressed(strokes: StrokeParameters) -> StrokeParameters:
    """Each stroke at its mean pressure, which is the only one that FRIDA's have."""
    return replace(strokes, pressure_knots=_even(strokes.pressure_knots.mean(dim=1, keepdim=True)))


def _codes(shares: Tensor) -> Tensor:
    return torch.logit(shares, eps=1e-3) / STEEPNESS


def _even(pressure: Tensor) -> Tensor:
    return pressure.expand(-1, KNOTS)


@one_torch_thread()
def plan_plainly(
    problem: PlanningProblem,
    start: StrokeParameters,
    loss: Callable[[Tensor], Tensor],
    *,
    steps: int = 2000,
    paints: int | None = 12,
    seed: int = 0,
    even_pressure: bool = True,
    watch: Callable[[int, float, Tensor], None] = lambda step, loss, canvas: None,
) -> PlanResult:
    """Plan by RMSprop over all numbers of all strokes, whose rate rises and falls once.

    loss: of the canvas (C, H, W), evaluated at every step; the problem's own objectives and network losses are not.
    paints: how many to mix of the colours when a tenth of the steps is left; with None strokes keep the colours that
    they start with, as with one ink.  seed: of the mixing.  watch: gets the step, its loss and the canvas.
    even_pressure: the pressure of a stroke is one number, as FRIDA's is.
    Source: Spline-FRIDA, Painting and Drawing Planning.
    """
    pressure = start.pressure_knots.mean(dim=1, keepdim=True) if even_pressure else start.pressure_knots
    leaves = {name: tensor.clone() for name, tensor in (start.each() | {"pressure_knots": pressure}).items()}
    fixed = {"pressure_knots": not problem.brushes[0].pressure_matters, "colours": paints is None, "brush_of": True}
    for name, tensor in leaves.items():
        tensor.requires_grad_(not fixed.get(name, False))
    strokes = StrokeParameters(**(leaves | {"pressure_knots": _even(leaves["pressure_knots"])}))
    stroke_canvas = StrokeCanvas(strokes, problem)
    peaks = RATES | {"centres": RATES["centres"] * problem.canvas.height}
    groups = [{"params": [tensor], "peak": peaks[name]} for name, tensor in leaves.items() if tensor.requires_grad]
    descent = torch.optim.RMSprop(groups, lr=0.0)
    for step in range(steps):
        if paints is not None and stroke_canvas.paints is None and step >= MIXED * steps:
            mixed = mix_paints(as_array(leaves["colours"]), np.ones(len(start)), paints, seed)
            stroke_canvas.quantise(torch.from_numpy(mixed).to(leaves["colours"]), grouped=False)
        for group in descent.param_groups:
            group["lr"] = group["peak"] * (1 - abs(2 * (step + 0.5) / steps - 1))
        canvas = stroke_canvas.render()
        now = loss(canvas)
        descent.zero_grad()
        now.backward()
        descent.step()
        with torch.no_grad():
            leaves["pressure_knots"].clamp_(0, 1)
            leaves["colours"].clamp_(0, 1)
        strokes.keep_inside(problem.style, problem.canvas.width, problem.canvas.height)
        watch(step, now.item(), canvas.detach())
    drawn = strokes[torch.arange(len(strokes))]
    if stroke_canvas.paints is not None:
        return PlanResult(drawn, stroke_canvas.paints, stroke_canvas.paint_of)
    return PlanResult(drawn, *torch.unique(drawn.colours, dim=0, return_inverse=True))
