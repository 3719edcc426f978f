"""Strokes that models of strokes are trained and tested with: five splits of each dataset, with a test of another kind.

The Sharpie's 330 strokes are cut into five parts at random, dots too: four train, the fifth tests. Out of distribution,
four fifths at random of the half that bends least train, and the third that bends most tests. All are of one style.

The media of libmypaint: 300 strokes of a generic style in five parts, of which four train and one tests; out of
distribution 150 strokes of four other styles, which no model has seen (the paper's dataset B).
"""

from dataclasses import dataclass

import numpy as np
import torch
from media import GENERIC, SPECIAL, mypaint_trials, sharpie_trials
from scipy.ndimage import binary_dilation, label
from torch import Tensor
from training import Examples

from maulstick.brush_fit.selection import bend
from maulstick.brush_fit.trials import Trial
from maulstick.rendering.kernels.cpu import darkness

SPLITS = 5
GENERIC_STROKES, UNSEEN = 300, 150
SPECK, SPECK_APART, SPECK_EDGE = 0.15, 2.5e-3, 2  # darkness, metres, pixels


@dataclass(frozen=True)
class Data:
    """Strokes alone on images of one size and scale."""

    examples: Examples
    pixels_per_metre: float

    def __len__(self) -> int:
        return len(self.examples)

    def pick(self, which: Tensor) -> "Data":
        """Those of these indices (M,)."""
        return Data(self.examples.pick(which), self.pixels_per_metre)

    @property
    def window(self) -> float:
        """What an image shows, square metres."""
        return self.examples.darkness[0].numel() / self.pixels_per_metre**2

    def bends(self) -> Tensor:
        """How far each stroke bends, metres (N,)."""
        return torch.tensor([bend(path) for path in self.examples.paths.numpy()]) / self.pixels_per_metre

    def trials(self) -> list[Trial]:
        """What a brush is fitted to; blank paper where pixels do not count."""
        paths = self.examples.paths.double().numpy() / (self.pixels_per_metre, self.pixels_per_metre, 1)
        images = (self.examples.weights * self.examples.darkness)[..., None].numpy()
        rows = enumerate(zip(paths, images, strict=True), start=1)
        return [Trial(f"stroke {i}", path, np.zeros_like(image), image) for i, (path, image) in rows]


@dataclass(frozen=True)
class Training:
    """What a model is trained with, and what it is then tested with: strokes of the same kind, or another, or both."""

    train: Data
    inside: Data | None = None
    outside: Data | None = None


def splits_of(dataset: str) -> list[list[Training]]:
    """For each of `SPLITS` splits, the trainings that it takes; the one with a test of another kind is the last."""
    if dataset == "sharpie":
        data = data_of(*sharpie_trials())
        flattest = data.bends().argsort()
        flat, bent = flattest[: len(data) // 2], data.pick(flattest[-(len(data) // 3) :])
        return [
            [Training(data.pick(others), inside=data.pick(part)), Training(data.pick(flat[flat_others]), outside=bent)]
            for (others, part), (flat_others, _) in zip(_parts(len(data)), _parts(len(flat)), strict=True)
        ]
    generic = data_of(*mypaint_trials(dataset, GENERIC, GENERIC_STROKES, seed=0))
    other = data_of(*mypaint_trials(dataset, SPECIAL, UNSEEN, seed=1))
    return [[Training(generic.pick(others), generic.pick(part), other)] for others, part in _parts(len(generic))]


def _parts(count: int) -> list[tuple[Tensor, Tensor]]:
    """For each split the indices of the strokes that train, and of those that test; every stroke tests once."""
    parts = torch.randperm(count, generator=torch.Generator().manual_seed(0)).tensor_split(SPLITS)
    return [(torch.cat([*parts[:i], *parts[i + 1 :]]), part) for i, part in enumerate(parts)]


def data_of(trials: list[Trial], pixels_per_metre: float) -> Data:
    """Darkness images, as networks want them, and where a speck is.

    A speck is connected darkness that lies wholly further than 2.5 mm from the path: a neighbouring stroke's. It counts
    nowhere, with 2 pixels around it, and no model sees it.
    """
    paths = np.stack([trial.path for trial in trials]) * (pixels_per_metre, pixels_per_metre, 1)
    images = np.stack([trial.after[..., 0] for trial in trials])
    examples = Examples(torch.from_numpy(paths).float(), torch.from_numpy(images).float(), torch.ones(images.shape))
    apart = torch.full(examples.paths.shape[:2], SPECK_APART * pixels_per_metre)
    neutral = torch.ones(1), torch.zeros(1), torch.ones(1)
    near = darkness(examples.paths[..., :2], apart, *neutral, height=images.shape[1], width=images.shape[2]) > 0
    for weights, image, around in zip(examples.weights, images, near.numpy(), strict=True):
        parts, _ = label(image > SPECK, structure=np.ones((3, 3)))
        specks = (parts > 0) & ~np.isin(parts, parts[around])
        weights[torch.from_numpy(binary_dilation(specks, iterations=SPECK_EDGE))] = 0
    return Data(examples, pixels_per_metre)
