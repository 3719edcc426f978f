"""The paper's recipe for a TrajVAE, written from the paper alone, as a baseline for `benchmarks/style.py`.

Mean squared error in metres², and 1e-6 of the divergence summed over 64 latents; layers of 256; pretrained on several
sessions, fine-tuned on a few strokes of one; samples come from latents of a normal distribution. What the paper leaves
open (width, steps, rates) is a choice of ours within 20 s, and likeness depends on it and on the seed: of five choices,
four of them with one seed only, the gap to the hand was 0.25 to 0.5 of that between people.
"""

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Generator, Tensor, nn

Floats = NDArray[np.float64]

LATENT, HIDDEN, POINTS = 64, 256, 32
BETA = 1e-6
BATCH = 64
STEPS, STEPS_FINE = 2000, 1000
RATE, RATE_FINE = 1e-3, 1e-3


@dataclass(frozen=True)
class Published:
    """A trained autoencoder of strokes (k, 32, 2), metres."""

    encoder: nn.Module
    decoder: nn.Module

    @torch.no_grad()
    def sample(self, k: int, generator: Generator) -> Floats:
        """Draw k strokes (k, 32, 2)."""
        return self._paths(torch.randn(k, LATENT, generator=generator))

    @torch.no_grad()
    def reconstruct(self, paths: Floats) -> Floats:
        """Strokes (N, 32, 2) as they come back out of the means of their latents."""
        return self._paths(self.encoder(_flat(paths))[:, :LATENT])

    def _paths(self, latents: Tensor) -> Floats:
        return self.decoder(latents).reshape(-1, POINTS, 2).double().numpy()


def published_vae(sessions: list[Floats], fine: Floats, seed: int) -> Published:
    """Pretrained on the strokes of all sessions (N, 32, 2), metres, then fine-tuned on `fine` (M, 32, 2)."""
    torch.manual_seed(seed)
    published = Published(_layers(2 * POINTS, 2 * LATENT), _layers(LATENT, 2 * POINTS))
    _train(published, _flat(np.concatenate(sessions)), STEPS, RATE)
    _train(published, _flat(fine), STEPS_FINE, RATE_FINE)
    return published


def _layers(came: int, goes: int) -> nn.Module:
    return nn.Sequential(
        nn.Linear(came, HIDDEN), nn.ReLU(), nn.Linear(HIDDEN, HIDDEN), nn.ReLU(), nn.Linear(HIDDEN, goes)
    )


def _flat(paths: Floats) -> Tensor:
    return torch.from_numpy(paths).float().flatten(1)


def _train(published: Published, strokes: Tensor, steps: int, rate: float) -> None:
    parameters = [*published.encoder.parameters(), *published.decoder.parameters()]
    optimiser = torch.optim.Adam(parameters, lr=rate, fused=True)
    for _ in range(steps):
        batch = strokes[torch.randint(len(strokes), (BATCH,))]
        mean, log_variance = published.encoder(batch).chunk(2, dim=1)
        latents = mean + (log_variance / 2).exp() * torch.randn_like(mean)
        divergence = (mean.square() + log_variance.exp() - 1 - log_variance).sum(1).mean() / 2
        error = (published.decoder(latents) - batch).square().mean()
        optimiser.zero_grad()
        (error + BETA * divergence).backward()
        optimiser.step()
