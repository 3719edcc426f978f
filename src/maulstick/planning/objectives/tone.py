"""Tone: a loss that compares the colours of canvas and picture, pixel by pixel and blurred."""

import torch
from torch import Tensor
from torch.nn.functional import conv2d, pad

from maulstick.planning.objectives.objective import Objective


class Tone(Objective):
    """Squared difference from the target (C, H, W), channel by channel, on a pyramid of halved images.

    weights: (H, W), how much each pixel counts.

    Coarse levels weigh most at first and fade by the middle of planning. With `halftone` they stay, and the finest
    fades instead: one ink makes greys by the distance between its lines, which only coarse levels show.
    """

    def __init__(self, target: Tensor, weights: Tensor, *, halftone: bool = False, levels: int | None = None) -> None:
        self._target = target
        self._scale = weights.sqrt()
        self._levels = levels or max(1, min(target.shape[1:]).bit_length() - 4)
        self._halftone = halftone

    @property
    def name(self) -> str:
        """Name of the term: ``tone``."""
        return "tone"

    def loss(self, canvas: Tensor, progress: float) -> Tensor:
        """Return the mean squared difference, averaged over the levels."""
        coarse = 1.0 if self._halftone else max(0.0, 1 - 2 * progress)
        difference = (canvas - self._target) * self._scale
        total = 0.2 if self._halftone else 1.0
        loss = total * difference.square().mean()
        for level in range(1, self._levels if coarse > 0 else 1):
            difference = halved(difference)
            weight = coarse * (1.0 if self._halftone else 2.0**level)
            loss = loss + weight * difference.square().mean()
            total += weight
        return loss / total


def halved(image: Tensor) -> Tensor:
    """Return the image (C, H, W) at half its size, each pixel a binomial average (Burt and Adelson's pyramid).

    Averages over squares would reward lines that run along rows and columns.
    """
    taps = torch.tensor([1.0, 4.0, 6.0, 4.0, 1.0], dtype=image.dtype, device=image.device) / 16
    rows = pad(image[:, None], (0, 0, 2, 2), mode="replicate")
    rows = conv2d(rows, taps[None, None, :, None], stride=(2, 1))
    columns = pad(rows, (2, 2, 0, 0), mode="replicate")
    return conv2d(columns, taps[None, None, None, :], stride=(1, 2))[:, 0]
