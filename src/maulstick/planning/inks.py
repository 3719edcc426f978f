"""Inks of a plan: how densely strokes of each are wanted, and how many each has."""

from collections.abc import Iterator, Sequence

import numpy as np
import torch
from scipy.ndimage import gaussian_filter
from torch import Tensor

from maulstick.colour.palette import light_first
from maulstick.planning.problem import Colour, PlanningProblem
from maulstick.planning.separation import separated
from maulstick.planning.stroke_canvas import as_array
from maulstick.planning.stroke_effects import TargetView
from maulstick.storage.arrays import Floats


class Inks:
    """Inks, k of them, on the sheet of a problem. palette: their colours, the lightest first."""

    def __init__(self, problem: PlanningProblem, palette: Sequence[Colour]) -> None:
        self.palette = tuple(palette[number] for number in light_first(np.array(palette)))
        self._regions = problem.regions
        self._paper, self._weights = as_array(problem.paper), as_array(problem.weights)
        self._shown: tuple[Tensor, Floats] | None = None  # the last target, and how much of each ink it shows

    def wanted(self, target: Tensor) -> Floats:
        """Return the density (k, H, W) of strokes that a target (C, H, W) needs on the bare sheet."""
        return self._where_allowed(self._amounts_of(target))

    def missing(self, view: TargetView, canvas: Tensor) -> Floats:
        """Return the density (k, H, W) of strokes that a canvas (C, H, W) still needs to become the target."""
        density = self._amounts_of(view.target) - self._amounts(as_array(canvas))
        sigma = density.shape[1] / 100 + view.pool
        return self._where_allowed(gaussian_filter(density, (0, sigma, sigma)).clip(min=0) * self._weights)

    def everywhere(self, density: Floats) -> Floats:
        """Return the same density (H, W) of each ink, (k, H, W)."""
        return self._where_allowed(np.repeat(density[None], len(self.palette), axis=0))

    def shares(self, density: Floats, count: int) -> Iterator[tuple[Colour, Floats, int]]:
        """Yield inks, where each may be, (H, W), and how many of so many strokes it has, by its share of a density.

        density: (k, H, W). Of regions that keep strokes to themselves each has its own; where nothing is wanted in one,
        strokes of all inks are spread over it.
        """
        pools = [(density, count)]
        if self._regions is not None:
            every = self.everywhere(np.ones_like(self._weights))
            counts = zip(self._regions.pools, self._regions.counts(count), strict=True)
            own = [(members[self._regions.labels], number) for (members, _), number in counts]
            pools = [((density if (density * there).any() else every) * there, number) for there, number in own]
        for of_pool, number in pools:
            ends = np.cumsum(of_pool.sum(axis=(1, 2)) + 1e-9)
            parts = np.diff(np.round(number * ends / ends[-1]), prepend=0).astype(int).tolist()
            yield from (each for each in zip(self.palette, of_pool, parts, strict=True) if each[2])

    def _amounts_of(self, target: Tensor) -> Floats:
        if self._shown is None or self._shown[0] is not target:
            self._shown = target, self._amounts(as_array(target))
        return self._shown[1]

    def _amounts(self, image: Floats) -> Floats:
        return separated(torch.from_numpy(image), torch.from_numpy(self._paper), self.palette).numpy()

    def _where_allowed(self, density: Floats) -> Floats:
        """Return a density of inks (k, H, W), 0 where a region does not allow them."""
        if self._regions is None:
            return density
        allowed = self._regions.allowed_paints(torch.arange(len(self._regions.said)), np.array(self.palette))
        return density * allowed.T[:, self._regions.labels]
