"""Statistics that many hands have in common, by which a style knows more of a hand than its few strokes say."""

from dataclasses import dataclass

import numpy as np
import torch

from maulstick.storage.arrays import Floats
from maulstick.style import shape
from maulstick.style.hand import Hand
from maulstick.style.shape import GIST
from maulstick.style.trait_costs import gist_and_roughness


@dataclass(frozen=True)
class PooledHands:
    """Statistics that many hands have in common (of strokes that may ship; see NOTICE).

    covariance: (17, 17), within a hand, of `gist_and_roughness`.  residual: (47,) RMS of the residual's numbers.
    """

    covariance: Floats
    residual: Floats

    @property
    def units(self) -> Floats:
        """Size (63,) of a large change in each of a stroke's numbers (`shape.encode`)."""
        return np.concatenate([np.sqrt(np.diag(self.covariance)[:GIST]), self.residual])


def pool(hands: list[Hand]) -> PooledHands:
    """Return the statistics of these hands; each is weighted by its number of strokes, up to sixty."""
    numbers = [shape.encode(torch.from_numpy(hand.paths)) for hand in hands]
    weights = np.array([min(len(hand), 60) for hand in hands], dtype=np.float64)
    spreads = [np.cov(gist_and_roughness(*shape.parts(each)).numpy(), rowvar=False) for each in numbers]
    residuals = [each[:, GIST:].square().mean(0).numpy() for each in numbers]
    covariance = np.average(spreads, axis=0, weights=weights)
    return PooledHands(covariance, np.sqrt(np.average(residuals, axis=0, weights=weights)))
