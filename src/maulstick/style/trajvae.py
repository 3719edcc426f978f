"""The paper's style (TrajVAE): a variational autoencoder of strokes, pretrained on many hands and fine-tuned on one.

The published recipe weighs squared metres against nats and collapses: one latent of 64 carries anything (design §5).
Here the network sees the numbers of `style.shape`, standardised, and errs relative to the length of the stroke.
"""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, Self

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Generator, Tensor
from torch.nn.functional import linear, silu

from maulstick.errors import InputError
from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import POINTS, path_lengths
from maulstick.style import shape
from maulstick.style.density import Density, kernel
from maulstick.style.exemplar import Exemplar, PooledHands
from maulstick.style.hand import Hand, by_length
from maulstick.style.shape import GIST, RESIDUAL
from maulstick.style.style import Style

Weights = dict[str, Tensor]
"""A network: its layers, what it standardises by, and what the hands that it was pretrained on have in common."""

LATENT = 64
HIDDEN = 256
_NUMBERS = GIST + RESIDUAL
_COARSE = 16  # the network begins as principal components, the largest first, and keeps to their order
_BANDWIDTH_COARSE, _BANDWIDTH_FINE = 0.6, 0.2
_LEAST_BEND, _MOST_BEND = 0.05, 1.5
_LEAST_USUAL = 1e-6
_ACTIVE = 0.01
_PREFIX = "net."


def shapes() -> dict[str, tuple[int, ...]]:
    """The name and shape of each tensor of a network."""
    layers = {"encoder": (_NUMBERS, HIDDEN, HIDDEN, 2 * LATENT), "decoder": (LATENT, HIDDEN, HIDDEN, _NUMBERS)}
    named: dict[str, tuple[int, ...]] = {"centre": (_NUMBERS,), "unit": (_NUMBERS,)}
    for part, sizes in layers.items():
        for i, (came, goes) in enumerate(pairwise(sizes)):
            named |= {f"{part}.{i}.weight": (goes, came), f"{part}.{i}.bias": (goes,)}
    named |= {"encoder.straight": (LATENT, _NUMBERS), "decoder.straight": (_NUMBERS, LATENT)}
    return named | {"hands.covariance": (GIST + 1, GIST + 1), "hands.residual": (RESIDUAL,)}


def posterior(weights: Weights, numbers: Tensor) -> tuple[Tensor, Tensor]:
    """Mean and log variance, both (N, 64), of the latents that a stroke's numbers (N, 63) may come from."""
    standard = (numbers - weights["centre"]) / weights["unit"]
    mean, log_variance = _layers(weights, "encoder", standard).split(LATENT, dim=1)
    return mean + linear(standard, weights["encoder.straight"]), log_variance


def numbers_of(weights: Weights, latents: Tensor) -> Tensor:
    """A stroke's numbers (N, 63) (`style.shape`) of latents (N, 64)."""
    standard = _layers(weights, "decoder", latents) + linear(latents, weights["decoder.straight"])
    return standard * weights["unit"] + weights["centre"]


def _layers(weights: Weights, part: str, x: Tensor) -> Tensor:
    for i in (0, 1):
        x = silu(linear(x, weights[f"{part}.{i}.weight"], weights[f"{part}.{i}.bias"]))
    return linear(x, weights[f"{part}.2.weight"], weights[f"{part}.2.bias"])


@dataclass(frozen=True)
class TrajVAE(Style):
    """A code is the mean of the latents that a stroke may come from, whose prior is a normal distribution of unit size.

    What is not in the network: samples are drawn around the latents of the hand's own strokes, not from the prior,
    which is that of everybody; and how unlikely a stroke is, is judged by the stroke itself, as in an `Exemplar`.
    """

    name: str
    hand: Hand
    weights: Weights
    max_mean_cost: float = 1.5

    @cached_property
    def hash(self) -> str:
        """Of all that decoding depends on."""
        content = b"".join(name.encode() + array.tobytes() for name, array in sorted(self.arrays().items()))
        return hashlib.sha256(b"trajvae" + content).hexdigest()[:16]

    def arrays(self) -> dict[str, NDArray[np.float32]]:
        """The network as arrays whose names begin with ``net.``; `from_arrays` makes it a style again."""
        return {_PREFIX + name: tensor.numpy() for name, tensor in self.weights.items()}

    @classmethod
    def from_arrays(cls, name: str, hand: Hand, arrays: Mapping[str, NDArray[Any]]) -> Self:
        """The style of this hand with the network in `arrays`. Raises InputError where there is none."""
        return cls(name, hand, check_weights({name: arrays.get(_PREFIX + name) for name in shapes()}))

    @cached_property
    def _exemplar(self) -> Exemplar:
        hands = PooledHands(*(self.weights[f"hands.{field}"].double().numpy() for field in ("covariance", "residual")))
        return Exemplar(self.name, self.hand, hands, 0, self.max_mean_cost)

    @cached_property
    def _latents(self) -> Density:
        centres = self.encode(torch.from_numpy(self.hand.paths))
        scales = torch.empty_like(centres)
        for latents, bandwidth in ((slice(_COARSE), _BANDWIDTH_COARSE), (slice(_COARSE, LATENT), _BANDWIDTH_FINE)):
            bends = (centres - self._straight)[:, latents].norm(dim=1, keepdim=True)
            usual = bends.square().mean().sqrt().clamp(min=_LEAST_USUAL)
            scales[:, latents] = bandwidth * (bends / usual).clamp(_LEAST_BEND, _MOST_BEND)
        return Density(centres, scales, torch.from_numpy(kernel(centres.numpy(), np.eye(LATENT))))

    @property
    def _straight(self) -> Tensor:
        """The latents (64,) of a straight stroke as long as the hand's are."""
        lengths = path_lengths(self.hand.paths)
        along = np.linspace(0, np.exp(np.log(lengths).mean()), POINTS)
        return self.encode(torch.from_numpy(np.stack([along, np.zeros(POINTS)], axis=1)[None]))[0]

    def _like(self, like: Tensor) -> Weights:
        return {name: tensor.to(like) for name, tensor in self.weights.items()}

    def encode(self, paths: Tensor) -> Tensor:
        """Codes (N, 64) of standardised paths (N, 32, 2)."""
        return posterior(self._like(paths), shape.encode(paths))[0]

    def decode(self, codes: Tensor) -> Tensor:
        """Paths (N, 32, 2) of codes (N, 64), standardised but for their residual.

        No gradient flows into the fine latents: how a hand trembles is not for a planner to draw with.
        """
        kept = torch.cat([codes[:, :_COARSE], codes[:, _COARSE:].detach()], dim=1)
        return shape.decode(numbers_of(self._like(codes), kept))

    def sample(self, k: int, generator: Generator) -> tuple[Tensor, Tensor]:
        """Strokes near the hand's own, pressed as they were.

        They leave the latents of one of the hand's strokes by 0.6 of how the hand varies in the first 16, which say
        most of the shape, and by 0.2 in the rest; by less where that stroke is nearly straight, by more where it is
        much bent.
        """
        codes, around = self._latents.sample(k, generator)
        return codes.float(), self.hand.sample_pressure(around, generator)

    def sample_for(self, lengths: Tensor, generator: Generator) -> tuple[Tensor, Tensor]:
        """As many strokes as there are places, the longest where there is most room."""
        codes, pressure_knots = self.sample(len(lengths), generator)
        chosen = by_length(numbers_of(self.weights, codes)[:, 0], lengths)
        return codes[chosen], pressure_knots[chosen]

    def cost(self, codes: Tensor, pressure_knots: Tensor) -> Tensor:
        """That of the strokes as an `Exemplar` of the same hand has it."""
        return self._exemplar.price(shape.encode(self.decode(codes)), pressure_knots)

    def speeds(self, codes: Tensor) -> Tensor | None:
        """As fast as the hand's stroke that is most like it."""
        return self._exemplar.speeds(self._exemplar.encode(self.decode(codes)))


def check_weights(arrays: Mapping[str, NDArray[Any] | None]) -> Weights:
    """A network out of arrays. Raises InputError where they are not those of one."""
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
    """How much of a code is used.

    active: latents whose mean varies from stroke to stroke by more than 0.01 (Burda et al.: Importance Weighted
    Autoencoders).  effective_rank: how many equal directions would vary as unevenly (Roy and Vetterli: The Effective
    Rank): the exponential of the entropy of the eigenvalues' shares.
    """

    active: int
    effective_rank: float


def activity(weights: Weights, paths: Floats) -> ActiveLatents:
    """Of the latents of standardised paths (N, 32, 2), metres."""
    means, _ = posterior(weights, shape.encode(torch.from_numpy(paths)).float())
    covariance = np.cov(means.numpy().astype(np.float64), rowvar=False)
    shares = np.linalg.eigvalsh(covariance).clip(min=0)
    shares = shares[shares > 0] / shares.sum()
    active = int((np.diag(covariance) > _ACTIVE).sum())
    return ActiveLatents(active, float(np.exp(-(shares * np.log(shares)).sum())))
