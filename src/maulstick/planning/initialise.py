"""Initial strokes: all of them on the empty sheet, and later a few where the canvas is furthest from the picture."""

import numpy as np
import torch
from scipy.ndimage import gaussian_filter
from torch import Generator, Tensor

from maulstick.planning.groups import place_groups
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.placement import detail, find_places, ink_density, start_strokes, strokes_at
from maulstick.planning.problem import PlannerSettings, PlanningProblem
from maulstick.planning.room import surface_of
from maulstick.planning.stroke_canvas import as_array
from maulstick.planning.stroke_effects import TargetView
from maulstick.storage.arrays import Floats
from maulstick.style.arrangement import Arrangement

_VISIBLE = 2 / 255  # least difference of sRGB between paper and picture that wants a stroke: two steps of 8 bits


class Initialiser:
    """New strokes for a planning problem. All random numbers come from the two generators.

    arrangement: whose groups are placed; None to place each stroke alone.
    """

    def __init__(
        self,
        problem: PlanningProblem,
        options: PlannerSettings,
        arrangement: Arrangement | None,
        rng: np.random.Generator,
        torch_rng: Generator,
    ) -> None:
        self._problem, self._options, self._arrangement = problem, options, arrangement
        self._rng, self._torch_rng = rng, torch_rng
        self._paper, self._weights = as_array(problem.paper), as_array(problem.weights)
        self._ink = np.array(options.palette[0])

    def first(self) -> tuple[StrokeParameters, float]:
        """Return as many strokes as are planned, on the sheet as it is, and the median of their spacing, metres."""
        target = self._problem.target
        if target is None:
            return self._anywhere()
        image = as_array(target)
        if self._options.one_ink:
            density = ink_density(image, self._paper, self._ink)
        else:
            differs = np.abs(image - self._paper).max(axis=0) > _VISIBLE
            density = detail(image) * gaussian_filter(differs.astype(np.float64), 1) * self._weights
        return self.strokes(target, density, self._options.strokes)

    def missing(self, view: TargetView, canvas: Tensor) -> Floats:
        """Return the density (H, W) of strokes that the canvas (C, H, W) still needs to become the target."""
        image, painted = as_array(view.target), as_array(canvas)
        blur = image.shape[1] / 100
        if self._options.one_ink:
            density = ink_density(image, self._paper, self._ink) - ink_density(painted, self._paper, self._ink)
            ink: Floats = gaussian_filter(density, blur + view.pool).clip(min=0) * self._weights
            return ink
        error: Floats = np.sum([gaussian_filter(x, blur) ** 2 for x in painted - image], axis=0) * self._weights
        return error

    def strokes(
        self, target: Tensor, density: Floats, count: int, room: float = np.inf
    ) -> tuple[StrokeParameters, float]:
        """Return `count` strokes spread by the density (H, W) along edges of the target, and their median spacing.

        room: the largest spacing that a stroke is sized for. Both are in metres.
        """
        pixels_per_metre = self._problem.canvas.pixels_per_metre
        if self._arrangement is not None:
            return self._in_groups(self._arrangement, target, density, count)
        places = find_places(as_array(target), density, count, self._rng, room * pixels_per_metre)
        strokes = start_strokes(places, self._problem.style, self._problem.brush, pixels_per_metre, self._torch_rng)
        return strokes, float(np.median(places.spacing)) / pixels_per_metre

    def _in_groups(
        self, arrangement: Arrangement, target: Tensor, density: Floats, count: int
    ) -> tuple[StrokeParameters, float]:
        """Return `count` strokes as `strokes` does, in groups of the hand."""
        canvas = self._problem.canvas
        spacing = (surface_of(self._problem.room, canvas) / self._options.strokes) ** 0.5
        room, scale = spacing * canvas.pixels_per_metre, canvas.pixels_per_metre
        places, rows = place_groups(as_array(target), density, count, arrangement, room, scale, self._rng)
        codes, knots = self._problem.style.sample_around(torch.from_numpy(rows), self._torch_rng)
        return strokes_at(places, codes, knots, self._problem.brush, scale), spacing

    def _anywhere(self) -> tuple[StrokeParameters, float]:
        """Return strokes all over the sheet in random colours, and their spacing as `first` does."""
        density = np.ones_like(self._weights)
        if (room := self._problem.room) is not None:
            left, top, right, bottom = (round(edge * self._problem.canvas.pixels_per_metre) for edge in room)
            density[:] = 0
            density[top:bottom, left:right] = 1
        strokes, spacing = self.strokes(self._problem.paper, density, self._options.strokes)
        strokes.colours.copy_(torch.rand(strokes.colours.shape, generator=self._torch_rng))
        return strokes, spacing
