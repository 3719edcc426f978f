"""Tone: a loss that compares the colours of canvas and picture, pixel by pixel and blurred."""

from math import log2

import torch
from scipy.ndimage import gaussian_filter
from torch import Tensor
from torch.nn.functional import conv2d, pad

from maulstick.planning.objectives.objective import Objective

_AROUND = 1 / 64  # of the height: a Gaussian's standard deviation, against which a place is dark or light
_CONTOURS = 0.3  # how much contours count beside tones; chosen by eye on mocap hands: 0.1 hardly shows, 0.5 is outlines


class Tone(Objective):
    """Squared difference from the target (C, H, W), channel by channel, on a pyramid of halved images.

    weights: (H, W), how much each pixel counts.

    Coarse levels weigh most at first and fade by the middle of planning.
    """

    def __init__(self, target: Tensor, weights: Tensor) -> None:
        self._target = target
        self._scale = weights.sqrt()
        self._levels = levels_of(target)

    @property
    def name(self) -> str:
        """Name of the term: ``tone``."""
        return "tone"

    def loss(self, canvas: Tensor, progress: float) -> Tensor:
        """Return the mean squared difference, averaged over the levels."""
        coarse = max(0.0, 1 - 2 * progress)
        difference = (canvas - self._target) * self._scale
        total, loss = 1.0, difference.square().mean()
        for level in range(1, self._levels if coarse > 0 else 1):
            difference = halved(difference)
            weight = coarse * 2.0**level
            loss = loss + weight * difference.square().mean()
            total += weight
        return loss / total


class Halftone(Objective):
    """Tone of one ink, whose greys are made of the distance between lines, and contours beside it.

    target: (C, H, W).  weights: (H, W), how much each pixel counts.  spacing: pixels between lines in usual greys.
    picture: (C, H, W), whose contours count beside tones: the target, or what it was in its own tones.

    Squared differences are those of halved images alone whose pixels hold a line: finer ones tell a line from paper,
    and would pay for leaving it out. What they could show is asked for otherwise: ink where the picture is darker than
    around it earns as much as ink where it is lighter costs, so contours draw lines to them and the tone stays.
    """

    def __init__(self, target: Tensor, weights: Tensor, spacing: float, picture: Tensor | None = None) -> None:
        self._target, self._scale = target, weights.sqrt()
        last = levels_of(target) - 1
        self._levels = range(max(0, min(round(log2(max(spacing, 1))), last)), last + 1)
        self._relief = torch.zeros_like(target)
        if picture is not None:
            sigma = _AROUND * picture.shape[1]
            around = gaussian_filter(picture.cpu().numpy(), (0, sigma, sigma))
            self._relief = (picture - torch.from_numpy(around).to(picture)) * weights

    @property
    def name(self) -> str:
        """Name of the term: ``tone``."""
        return "tone"

    def loss(self, canvas: Tensor, progress: float) -> Tensor:
        """Return the mean squared difference, averaged over the levels, less what contours earn."""
        difference, total = (canvas - self._target) * self._scale, canvas.new_zeros(())
        for level in range(self._levels.stop):
            if level in self._levels:
                total = total + difference.square().mean()
            difference = halved(difference)
        contours = ((canvas - self._target) * self._relief).mean()
        return total / len(self._levels) - 2 * _CONTOURS * contours


def levels_of(image: Tensor) -> int:
    """Return how many levels the pyramid of an image (C, H, W) has; the coarsest is some 16 pixels high."""
    return max(1, min(image.shape[1:]).bit_length() - 4)


def halved(image: Tensor) -> Tensor:
    """Return the image (C, H, W) at half its size, each pixel a binomial average (Burt and Adelson's pyramid).

    Averages over squares would reward lines that run along rows and columns.
    """
    taps = torch.tensor([1.0, 4.0, 6.0, 4.0, 1.0], dtype=image.dtype, device=image.device) / 16
    rows = pad(image[:, None], (0, 0, 2, 2), mode="replicate")
    rows = conv2d(rows, taps[None, None, :, None], stride=(2, 1))
    columns = pad(rows, (2, 2, 0, 0), mode="replicate")
    return conv2d(columns, taps[None, None, None, :], stride=(1, 2))[:, 0]
