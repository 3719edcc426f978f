"""Likeness: a loss that compares a network's features of canvas and picture."""

from collections.abc import Sequence

import torch
from torch import Tensor
from torch.nn.functional import normalize

from maulstick.planning.features.network import Network
from maulstick.planning.features.views import through
from maulstick.planning.objectives.luminance import luminance
from maulstick.planning.objectives.objective import NetworkLoss

_FAINTEST = 1e-3  # features that are shorter have no clear direction, and count less
_DEEP = (-2, -1)  # the last two maps, which say what is shown and little of where it lies


class Likeness(NetworkLoss):
    """One minus the cosine between a network's features of the canvas and of the target (3, H, W), view by view.

    views: (V, 3, 3), of the canvas.  paper: (3,), what lies beside it.
    layers: which of the network's maps count, alike; all when left out.  semantics: the weight of its embedding beside
    them.  grey: compare without colour, as one ink has none.

    Each place of a map is compared with the same place of the target's. The features of the target are kept in full:
    1.4 MB per view for EfficientNet-Lite0, 6 MB for RN101.
    Source: Spline-FRIDA, Painting and Drawing Planning; Vinker et al., CLIPasso, its loss.
    """

    def __init__(
        self,
        network: Network,
        target: Tensor,
        views: Tensor,
        paper: Tensor,
        *,
        layers: Sequence[int] | None = None,
        grey: bool = False,
        semantics: float = 0.1,
        name: str = "likeness",
    ) -> None:
        self._network, self._target, self._views, self._paper = network, target, views, paper
        self._layers, self._grey, self._semantics, self._name = layers, grey, semantics, name
        self._wanted: dict[int, list[Tensor]] = {}

    @property
    def name(self) -> str:
        """Name of the term: ``likeness``, or ``sketch``."""
        return self._name

    @property
    def views(self) -> int:
        """Number of views."""
        return len(self._views)

    def losses(self, canvas: Tensor, which: Sequence[int]) -> Tensor:
        """Return a loss per view, (len(which),), 0 for the target itself."""
        self._remember_target([view for view in dict.fromkeys(which) if view not in self._wanted])
        wanted = [torch.stack(parts) for parts in zip(*(self._wanted[view] for view in which), strict=True)]
        *maps, embedding = [
            _one_minus_cosine(of_canvas, of_target)
            for of_canvas, of_target in zip(self._features(canvas, which), wanted, strict=True)
        ]
        likeness = self._semantics * embedding
        return likeness + torch.stack(maps).mean(dim=0) if maps else likeness

    @torch.no_grad()
    def _remember_target(self, which: Sequence[int]) -> None:
        """Keep the features of the target in these views."""
        for view in which:  # one by one: features of several views at once differ in the last bits
            self._wanted[view] = [part[0] for part in self._features(self._target, [view])]

    def _features(self, image: Tensor, which: Sequence[int]) -> list[Tensor]:
        """Return maps (B, C, h, w) and last the embedding (B, D), all of unit vectors."""
        views = self._views[list(which)]
        if self._grey:
            image = luminance(image).expand_as(image)
        maps, embedding = self._network.features(through(image, views, self._network.side, self._paper))
        chosen = maps if self._layers is None else [maps[layer] for layer in self._layers]
        return [normalize(features, dim=1, eps=_FAINTEST) for features in [*chosen, embedding]]


def sketch(network: Network, target: Tensor, views: Tensor, paper: Tensor, *, grey: bool = False) -> Likeness:
    """Return a likeness of what is shown, and little of where and how: of deep layers, and as much of the embedding."""
    return Likeness(network, target, views, paper, layers=_DEEP, grey=grey, semantics=1.0, name="sketch")


def _one_minus_cosine(units: Tensor, others: Tensor) -> Tensor:
    """Return one minus the cosine of unit vectors (B, C, ...), averaged over places, (B,)."""
    # Half the square of their distance is the same, and keeps small differences that rounding would lose.
    return (units - others).square().sum(dim=1).reshape(len(units), -1).mean(dim=1) / 2
