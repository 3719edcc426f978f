"""Training of a TrajVAE, first on many hands, then on one (paper: TrajVAE)."""

from collections.abc import Callable
from importlib.resources import files

import numpy as np
import torch
from safetensors.numpy import load
from torch import Generator, Tensor

from maulstick.rendering.threads import one_torch_thread
from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import standardise
from maulstick.style import shape
from maulstick.style.hand import Hand
from maulstick.style.pooled import pool
from maulstick.style.trajvae import LATENT, TrajVAE, Weights, check_weights, numbers_of, posterior, shapes

_NOISE = 1e-3  # standard error of a decoded point, relative to the stroke's length; at three times that, tremor is lost
_TAIL = 1e3  # in squares of `_NOISE`: mean squared error beyond which an error counts less and less
_FIXED = ("centre", "unit", "hands.covariance", "hands.residual")  # tensors that are not trained
_BATCH, _BATCH_FINE = 256, 128  # strokes per step, of pretraining and of fine-tuning
_RATE, _RATE_FINE = 3e-4, 1e-4  # learning rates; small in fine-tuning, so that little is forgotten
_LEAST_UNIT = 1e-4  # keeps a number that never varies out of the denominators
_MOST_STROKES = 60.0  # largest weight of a hand, so that no hand dominates
_LONGER, _BENT = 0.3, 0.3  # augmentation in pretraining: spread of log length, share of another pair's difference
_LONGER_FINE, _BENT_FINE = 0.05, 0.1  # the same in fine-tuning: little, so that the hand's look stays


def pretrained() -> Weights:
    """Return the network that comes with Maulstick, pretrained on strokes that may ship (see NOTICE)."""
    content = files("maulstick.style").joinpath("built_in/trajvae.safetensors").read_bytes()
    return check_weights(load(content))


@one_torch_thread()
def pretrain(hands: list[Hand], seed: int, steps: int = 4000) -> Weights:
    """Train a network that can draw the strokes of all these hands, and of others."""
    generator = torch.Generator().manual_seed(seed)
    groups = [shape.encode(torch.from_numpy(_turned(hand.paths))).float() for hand in hands]
    shares = torch.tensor([min(float(len(hand)), _MOST_STROKES) for hand in hands])

    def batch() -> Tensor:
        chosen = torch.multinomial(shares, _BATCH, replacement=True, generator=generator)
        counts = torch.bincount(chosen, minlength=len(groups)).tolist()
        drawn = [_varied(g, k, _LONGER, _BENT, generator) for g, k in zip(groups, counts, strict=True)]
        return shape.encode(shape.decode(torch.cat(drawn)))

    weights = _untrained(torch.cat([batch() for _ in range(20)]), hands, generator)
    return _descend(weights, batch, generator, steps, _RATE)


@one_torch_thread()
def fine_tune(weights: Weights, hand: Hand, seed: int, name: str = "trajvae", steps: int = 200) -> TrajVAE:
    """Train the network further on the strokes of one hand, and return the style.

    Half of each batch is drawn by the network as it was before, so that it does not forget what hands have in common.
    """
    generator = torch.Generator().manual_seed(seed)
    own = shape.encode(torch.from_numpy(hand.paths)).float()

    def batch() -> Tensor:
        remembered = numbers_of(weights, torch.randn(_BATCH_FINE // 2, LATENT, generator=generator))
        drawn = _varied(own, _BATCH_FINE // 2, _LONGER_FINE, _BENT_FINE, generator)
        return shape.encode(shape.decode(torch.cat([drawn, remembered])))

    return TrajVAE(name, hand, _descend(weights, batch, generator, steps, _RATE_FINE))


def _turned(paths: Floats) -> Floats:
    """Return paths (4 N, 32, 2): those given (N, 32, 2), the same reversed, and both mirrored."""
    both = np.concatenate([paths, standardise(paths[:, ::-1])[0]])
    return np.concatenate([both, both * [1, -1]])


def _varied(numbers: Tensor, k: int, longer: float, bent: float, generator: Generator) -> Tensor:
    """Draw k of a hand's strokes, each changed by a share of the difference between two others of the hand."""
    rows = torch.randint(len(numbers), (3, k), generator=generator)
    share = bent * torch.rand(k, 1, generator=generator)
    varied = numbers[rows[0]] + share * (numbers[rows[1]] - numbers[rows[2]])
    varied[:, 0] += longer * torch.randn(k, generator=generator)
    return varied


def _untrained(numbers: Tensor, hands: list[Hand], generator: Generator) -> Weights:
    """Initialise a network by the principal components of strokes like `numbers` (N, 63), which is its linear part."""
    weights = {name: torch.zeros(size) for name, size in shapes().items()}
    for name in (f"{part}.{layer}.weight" for part in ("encoder", "decoder") for layer in (0, 1)):
        weights[name] = torch.randn(weights[name].shape, generator=generator) * (2 / weights[name].shape[1]) ** 0.5
    common = pool(hands)
    weights["hands.covariance"] = torch.from_numpy(common.covariance).float()
    weights["hands.residual"] = torch.from_numpy(common.residual).float()
    weights["centre"], weights["unit"] = numbers.mean(0), numbers.std(0).clamp(min=_LEAST_UNIT)

    relative = weights["unit"].clone()  # to a stroke's length, as the loss measures errors
    relative[0] /= 2  # an error of the log length moves the points by about half as much
    standard = (numbers - weights["centre"]) / weights["unit"]
    _, sizes, axes = torch.linalg.svd(standard * relative / len(numbers) ** 0.5, full_matrices=False)
    noise = _NOISE**2 / (sizes.square() + _NOISE**2)
    parts = slice(len(sizes))
    weights["decoder.straight"][:, parts] = (axes.T * sizes) / relative[:, None]
    weights["encoder.straight"][parts] = ((1 - noise) / sizes)[:, None] * axes * relative
    weights["encoder.2.bias"][LATENT:][parts] = noise.log()
    return weights


def _descend(weights: Weights, batch: Callable[[], Tensor], generator: Generator, steps: int, rate: float) -> Weights:
    """Return the weights after `steps` steps of Adam on the evidence lower bound."""
    trained = {name: tensor.clone().requires_grad_(name not in _FIXED) for name, tensor in weights.items()}
    free = [tensor for tensor in trained.values() if tensor.requires_grad]
    optimiser = torch.optim.Adam(free, lr=rate)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, rate, total_steps=steps + 1, pct_start=0.1)
    for _ in range(steps):
        optimiser.zero_grad()
        _loss(trained, batch(), generator).backward()
        torch.nn.utils.clip_grad_norm_(free, 100.0)
        optimiser.step()
        schedule.step()
    return {name: tensor.detach() for name, tensor in trained.items()}


def _loss(weights: Weights, numbers: Tensor, generator: Generator) -> Tensor:
    """Negative evidence lower bound of strokes (N, 63), nats per stroke, without its constant.

    Errors of points are relative to the stroke's length and have the tails of Student's t, so that one outlier does not
    dominate.
    """
    mean, log_variance = posterior(weights, numbers)
    latents = mean + (log_variance / 2).exp() * torch.randn(mean.shape, generator=generator)
    off = (shape.decode(numbers_of(weights, latents)) - shape.decode(numbers)) / numbers[:, :1, None].exp()
    points = off[:, 1:].flatten(1)
    error = points.shape[1] * _TAIL / 2 * torch.log1p(points.square().mean(1) / (_TAIL * _NOISE**2))
    divergence = (mean.square() + log_variance.exp() - 1 - log_variance).sum(1) / 2
    return (error + divergence).mean()
