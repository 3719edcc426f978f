"""How like a picture the canvas looks to a network."""

from collections.abc import Sequence

import torch
from torch import Tensor
from torch.nn.functional import normalize

from maulstick.planning.features.network import Network
from maulstick.planning.features.views import through
from maulstick.planning.objectives.luminance import luminance
from maulstick.planning.objectives.objective import NetworkLoss

_FAINTEST = 1e-3  # features that are shorter have no direction to speak of
_DEEP = (-2, -1)


class Likeness(NetworkLoss):
    """One minus the cosine between what a network says of the canvas and of the target (3, H, W), view by view.

    views: (V, 3, 3), of the canvas.  paper: (3,), what lies beside it.
    layers: which of the network's maps count, alike; all when left out.  semantics: the weight of its embedding beside
    them.  grey: look at both without colour, as one ink has none.

    Each place of a map is compared with the same place of the target's. What the network says of the target is kept in
    full: 1.4 MB a view for EfficientNet-Lite0, 6 MB for RN101.
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
        """``likeness``, or ``sketch``."""
        return self._name

    @property
    def views(self) -> int:
        """As many as were given."""
        return len(self._views)

    def losses(self, canvas: Tensor, which: Sequence[int]) -> Tensor:
        """0 for the target itself, (len(which),)."""
        self._look_at_target([view for view in dict.fromkeys(which) if view not in self._wanted])
        wanted = [torch.stack(parts) for parts in zip(*(self._wanted[view] for view in which), strict=True)]
        *maps, embedding = [
            _one_minus_cosine(said, of_target)
            for said, of_target in zip(self._features(canvas, which), wanted, strict=True)
        ]
        likeness = self._semantics * embedding
        return likeness + torch.stack(maps).mean(dim=0) if maps else likeness

    @torch.no_grad()
    def _look_at_target(self, which: Sequence[int]) -> None:
        for view in which:  # one by one: what a network says of several at once differs in the last bits
            self._wanted[view] = [part[0] for part in self._features(self._target, [view])]

    def _features(self, image: Tensor, which: Sequence[int]) -> list[Tensor]:
        """Maps (B, C, h, w) and last the embedding (B, D), all of unit vectors."""
        views = self._views[list(which)]
        if self._grey:
            image = luminance(image).expand_as(image)
        maps, embedding = self._network.features(through(image, views, self._network.side, self._paper))
        chosen = maps if self._layers is None else [maps[layer] for layer in self._layers]
        return [normalize(features, dim=1, eps=_FAINTEST) for features in [*chosen, embedding]]


def sketch(network: Network, target: Tensor, views: Tensor, paper: Tensor, *, grey: bool = False) -> Likeness:
    """A likeness that asks what is to be seen, and little of where and how: deep layers, and as much the embedding."""
    return Likeness(network, target, views, paper, layers=_DEEP, grey=grey, semantics=1.0, name="sketch")


def _one_minus_cosine(units: Tensor, others: Tensor) -> Tensor:
    """Of unit vectors (B, C, ...), averaged over places, (B,)."""
    # Half the square of their distance is the same, and does not drown small differences in rounding.
    return (units - others).square().sum(dim=1).reshape(len(units), -1).mean(dim=1) / 2
