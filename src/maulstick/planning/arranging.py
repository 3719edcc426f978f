"""Holding a plan's strokes arranged as a hand arranges its strokes, with any pen and any picture."""

from math import exp

import torch
from torch import Generator, Tensor

from maulstick.planning.parameters import StrokeParameters
from maulstick.style import Style
from maulstick.style.arrangement import Arrangement
from maulstick.style.arrangement.neighbourhoods import NEAREST, Laid, Neighbourhoods

_WEIGHT = 1e-5  # least weight, and the first: next to nothing beside a loss of tones
_MOST_WEIGHT = 0.3  # a hand's spacing may be out of reach: so many strokes on so small a sheet
# Median strokes, in spacings: up to the first groups are rigid; from the second on they would cover too much of a
# picture, and each stroke moves alone.
_RIGID, _FREE = 3.0, 10.0
_WEIGHT_GROWTH = 30.0  # exponent of the weight per plan while strokes lie twice as far from the hand as usual


class Arranging:
    """The price of strokes that lie otherwise beside each other than the hand's, and its weight.

    The weight grows while they lie farther from the hand than halves of its own drawing from each other, and falls
    afterwards.
    share: in [0, 1], of the price.
    """

    def __init__(self, arrangement: Arrangement, style: Style, share: float) -> None:
        self._style, self._share, self.weight = style, share, _WEIGHT
        paths = torch.from_numpy(arrangement.paths)
        laid = Laid.of(paths, paths.mean(dim=1), paths.new_zeros(len(paths)))
        self._neighbourhoods = Neighbourhoods.of(laid)

    def together(self, spacing: float) -> float:
        """Share in [0, 1] of a step that strokes take as groups, for so many metres between strokes.

        The longer strokes are, the less an arrangement feels a step of the same length, and the more the picture does.
        """
        alone = (self._neighbourhoods.unit / spacing - _RIGID) / (_FREE - _RIGID)
        return self._share * (1 - min(max(alone, 0.0), 1.0))

    def price(self, strokes: StrokeParameters, stride: float, torch_rng: Generator) -> Tensor:
        """Return the weighted price of the strokes, and change the weight for a step of this share of the plan."""
        if len(strokes) <= NEAREST:
            return torch.zeros(())
        paths = self._style.decode(strokes.codes).detach()
        far = self._neighbourhoods.price(Laid.of(paths, strokes.centres, strokes.angles), torch_rng)
        price = self._share * self.weight * far
        excess = min(far.item() / self._neighbourhoods.usual - 1, 1.0)
        grown = self.weight * exp(_WEIGHT_GROWTH * stride * excess)
        self.weight = min(max(grown, _WEIGHT), _MOST_WEIGHT)
        return price
