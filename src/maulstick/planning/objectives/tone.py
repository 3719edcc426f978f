"""Tone: a loss that compares the colours of canvas and picture, pixel by pixel and blurred."""

from math import log2

import torch
from scipy.ndimage import gaussian_filter
from torch import Tensor

from maulstick.planning.objectives.objective import Objective
from maulstick.planning.objectives.pyramid import MeanSquares, levels_of

_AROUND = 1 / 64  # of the height: a Gaussian's standard deviation, against which a place is dark or light
_CONTOURS = 0.3  # how much contours count beside tones; chosen by eye on mocap hands: 0.1 hardly shows, 0.5 is outlines


class Tone(Objective):
    """Squared difference from the target (C, H, W), channel by channel, on a pyramid of halved images.

    weights: (H, W), how much each pixel counts.

    Coarse levels weigh most at first and fade over the first quarter of planning.
    """

    def __init__(self, target: Tensor, weights: Tensor) -> None:
        self._mean_squares, self._levels = MeanSquares(target, weights.sqrt()), levels_of(target)

    @property
    def name(self) -> str:
        """Name of the term: ``tone``."""
        return "tone"

    def loss(self, canvas: Tensor, progress: float) -> Tensor:
        """Return the mean squared difference, averaged over the levels."""
        coarse = max(0.0, 1 - 4 * progress)
        weights = [1.0]
        if coarse > 0:
            weights += [coarse * 2.0**level for level in range(1, self._levels)]
        return self._mean_squares(canvas, [weight / sum(weights) for weight in weights])


def towards_contours(picture: Tensor) -> Tensor:
    """Return the slope (C, H, W) of a canvas that is pulled to the contours of a picture (C, H, W) in its own tones.

    Ink where the picture is darker than around it earns as much as ink where it is lighter costs, so contours draw
    lines to them and the tone stays.
    """
    sigma = _AROUND * picture.shape[1]
    around = gaussian_filter(picture.cpu().numpy(), (0, sigma, sigma))
    return -2 * _CONTOURS * (picture - torch.from_numpy(around).to(picture))


class Halftone(Objective):
    """Tone of inks, whose tones are made of the distance between lines, and what it is pulled to beside it.

    target: (C, H, W).  weights: (H, W), how much each pixel counts.  spacing: pixels between lines in usual greys.
    pull: (C, H, W), the slope of what counts beside, as `towards_contours` and `Tones.away_from_lights` return it.

    Squared differences are those of halved images alone whose pixels hold a line: finer ones tell a line from paper,
    and would pay for leaving it out. What they could show is left to the pull.
    """

    def __init__(self, target: Tensor, weights: Tensor, spacing: float, pull: Tensor | None = None) -> None:
        self._mean_squares = MeanSquares(target, weights.sqrt(), None if pull is None else pull * weights)
        last = levels_of(target) - 1
        first = max(0, min(round(log2(max(spacing, 1))), last))
        self._weights = [0.0] * first + [1 / (last + 1 - first)] * (last + 1 - first)

    @property
    def name(self) -> str:
        """Name of the term: ``tone``."""
        return "tone"

    def loss(self, canvas: Tensor, progress: float) -> Tensor:
        """Return the mean squared difference, averaged over the levels, and the mean product with the pull."""
        return self._mean_squares(canvas, self._weights)
