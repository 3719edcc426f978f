"""New strokes between a hand's own: each is moved by parts of the differences to the strokes most like it."""

from dataclasses import dataclass
from functools import cached_property

import torch
from torch import Generator, Tensor

# Chosen by benchmarks/style_choices.py.
_NEIGHBOURS = 3  # the distance to so many is how far a stroke's neighbourhood reaches
_FARTHEST = 2.0  # times the usual reach: a stroke that is alone of its kind is not mixed with other kinds
_UNIT = 3**0.5  # bound of a uniform number of standard deviation 1, which unlike a normal one has no tails
_SAME = 1e-9  # keeps the reach among equal strokes out of the denominators


@dataclass(frozen=True)
class Neighbours:
    """Codes (M, d) of a hand's strokes, in units in which distances between strokes are measured.

    A sample takes a share of a stroke and the rest of the mean and the covariance of the strokes near it (Vincent and
    Bengio: Manifold Parzen Windows), so that a hand that draws several kinds of strokes has samples of these kinds and
    of no others, which vary as much as its own strokes do.

    centres: (M, d).  bandwidths: (d,), in [0, 1]: with 0 a sample is the stroke, with 1 any of those near it.
    """

    centres: Tensor
    bandwidths: Tensor

    def sample(self, k: int, generator: Generator) -> tuple[Tensor, Tensor]:
        """Draw k codes (k, d), and return the index of the stroke that each was drawn around, (k,)."""
        around = torch.randint(len(self.centres), (k,), generator=generator)
        uniform = torch.rand(k, len(self.centres), generator=generator).to(self.centres)
        shares = (2 * uniform - 1) * _UNIT * self.weights[around].sqrt()
        own, mean = self.centres[around], self._means[around]
        differs = shares @ self.centres - shares.sum(1, keepdim=True) * mean
        return mean + (1 - self.bandwidths.square()).sqrt() * (own - mean) + self.bandwidths * differs, around

    @cached_property
    def _means(self) -> Tensor:
        """Mean (M, d) of the strokes near each, and of itself as far as they are few."""
        return self.centres + self.weights @ self.centres - self.weights.sum(1, keepdim=True) * self.centres

    @cached_property
    def weights(self) -> Tensor:
        """Weight (M, M) of each stroke as a neighbour of each other: a row adds up to 1, or less where none is near."""
        apart = torch.cdist(self.centres, self.centres, compute_mode="donot_use_mm_for_euclid_dist")
        reach = apart.sort(dim=1).values[:, min(_NEIGHBOURS, len(apart) - 1)]
        reach = reach.clamp(max=_FARTHEST * float(reach.median())) + _SAME
        weights = (-(apart / reach[:, None]).square() / 2).exp().fill_diagonal_(0)
        return weights / weights.sum(1, keepdim=True).clamp(min=1)
