"""Where strokes begin: all of them on the empty sheet, and later a few where the picture is most amiss."""

import numpy as np
import torch
from scipy.ndimage import gaussian_filter
from torch import Generator, Tensor

from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.placement import detail, find_places, ink_density, start_strokes
from maulstick.planning.problem import PlannerSettings, PlanningProblem
from maulstick.planning.stroke_canvas import as_array
from maulstick.planning.stroke_effects import TargetView
from maulstick.storage.arrays import Floats

_SEEN = 2 / 255


class Initialiser:
    """New strokes for a planning problem. All chance comes from the generators."""

    def __init__(
        self, problem: PlanningProblem, options: PlannerSettings, rng: np.random.Generator, torch_rng: Generator
    ) -> None:
        self._asked, self._options = problem, options
        self._rng, self._torch_rng = rng, torch_rng
        self._paper, self._weights = as_array(problem.paper), as_array(problem.weights)
        self._ink = np.array(options.palette[0])

    def first(self) -> tuple[StrokeParameters, float]:
        """As many as are planned, on the sheet as it is, and the median of their spacing, metres."""
        target = self._asked.target
        if target is None:
            return self._anywhere()
        image = as_array(target)
        if self._options.one_ink:
            density = ink_density(image, self._paper, self._ink)
        else:
            differs = np.abs(image - self._paper).max(axis=0) > _SEEN
            density = detail(image) * gaussian_filter(differs.astype(np.float64), 1) * self._weights
        return self.strokes(target, density, self._options.strokes)

    def amiss(self, view: TargetView, canvas: Tensor) -> Floats:
        """How much more paint each place of the canvas (C, H, W) wants, (H, W)."""
        image, painted = as_array(view.target), as_array(canvas)
        blur = image.shape[1] / 100
        if self._options.one_ink:
            density = ink_density(image, self._paper, self._ink) - ink_density(painted, self._paper, self._ink)
            missing: Floats = gaussian_filter(density, blur + view.pool).clip(min=0) * self._weights
            return missing
        wrong: Floats = np.sum([gaussian_filter(x, blur) ** 2 for x in painted - image], axis=0) * self._weights
        return wrong

    def strokes(
        self, target: Tensor, density: Floats, count: int, room: float = np.inf
    ) -> tuple[StrokeParameters, float]:
        """`count` strokes where the density (H, W) asks, along edges of the target; the median of their spacing.

        room: none takes more than this, metres, as the spacing is.
        """
        pixels_per_metre = self._asked.canvas.pixels_per_metre
        places = find_places(as_array(target), density, count, self._rng, room * pixels_per_metre)
        strokes = start_strokes(places, self._asked.style, self._asked.brush, pixels_per_metre, self._torch_rng)
        return strokes, float(np.median(places.spacing)) / pixels_per_metre

    def _anywhere(self) -> tuple[StrokeParameters, float]:
        """All over the sheet, in any colour."""
        strokes, spacing = self.strokes(self._asked.paper, np.ones_like(self._weights), self._options.strokes)
        strokes.colours.copy_(torch.rand(strokes.colours.shape, generator=self._torch_rng))
        return strokes, spacing
