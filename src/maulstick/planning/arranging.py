"""Holding a plan's strokes arranged as a hand arranges its strokes, with any pen and any picture."""

import torch
from torch import Generator, Tensor

from maulstick.planning.parameters import StrokeParameters
from maulstick.style import Style
from maulstick.style.arrangement import Arrangement
from maulstick.style.arrangement.neighbourhoods import NEAREST, Laid

_WEIGHT = 3e-3  # beside a loss of tones; a third of it leaves groups apart


class Arranging:
    """The price of strokes that lie otherwise beside each other than the hand's.

    strokes: that a plan begins with, as dense as they will be.  share: in [0, 1], of the price.
    """

    def __init__(self, arrangement: Arrangement, style: Style, strokes: StrokeParameters, share: float) -> None:
        self._style, self._weight = style, _WEIGHT * share
        self._neighbourhoods = arrangement.neighbourhoods.crowded(self._laid(strokes).density())

    def price(self, strokes: StrokeParameters, torch_rng: Generator) -> Tensor:
        """Return the weighted price of where strokes lie and how they are turned; of their shapes as they are."""
        if len(strokes) <= NEAREST:
            return torch.zeros(())
        return self._weight * self._neighbourhoods.price(self._laid(strokes), torch_rng)

    def _laid(self, strokes: StrokeParameters) -> Laid:
        return Laid.of(self._style.decode(strokes.codes).detach(), strokes.centres, strokes.angles)
