"""The paper's recipe for a TrajVAE, written from the paper alone, as a baseline for `benchmarks/style.py`.

    .venv/bin/python benchmarks/published.py        # the sweep that chooses what the paper leaves open: an hour

Mean squared error in metres², and a weight of the divergence summed over 64 latents (the paper's is 1e-6); pretrained
on several sessions, fine-tuned on a few strokes of one; samples come from latents of a normal distribution. What the
paper leaves open (width, rate, steps of fine-tuning), and the weight too, is chosen for each session as what serves the
other sessions best, on average over five trainings, each on twenty other strokes: `CHOSEN`.
"""

import argparse
import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass

import numpy as np
import torch
from few_shot import DRAWN, Session, sessions_of
from numpy.typing import NDArray
from recordings import MOCAP, mocap_hands
from torch import Generator, Tensor, nn

Floats = NDArray[np.float64]

LATENT, POINTS = 64, 32
BATCH = 64
STEPS = 2000
STEPS_FINE = (300, 1000, 3000)
SEEDS = 5
SWEEP = (  # width, rate, weight; each with all of `STEPS_FINE`
    (256, 1e-3, 1e-6),
    (512, 1e-3, 1e-6),
    (256, 1e-3, 1e-7),
    (256, 1e-3, 1e-5),
    (256, 3e-4, 1e-6),
    (256, 3e-3, 1e-6),
)


@dataclass(frozen=True)
class Recipe:
    """width: of two hidden layers.  rate: of Adam.  weight: of the divergence.  steps_fine: of fine-tuning."""

    width: int
    rate: float
    weight: float
    steps_fine: int


CHOSEN = {name: Recipe(512 if name == "lia" else 256, 1e-3, 1e-6, 3000) for name in MOCAP}


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


def published_vae(sessions: list[Floats], fine: Floats, recipe: Recipe, seed: int) -> Published:
    """Pretrained on the strokes of all sessions (N, 32, 2), metres, then fine-tuned on `fine` (M, 32, 2)."""
    (trained,) = _trained(sessions, fine, recipe, (recipe.steps_fine,), seed)
    return trained


def _trained(
    sessions: list[Floats], fine: Floats, recipe: Recipe, steps_fine: tuple[int, ...], seed: int
) -> Iterator[Published]:
    """The same network after each of these numbers of steps of fine-tuning."""
    torch.manual_seed(seed)
    layers = (_layers(2 * POINTS, 2 * LATENT, recipe.width), _layers(LATENT, 2 * POINTS, recipe.width))
    published = Published(*layers)
    _train(published, _flat(np.concatenate(sessions)), recipe, STEPS)
    optimiser, done = None, 0
    for steps in steps_fine:
        optimiser = _train(published, _flat(fine), recipe, steps - done, optimiser)
        done = steps
        yield published


def _layers(came: int, goes: int, width: int) -> nn.Module:
    return nn.Sequential(nn.Linear(came, width), nn.ReLU(), nn.Linear(width, width), nn.ReLU(), nn.Linear(width, goes))


def _flat(paths: Floats) -> Tensor:
    return torch.from_numpy(paths).float().flatten(1)


def _train(
    published: Published, strokes: Tensor, recipe: Recipe, steps: int, optimiser: torch.optim.Adam | None = None
) -> torch.optim.Adam:
    parameters = [*published.encoder.parameters(), *published.decoder.parameters()]
    optimiser = optimiser or torch.optim.Adam(parameters, lr=recipe.rate, fused=True)
    for _ in range(steps):
        batch = strokes[torch.randint(len(strokes), (BATCH,))]
        mean, log_variance = published.encoder(batch).chunk(2, dim=1)
        latents = mean + (log_variance / 2).exp() * torch.randn_like(mean)
        divergence = (mean.square() + log_variance.exp() - 1 - log_variance).sum(1).mean() / 2
        error = (published.decoder(latents) - batch).square().mean()
        optimiser.zero_grad()
        (error + recipe.weight * divergence).backward()
        optimiser.step()
    return optimiser


def main() -> None:
    """Print the energy distances of each recipe to each session, and for each session the best of the others."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    torch.set_num_threads(1)
    sessions = sessions_of(mocap_hands())
    energies: dict[Recipe, dict[str, list[float]]] = {}
    for width, rate, weight in SWEEP:
        recipes = [Recipe(width, rate, weight, steps) for steps in STEPS_FINE]
        for recipe in recipes:
            energies[recipe] = {session.name: [] for session in sessions}
        for session in sessions:
            for seed in range(SEEDS):
                for recipe, energy in zip(recipes, _energies(session, recipes[0], seed), strict=True):
                    energies[recipe][session.name].append(round(energy, 3))
        for recipe in recipes:
            print(json.dumps({"name": "sweep"} | asdict(recipe) | energies[recipe]), flush=True)
    for session in sessions:
        others = {
            recipe: np.mean([each[other.name] for other in sessions if other is not session])
            for recipe, each in energies.items()
        }
        best = min(others, key=lambda recipe: others[recipe])
        print(json.dumps({"name": "chosen", "session": session.name} | asdict(best)), flush=True)


def _energies(session: Session, recipe: Recipe, seed: int) -> Iterator[float]:
    """After each number of steps of fine-tuning."""
    few = session.few(seed)
    for trained in _trained(session.others, few.paths, recipe, STEPS_FINE, seed):
        yield few.compare(trained.sample(DRAWN, torch.Generator().manual_seed(seed))).energy


if __name__ == "__main__":
    main()
