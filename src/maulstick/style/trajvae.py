"""TrajVAE (paper): a variational autoencoder of strokes, pretrained on many hands and fine-tuned on one.

The published loss adds squared metres and nats and collapses: only one latent of 64 carries information. Here the
network sees the numbers of `style.shape`, standardised, and errors are relative to the length of the stroke.
"""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from math import log
from typing import Any, Self

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Generator, Tensor
from torch.nn.functional import linear, silu

from maulstick.errors import InputError
from maulstick.storage.arrays import Floats
from maulstick.style import shape
from maulstick.style.arrangement import Arrangement
from maulstick.style.exemplar import Exemplar
from maulstick.style.hand import Hand, by_length
from maulstick.style.neighbours import Neighbours
from maulstick.style.pooled import PooledHands
from maulstick.style.shape import GIST, RESIDUAL
from maulstick.style.style import Style
from maulstick.style.traits import path_length

Weights = dict[str, Tensor]
"""Tensors of a network: layers, mean and unit of its input, and statistics of the hands that it was pretrained on."""

LATENT = 64
"""Number of latents, as in the paper."""

HIDDEN = 256
"""Width of the hidden layers."""

_NUMBERS = GIST + RESIDUAL  # of a stroke: the network's input and output
_COARSE = 16  # latents of the coarse shape: training starts at the principal components, largest first, and keeps order
_BANDWIDTH_COARSE, _BANDWIDTH_FINE = 0.2, 0.2  # of samples (`Neighbours`); chosen on human drawings
_ACTIVE = 0.01  # variance of an active latent's mean (Burda et al.)
_NEWTON_STEPS = 2  # towards a length: log length is nearly linear in the latents
_PREFIX = "net."  # of the names of a network's arrays in a style's file


def shapes() -> dict[str, tuple[int, ...]]:
    """Return the shape of each tensor of a network by its name."""
    layers = {"encoder": (_NUMBERS, HIDDEN, HIDDEN, 2 * LATENT), "decoder": (LATENT, HIDDEN, HIDDEN, _NUMBERS)}
    named: dict[str, tuple[int, ...]] = {"centre": (_NUMBERS,), "unit": (_NUMBERS,)}
    for part, sizes in layers.items():
        for i, (came, goes) in enumerate(pairwise(sizes)):
            named |= {f"{part}.{i}.weight": (goes, came), f"{part}.{i}.bias": (goes,)}
    named |= {"encoder.straight": (LATENT, _NUMBERS), "decoder.straight": (_NUMBERS, LATENT)}
    return named | {"hands.covariance": (GIST + 1, GIST + 1), "hands.residual": (RESIDUAL,)}


def posterior(weights: Weights, numbers: Tensor) -> tuple[Tensor, Tensor]:
    """Return mean and log variance, both (N, 64), of the latents of strokes' numbers (N, 63)."""
    standard = (numbers - weights["centre"]) / weights["unit"]
    mean, log_variance = _layers(weights, "encoder", standard).split(LATENT, dim=1)
    return mean + linear(standard, weights["encoder.straight"]), log_variance


def numbers_of(weights: Weights, latents: Tensor) -> Tensor:
    """Return strokes' numbers (N, 63) (`style.shape`) of latents (N, 64)."""
    standard = _layers(weights, "decoder", latents) + linear(latents, weights["decoder.straight"])
    return standard * weights["unit"] + weights["centre"]


def _layers(weights: Weights, part: str, x: Tensor) -> Tensor:
    for i in (0, 1):
        x = silu(linear(x, weights[f"{part}.{i}.weight"], weights[f"{part}.{i}.bias"]))
    return linear(x, weights[f"{part}.2.weight"], weights[f"{part}.2.bias"])


@dataclass(frozen=True, repr=False)
class TrajVAE(Style):
    """Style of a hand by a network: a code is the posterior mean of a stroke's latents; their prior is standard normal.

    Beyond the paper, samples are drawn between the latents of the hand's own strokes, because the prior is that of all
    hands, and the cost is that of the stroke's shape, as in an `Exemplar`.
    """

    name: str
    hand: Hand
    weights: Weights
    max_mean_cost: float = 1.0

    @cached_property
    def hash(self) -> str:
        """Hash of the network, which is all that decoding depends on."""
        content = b"".join(name.encode() + array.tobytes() for name, array in sorted(self.arrays().items()))
        return hashlib.sha256(b"trajvae" + content).hexdigest()[:16]

    def arrays(self) -> dict[str, NDArray[np.float32]]:
        """Return the network as arrays whose names begin with ``net.``, for `from_arrays`."""
        return {_PREFIX + name: tensor.numpy() for name, tensor in self.weights.items()}

    @classmethod
    def from_arrays(cls, name: str, hand: Hand, arrays: Mapping[str, NDArray[Any]]) -> Self:
        """Return the style of this hand with the network in `arrays`. Raises InputError where there is none."""
        return cls(name, hand, check_weights({name: arrays.get(_PREFIX + name) for name in shapes()}))

    @property
    def arrangement(self) -> Arrangement | None:
        """How the hand arranges its strokes."""
        return self.hand.arrangement

    @cached_property
    def _exemplar(self) -> Exemplar:
        hands = PooledHands(*(self.weights[f"hands.{field}"].double().numpy() for field in ("covariance", "residual")))
        return Exemplar(self.name, self.hand, hands, 0, self.max_mean_cost)

    @cached_property
    def _neighbours(self) -> Neighbours:
        latents = self.encode(torch.from_numpy(self.hand.paths))
        bandwidths = torch.full((LATENT,), _BANDWIDTH_FINE).to(latents)
        bandwidths[:_COARSE] = _BANDWIDTH_COARSE
        return Neighbours(latents, bandwidths, torch.ones_like(bandwidths))

    def _like(self, like: Tensor) -> Weights:
        return {name: tensor.to(like) for name, tensor in self.weights.items()}

    def encode(self, paths: Tensor) -> Tensor:
        """Return codes (N, 64) of standardised paths (N, 32, 2), metres."""
        return posterior(self._like(paths), shape.encode(paths))[0]

    def decode(self, codes: Tensor) -> Tensor:
        """Return paths (N, 32, 2), metres, of codes (N, 64), standardised but for their residual.

        No gradient flows into the fine latents, so that a planner does not draw with a hand's tremor.
        """
        kept = torch.cat([codes[:, :_COARSE], codes[:, _COARSE:].detach()], dim=1)
        return shape.decode(numbers_of(self._like(codes), kept))

    def sample(self, k: int, generator: Generator) -> tuple[Tensor, Tensor]:
        """Draw codes (k, 64) of strokes between the hand's own (`Neighbours`), with their pressure knots (k, 4)."""
        return self.sample_around(self.hand.choose(k, generator), generator)

    def sample_around(self, rows: Tensor, generator: Generator) -> tuple[Tensor, Tensor]:
        """Draw a stroke around each of the hand's strokes `rows` (k,), codes (k, 64) and pressure knots (k, 4)."""
        return self._neighbours.sample(rows, generator).float(), self.hand.sample_pressure(rows, generator)

    def sample_for(self, lengths: Tensor, generator: Generator, rows: Tensor | None = None) -> tuple[Tensor, Tensor]:
        """Draw one stroke per place, (k, 64) and (k, 4); the longest gets the place with most room."""
        rows = self.hand.choose(len(lengths), generator) if rows is None else rows
        codes, pressure_knots = self.sample_around(rows, generator)
        chosen = by_length(numbers_of(self.weights, codes)[:, 0], lengths)
        return codes[chosen], pressure_knots[chosen]

    def nearest(self, paths: Tensor) -> Tensor:
        """Rows (N,) of the hand's strokes most like standardised paths (N, 32, 2), metres."""
        return self._neighbours.nearest(self.encode(paths))

    def lengths(self, count: int) -> Tensor:
        """Lengths (count,), metres, ascending: the quantiles of the hand's."""
        return self.hand.lengths(count)

    def resize(self, codes: Tensor, lengths: Tensor, own: Tensor) -> None:
        """Change codes (N, 64) in place along the slope of their strokes' log length, so that it is these, (N,)."""
        for _ in range(_NEWTON_STEPS):
            with torch.enable_grad():
                varied = codes.detach().clone().requires_grad_()
                logs = path_length(self.decode(varied)).log()
                (slope,) = torch.autograd.grad(logs.sum(), varied)
            codes += ((lengths.to(codes).log() - logs) / slope.square().sum(1))[:, None].detach() * slope

    def usual_cost(self, k: int, generator: Generator) -> float:
        """Mean cost of k samples of the hand's lengths, each by itself."""
        return self._exemplar.usual_cost(k, generator)

    def scaled(self, times: float) -> Self:
        """Return the style of the same hand that draws so many times as large: the network's mean log length moves."""
        if times == 1:
            return self
        centre = self.weights["centre"].clone()
        centre[0] += log(times)
        return replace(self, hand=self.hand.scaled(times), weights={**self.weights, "centre": centre})

    def cost(self, codes: Tensor, pressure_knots: Tensor) -> Tensor:
        """Cost (N,), nats, of the decoded strokes in an `Exemplar` of the same hand."""
        return self._exemplar.price(shape.encode(self.decode(codes)), pressure_knots)

    def speeds(self, codes: Tensor) -> Tensor | None:
        """Speeds (N, 32), metres per second, of the hand's stroke most like each; None where none are known."""
        return self._exemplar.speeds(self._exemplar.encode(self.decode(codes)))


def check_weights(arrays: Mapping[str, NDArray[Any] | None]) -> Weights:
    """Return the network in these arrays. Raises InputError where one is missing or has another shape."""
    weights = {}
    for name, size in shapes().items():
        array = arrays.get(name)
        if array is None or array.shape != size or not np.isfinite(array).all():
            came = "missing" if array is None else f"of shape {array.shape}"
            raise InputError.of_range(f"the network's {name}", came, f"finite numbers of shape {size}")
        weights[name] = torch.from_numpy(array.astype(np.float32))
    return weights


@dataclass(frozen=True)
class ActiveLatents:
    """Measures of how much of a code is used.

    active: number of latents whose mean has a variance over strokes above 0.01 (Burda et al.: Importance Weighted
    Autoencoders).  effective_rank: exponential of the entropy of the eigenvalues' shares (Roy and Vetterli: The
    Effective Rank).
    """

    active: int
    effective_rank: float


def activity(weights: Weights, paths: Floats) -> ActiveLatents:
    """Measure how the latents of standardised paths (N, 32, 2), metres, are used."""
    means, _ = posterior(weights, shape.encode(torch.from_numpy(paths)).float())
    covariance = np.cov(means.numpy().astype(np.float64), rowvar=False)
    shares = np.linalg.eigvalsh(covariance).clip(min=0)
    shares = shares[shares > 0] / shares.sum()
    active = int((np.diag(covariance) > _ACTIVE).sum())
    return ActiveLatents(active, float(np.exp(-(shares * np.log(shares)).sum())))
