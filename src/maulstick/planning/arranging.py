"""Holding a plan's strokes arranged as a hand arranges its strokes, with any pen and any picture."""

from dataclasses import replace

import torch
from torch import Generator, Tensor

from maulstick.planning.directions import directions
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.placement import at_pixels
from maulstick.planning.problem import PlanningProblem
from maulstick.planning.stroke_canvas import as_array
from maulstick.style import Style
from maulstick.style.arrangement import Arrangement
from maulstick.style.arrangement.laid import NEAREST, Laid
from maulstick.style.traits import quantiles

_WEIGHT = 3e-3  # beside a loss of tones; a third of it leaves groups apart


class Arranging:
    """The price of strokes that lie otherwise beside each other, and on the picture, than their hands'.

    strokes: that a plan begins with, as dense as they will be.  ink_of: (N,), their inks.
    spacing: metres between them.  share: in [0, 1], of the price.
    The strokes of each ink are arranged among themselves, as they are drawn. A region's strokes count as many as they
    are; of those whose hand's arrangement is not known nothing is asked.
    """

    def __init__(
        self, problem: PlanningProblem, strokes: StrokeParameters, ink_of: Tensor, spacing: float, share: float
    ) -> None:
        self._regions, self._weight = problem.regions, _WEIGHT * share
        hands = [problem.style] if self._regions is None else [region.hand for region in self._regions.said]
        self._hands = {
            (number, ink): _ArrangedHand(hands[number], arrangement, problem, own, spacing)
            for (number, ink), own in self._parts(strokes, ink_of).items()
            if (arrangement := hands[number].arrangement) is not None
        }

    def price(self, strokes: StrokeParameters, ink_of: Tensor, torch_rng: Generator) -> Tensor:
        """Return the weighted price of where strokes lie and how they are turned; of their shapes as they are."""
        price = torch.zeros(())
        for part, own in self._parts(strokes, ink_of).items():
            if part in self._hands and len(own) > NEAREST:
                price = price + len(own) / len(strokes) * self._hands[part].price(own, torch_rng)
        return self._weight * price

    def _parts(self, strokes: StrokeParameters, ink_of: Tensor) -> dict[tuple[int, int], StrokeParameters]:
        """Return the strokes of each hand and ink that has any, with the hand's own codes."""
        hand_of = torch.zeros_like(ink_of) if self._regions is None else self._regions.style.regions_of(strokes.codes)
        found = {}
        for number, ink in torch.stack([hand_of, ink_of], dim=1).unique(dim=0).tolist():
            rows = (hand_of == number) & (ink_of == ink)
            own = StrokeParameters(**{name: tensor[rows] for name, tensor in strokes.each().items()})  # with gradients
            codes = own.codes if self._regions is None else self._regions.style.own_codes(own.codes, number)
            found[number, ink] = replace(own, codes=codes)
        return found


class _ArrangedHand:
    """What a hand's arrangement asks of its strokes."""

    def __init__(
        self,
        hand: Style,
        arrangement: Arrangement,
        problem: PlanningProblem,
        strokes: StrokeParameters,
        spacing: float,
    ) -> None:
        self._hand = hand
        self._neighbourhoods = arrangement.neighbourhoods.crowded(self._laid(strokes).density())
        self._alignments = torch.from_numpy(arrangement.alignments)
        self._scale = problem.canvas.pixels_per_metre
        picture = problem.paper if problem.target is None else problem.target
        self._lines = directions(as_array(picture), spacing * self._scale, arrangement.leaning)
        if problem.guides is not None:
            self._lines = problem.guides.over(self._lines)

    def price(self, strokes: StrokeParameters, torch_rng: Generator) -> Tensor:
        """Return the price of the hand's strokes."""
        laid = self._laid(strokes)
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

    def _laid(self, strokes: StrokeParameters) -> Laid:
        return Laid.of(self._hand.decode(strokes.codes).detach(), strokes.centres, strokes.angles)
