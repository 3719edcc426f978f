"""The problem and the settings that a planner is given."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Generic, TypeVar

import torch
from torch import Tensor

from maulstick.errors import InputError
from maulstick.painting.brush import Brush
from maulstick.painting.raster import Canvas
from maulstick.planning.guides import Guides
from maulstick.planning.objectives import NetworkLoss, Objective
from maulstick.planning.regions import Regions
from maulstick.planning.room import Room
from maulstick.storage.arrays import Image
from maulstick.storage.text import counted
from maulstick.strokes.strokes import POINTS
from maulstick.style import Style

Colour = tuple[float, float, float]
Term = TypeVar("Term", Objective, NetworkLoss)


@dataclass(frozen=True)
class PlannerSettings:
    """Settings of the planner.

    strokes: at most so many; exactly so many with `exact`.
    paints: how many colours to mix; None draws with the `palette` of inks, or of paints, sRGB in [0, 1].
    steps: of the optimiser.  ask_every: steps between two calls of the network losses.
    pinned: colours among the `paints` that are used as they are, sRGB in [0, 1].
    in_colours: whether the palette is of paints and not of inks.
    arrange: in [0, 1], how far strokes of inks are arranged as the hand arranges them, where the style knows how.
    seed: repeats a plan to the bit on one machine, with the same versions, settings and number of threads.
    Raises InputError for a value out of its range.
    """

    strokes: int = 400
    exact: bool = False
    paints: int | None = 12
    palette: tuple[Colour, ...] = ((0.0, 0.0, 0.0),)
    steps: int = 500
    ask_every: int = 4
    seed: int = 0
    arrange: float = 1.0
    pinned: tuple[Colour, ...] = ()
    in_colours: bool = False

    def __post_init__(self) -> None:
        if self.strokes < 1:
            raise InputError.of_range("the number of strokes", self.strokes, "at least 1")
        if self.paints is not None and not 1 <= self.paints <= self.strokes:
            raise InputError.of_range(
                "the number of paints", self.paints, f"1 to the {counted(self.strokes, 'stroke')}"
            )
        if self.steps < 1:
            raise InputError.of_range("the number of steps", self.steps, "at least 1")
        if self.ask_every < 1:
            raise InputError.of_range("the number of steps between two calls", self.ask_every, "at least 1")
        if not self.palette:
            raise InputError("the palette is empty; give it at least one colour")
        if self.pinned and (self.paints is None or len(self.pinned) > self.paints):
            allowed = "at most the number of paints that are mixed"
            raise InputError.of_range("the number of colours that are pinned", len(self.pinned), allowed)
        for colour in (*self.palette, *self.pinned):
            if not all(0 <= channel <= 1 for channel in colour):
                raise InputError.of_range("a colour of the palette", colour, "sRGB in [0, 1]")
        if not 0 <= self.arrange <= 1:
            raise InputError.of_range("how far strokes are arranged", self.arrange, "0 to 1")
        if not 0 <= self.seed < 2**32:
            raise InputError.of_range("the seed", self.seed, "in 0 to 4294967295")

    @property
    def in_ink(self) -> bool:
        """Whether the palette is of inks, so that tones are made of the distance between lines."""
        return self.paints is None and not self.in_colours


@dataclass(frozen=True)
class Weighted(Generic[Term]):
    """A term of the loss, and its weight."""

    term: Term
    weight: float


@dataclass(frozen=True)
class Neighbours:
    """Strokes of other plans among those of this one, in the order of their colours; planning does not change them.

    trajectories: (M, 32, 3) commanded, metres on the canvas and pressure.  colours: (M, 3).  brush_of: (M,).
    """

    trajectories: Tensor
    colours: Tensor
    brush_of: Tensor


NO_NEIGHBOURS: Final = Neighbours(torch.zeros(0, POINTS, 3), torch.zeros(0, 3), torch.zeros(0, dtype=torch.long))
"""No neighbours: the plan is alone on its canvas."""


@dataclass(frozen=True)
class PlanningProblem:
    """Problem of a planner: what is to be painted, and with what.

    target: (3, H, W) of the canvas' pixels, sRGB in [0, 1], or None where there is no picture.  paper: (3, H, W), what
    is on the sheet before the first stroke.  weights: (H, W), how much each place matters.  All three are on the
    device that renders.
    brushes: in the order in which they paint, the broadest first.
    objectives, network_losses: the terms of the loss.
    neighbours: strokes of other plans on the same canvas.
    room: the part of the canvas that ink must not leave, None for all of it.
    regions: of the canvas, whose `style` is then the problem's; None where all of it is alike.
    guides: directions of strokes that are said; None where the picture alone says them.
    pull: (3, H, W), of inks, as `Halftone` takes it.
    lines: returns how dark the lines are, (H, W), that the first strokes of inks lie along; None for none.
    """

    target: Tensor | None
    paper: Tensor
    weights: Tensor
    canvas: Canvas
    brushes: tuple[Brush, ...]
    style: Style
    objectives: tuple[Weighted[Objective], ...]
    network_losses: tuple[Weighted[NetworkLoss], ...] = ()
    neighbours: Neighbours = NO_NEIGHBOURS
    room: Room | None = None
    regions: Regions | None = None
    guides: Guides | None = None
    pull: Tensor | None = None
    lines: Callable[[], Image] | None = None
