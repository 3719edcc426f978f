"""Strokes of hands whose arrangement is known: along the lines of a picture, and in groups where it wants tones."""

from collections.abc import Sequence
from itertools import repeat

import numpy as np
import torch
from torch import Generator, Tensor

from maulstick.planning.directions import directions
from maulstick.planning.groups import choose_groups, place_groups, without
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.placement import strokes_at
from maulstick.planning.problem import PlanningProblem
from maulstick.planning.stroke_canvas import as_array
from maulstick.planning.tracing import END_TO_END, NOTHING_ALONG, Along, drawn, lay_along
from maulstick.storage.arrays import Complexes, Floats, Ints
from maulstick.strokes.strokes import path_lengths
from maulstick.style import Style
from maulstick.style.arrangement import Arrangement
from maulstick.style.traits import path_length


class ArrangedStart:
    """New strokes for a planning problem, of one hand at a time. All random numbers come from the two generators.

    spacing: metres between strokes.
    """

    def __init__(
        self, problem: PlanningProblem, spacing: float, rng: np.random.Generator, torch_rng: Generator
    ) -> None:
        self._problem, self._rng, self._torch_rng = problem, rng, torch_rng
        self._scale = problem.canvas.pixels_per_metre
        self._room = spacing * self._scale
        self._directions: tuple[Tensor, complex, Complexes] | None = None  # the last, since each ink takes the same

    def strokes(
        self,
        hand: Style,
        target: Tensor,
        density: Floats,
        count: int,
        like: Tensor | None = None,
        lines: Sequence[Floats] = (),
    ) -> StrokeParameters:
        """Return `count` strokes of a hand, with its own codes, spread by the density (H, W) on a target (C, H, W).

        lines: those that the hand's strokes are laid along, as `traced` returns them, before groups fill the rest.
        like: as in `start_strokes`, of strokes that lie alone instead.
        """
        arrangement = hand.arrangement
        assert arrangement is not None
        alone = None if like is None else hand.nearest(like)
        groups = choose_groups(arrangement, count, self._rng) if alone is None else list(alone[:, None].numpy())
        along = self._along(lines, density, arrangement, groups)
        places, rows = place_groups(
            as_array(target),
            self._directions_of(target, arrangement.leaning),
            density,
            arrangement,
            without(groups, along.rows),
            self._room,
            self._scale,
            self._rng,
            along,
        )
        codes, knots = hand.sample_around(torch.from_numpy(rows), self._torch_rng)
        if on_lines := len(along.rows):  # as long as what was laid there, or its laps would change
            laid, own = path_lengths(along.paths) / self._scale, path_length(hand.decode(codes[:on_lines]).detach())
            hand.resize(codes[:on_lines], torch.from_numpy(laid).to(own), own)
        return strokes_at(places, codes, knots, self._problem.brushes[0], self._scale)

    def _along(
        self, lines: Sequence[Floats], density: Floats, arrangement: Arrangement, groups: Sequence[Ints]
    ) -> Along:
        """Lay those of the groups' strokes along lines that fit them, where any are wanted, joined as the hand does."""
        here = drawn(lines, density)
        if not here:
            return NOTHING_ALONG
        counts = np.bincount(np.concatenate(groups), minlength=len(arrangement.paths))
        seen = arrangement.laps
        laps = map(self._rng.choice, repeat(seen)) if len(seen) else END_TO_END
        return lay_along(here, arrangement.paths * self._scale, counts, laps)

    def _directions_of(self, target: Tensor, leaning: complex) -> Complexes:
        """Return the directions (H, W) of a target that the groups of a hand are turned along which leans so."""
        if self._directions is None or self._directions[0] is not target or self._directions[1] != leaning:
            found = directions(as_array(target), self._room, leaning)
            if self._problem.guides is not None:
                found = self._problem.guides.over(found)
            self._directions = target, leaning, found
        return self._directions[2]
