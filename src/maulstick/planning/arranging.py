"""Holding a plan's strokes arranged as a hand arranges its strokes, with any pen and any picture."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Generator, Tensor

from maulstick.planning.directions import directions
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.placement import at_pixels
from maulstick.planning.problem import PlanningProblem
from maulstick.planning.stroke_canvas import as_array
from maulstick.storage.arrays import Complexes
from maulstick.style import Style
from maulstick.style.arrangement import Arrangement
from maulstick.style.arrangement.laid import NEAREST, Laid
from maulstick.style.traits import quantiles

_WEIGHT = 3e-3  # beside a loss of tones; a third of it leaves groups apart


class Arranging:
    """The price of strokes that lie otherwise beside each other, and on the picture, than their hands'.

    strokes: that a plan begins with, as dense as they will be.  ink_of: (N,), their inks.
    spacing: metres between them.  share: in [0, 1], of the price.
    densities: what the same plan had before it was interrupted, since its strokes have moved.
    The strokes of each ink are arranged among themselves, as they are drawn. A region's strokes count as many as they
    are; of those whose hand's arrangement is not known nothing is asked.
    """

    def __init__(
        self,
        problem: PlanningProblem,
        strokes: StrokeParameters,
        ink_of: Tensor,
        spacing: float,
        share: float,
        densities: NDArray[np.generic] | None = None,
    ) -> None:
        self._regions, self._weight = problem.regions, _WEIGHT * share
        self._rows = {ink: (ink_of == ink).nonzero()[:, 0] for ink in ink_of.unique().tolist()}
        hands = [problem.style] if self._regions is None else [region.hand for region in self._regions.said]
        if densities is None:
            found = [
                (*part, _laid(hands[part[0]], own).density())
                for part, own in self._parts(strokes)
                if hands[part[0]].arrangement is not None
            ]
            densities = np.array(found).reshape(-1, 3)
        self.densities = densities
        """How densely strokes lay at the beginning, (k, 3): rows of hand, ink and density."""
        known = {(int(number), int(ink)): density for number, ink, density in densities.tolist()}
        scale, lines = problem.canvas.pixels_per_metre, _Lines(problem, spacing)
        self._hands = {
            (number, ink): _ArrangedHand(hands[number], arrangement, density, scale, lines)
            for (number, ink), density in known.items()
            if (arrangement := hands[number].arrangement) is not None
        }

    def price(self, strokes: StrokeParameters, torch_rng: Generator) -> Tensor:
        """Return the weighted price of where strokes lie and how they are turned; of their shapes as they are."""
        price = torch.zeros(())
        for part, own in self._parts(strokes):
            if part in self._hands and len(own) > NEAREST:
                price = price + len(own) / len(strokes) * self._hands[part].price(own, torch_rng)
        return self._weight * price

    def _parts(self, strokes: StrokeParameters) -> Iterator[tuple[tuple[int, int], StrokeParameters]]:
        """Yield the strokes of each hand and ink that has any, with the hand's own codes."""
        for ink, rows in self._rows.items():
            own = strokes if len(self._rows) == 1 else _of_rows(strokes, rows)
            if self._regions is None:
                yield (0, ink), own
                continue
            style = self._regions.style
            hand_of = style.regions_of(own.codes)  # relocation may change it
            for number in hand_of.unique().tolist():
                part = _of_rows(own, hand_of == number)
                yield (number, ink), replace(part, codes=style.own_codes(part.codes, number))


def _of_rows(strokes: StrokeParameters, rows: Tensor) -> StrokeParameters:
    """Return some of the strokes, through which slopes go back."""
    return StrokeParameters(**{name: tensor[rows] for name, tensor in strokes.each().items()})


class _Lines:
    """The picture's lines, (H, W), for each way that a hand leans; spacing: metres between strokes."""

    def __init__(self, problem: PlanningProblem, spacing: float) -> None:
        self._problem, self._spacing = problem, spacing
        self._known: dict[complex, Complexes] = {}

    def of(self, leaning: complex) -> Complexes:
        """Return those of a hand that leans so."""
        if leaning not in self._known:
            problem = self._problem
            picture = problem.paper if problem.target is None else problem.target
            lines = directions(as_array(picture), self._spacing * problem.canvas.pixels_per_metre, leaning)
            self._known[leaning] = lines if problem.guides is None else problem.guides.over(lines)
        return self._known[leaning]


class _ArrangedHand:
    """What a hand's arrangement asks of its strokes, which lie so densely at the beginning."""

    def __init__(
        self,
        hand: Style,
        arrangement: Arrangement,
        density: float,
        pixels_per_metre: float,
        lines: _Lines,
    ) -> None:
        self._hand, self._scale, self._lines = hand, pixels_per_metre, lines.of(arrangement.leaning)
        self._neighbourhoods = arrangement.neighbourhoods.crowded(density)
        self._alignments = torch.from_numpy(arrangement.alignments)

    def price(self, strokes: StrokeParameters, torch_rng: Generator) -> Tensor:
        """Return the price of the hand's strokes."""
        laid = _laid(self._hand, strokes)
        return self._neighbourhoods.price(laid, torch_rng) + self._misaligned(laid)

    def _misaligned(self, laid: Laid) -> Tensor:
        """Return how far strokes are from lying along the picture's lines as the hand's lie along their groups.

        Squared Wasserstein distance, where lines are sure.
        """
        height, width = self._lines.shape
        lines = torch.from_numpy(self._lines[at_pixels(self._scale * laid.centres.detach().numpy(), width, height)])
        along, order = (laid.straightness * (2 * laid.axes - lines.angle()).cos()).sort()
        wanted = torch.quantile(self._alignments, quantiles(len(along)))
        return (lines.abs()[order] * (along - wanted).square()).mean()


def _laid(hand: Style, strokes: StrokeParameters) -> Laid:
    return Laid.of(hand.decode(strokes.codes).detach(), strokes.centres, strokes.angles)
