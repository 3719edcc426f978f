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

    A sample is a stroke moved by random parts of the differences to the strokes near it, so that it varies as those do
    (Vincent and Bengio: Manifold Parzen Windows): a hand that draws several kinds of strokes has samples of these kinds
    and of no others.

    centres: (M, d).  bandwidths: (d,), standard deviations of samples, in those of the strokes near one.  kept: (d,),
    share of a stroke's own difference from the mean of those near it; (1 - bandwidth²)^½ where samples may not vary
    more than the hand's strokes.
    """

    centres: Tensor
    bandwidths: Tensor
    kept: Tensor

    def sample(self, around: Tensor, generator: Generator) -> Tensor:
        """Draw a code around each of the strokes `around` (k,), (k, d)."""
        uniform = torch.rand(len(around), len(self.centres), generator=generator).to(self.centres)
        shares = (2 * uniform - 1) * _UNIT * self.weights[around].sqrt()
        mean = self._means[around]
        middle = mean + self.kept * (self.centres[around] - mean)
        differences = shares @ self.centres - shares.sum(1, keepdim=True) * middle
        return middle + self.bandwidths * differences

    def nearest(self, codes: Tensor) -> Tensor:
        """Return the strokes (N,) that codes (N, d) were most likely drawn around: distances are in bandwidths."""
        apart = torch.cdist(codes.to(self.centres) / self.bandwidths, self.centres / self.bandwidths)
        return apart.argmin(dim=1)

    @cached_property
    def _means(self) -> Tensor:
        """Mean (M, d) of the strokes near each, and of itself as far as they are few."""
        return self.centres + self.weights @ self.centres - self.weights.sum(1, keepdim=True) * self.centres

    @cached_property
    def weights(self) -> Tensor:
        """Weight (M, M) of each stroke as a neighbour of each other: a row adds up to 1, or less where none is near."""
        apart = torch.cdist(self.centres, self.centres, compute_mode="donot_use_mm_for_euclid_dist")
        reach = apart.topk(min(_NEIGHBOURS, len(apart) - 1) + 1, dim=1, largest=False).values[:, -1]
        reach = reach.clamp(max=_FARTHEST * float(reach.median())) + _SAME
        weights = apart.div_(reach[:, None]).square_().div_(-2).exp_().fill_diagonal_(0)  # in place: M² may be 1 GB
        return weights.div_(weights.sum(1, keepdim=True).clamp(min=1))
