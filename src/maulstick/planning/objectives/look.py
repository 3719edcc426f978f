"""Look: a loss that compares the style of the canvas with that of another picture, whatever the two show."""

from collections.abc import Sequence

import torch
from torch import Generator, Tensor
from torch.nn.functional import normalize

from maulstick.planning.features.network import Network
from maulstick.planning.features.views import on_canvas, squares, through
from maulstick.planning.objectives.objective import NetworkLoss

_PLACES = 512  # places of a map that are compared, at most: time and memory grow with their square
_FAINTEST = 1e-3  # as a share of the usual feature: shorter ones have no clear direction, and count less


class Look(NetworkLoss):
    """Distance between the distributions of features of the canvas and of another picture (3, h, w), layer by layer.

    views: (V, 3, 3), of the canvas.  paper: (3,), what lies beside it; places there do not count.
    torch_rng: chooses which places of a map count; they stay the same.
    layers: which of the network's maps count, alike; all when left out.

    The distance is the relaxed earth mover's, with one minus the cosine for its cost, and the mean difference of the
    features' means and covariances. Source: Kolkin et al., STROTSS, its style term; Schaldenbrand et al.,
    StyleCLIPDraw.
    """

    def __init__(
        self,
        network: Network,
        picture: Tensor,
        views: Tensor,
        paper: Tensor,
        torch_rng: Generator,
        *,
        layers: Sequence[int] | None = None,
    ) -> None:
        self._network, self._picture, self._views, self._paper = network, picture, views, paper
        self._layers = layers
        self._picture_seed, *self._seeds = torch.randint(2**31, (len(views) + 1,), generator=torch_rng).tolist()
        self._wanted: list[tuple[Tensor, Tensor]] = []

    @property
    def name(self) -> str:
        """Name of the term: ``look``."""
        return "look"

    @property
    def views(self) -> int:
        """Number of views."""
        return len(self._views)

    def losses(self, canvas: Tensor, which: Sequence[int]) -> Tensor:
        """Return a loss per view, (len(which),), 0 for the same features at the chosen places."""
        if not self._wanted:
            self._remember_picture()
        maps = self._maps(canvas, self._views[list(which)])
        losses = [
            _distance(_chosen(maps_of_view[None], self._views[[view]], self._seeds[view]) / scale, wanted)
            for layer, (scale, wanted) in zip(maps, self._wanted, strict=True)
            for view, maps_of_view in zip(which, layer, strict=True)
        ]
        return torch.stack(losses).reshape(len(maps), len(which)).mean(dim=0)

    @torch.no_grad()
    def _remember_picture(self) -> None:
        """Keep the features of the picture, layer by layer, with the scale that they are divided by."""
        views = squares(*self._picture.shape[1:])
        for layer in self._maps(self._picture, views):
            vectors = _chosen(layer, views, self._picture_seed)
            scale = vectors.square().mean().sqrt()
            self._wanted.append((scale, vectors / scale))

    def _maps(self, image: Tensor, views: Tensor) -> list[Tensor]:
        maps, _ = self._network.features(through(image, views, self._network.side, self._paper))
        return maps if self._layers is None else [maps[layer] for layer in self._layers]


def _chosen(maps: Tensor, views: Tensor, seed: int) -> Tensor:
    """Return feature vectors (n, C) at random places, by the seed, of maps (V, C, h, w) where they show the canvas."""
    beside = on_canvas(views, *maps.shape[2:]).abs().amax(dim=-1).flatten()
    places = (beside <= max(1.0, beside.min().item())).nonzero()[:, 0]
    order = torch.randperm(len(places), generator=Generator().manual_seed(seed))[:_PLACES]
    return maps.movedim(1, -1).flatten(end_dim=-2)[places[order].to(maps.device)]


def _distance(vectors: Tensor, wanted: Tensor) -> Tensor:
    """Return the distance between two sets of features, (n, C) and (m, C), as a scalar."""
    costs = 1 - normalize(vectors, dim=1, eps=_FAINTEST) @ normalize(wanted, dim=1, eps=_FAINTEST).T
    moved = torch.maximum(costs.amin(dim=0).mean(), costs.amin(dim=1).mean())
    means = (vectors.mean(dim=0) - wanted.mean(dim=0)).abs().mean()
    covariances = (_covariance(vectors) - _covariance(wanted)).abs().mean()
    return moved + means + covariances


def _covariance(vectors: Tensor) -> Tensor:
    centred = vectors - vectors.mean(dim=0)
    return centred.T @ centred / len(vectors)
