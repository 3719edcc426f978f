"""Options of the loss, and its terms made of them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache

import numpy as np
import torch
from torch import Generator, Tensor

from maulstick.errors import InputError, option
from maulstick.planning.features.network import Network, ReadingNetwork
from maulstick.planning.features.views import random_views
from maulstick.planning.objectives import (
    Edges,
    Halftone,
    Likeness,
    Look,
    NetworkLoss,
    Objective,
    TextMatch,
    Tone,
    sketch,
)
from maulstick.planning.problem import Weighted
from maulstick.planning.weights import FACES, NEEDS, STRENGTHS, check_weights
from maulstick.storage.arrays import Image

_VIEWS = 32  # views per network loss: so many that no painting suits them by accident; each costs memory


@dataclass(frozen=True)
class LossOptions:
    """Options of the loss: what a painting should look like, beside its picture.

    text: what it should show.  look: (H, W, 3), a picture whose look it should have.
    weights: of the terms by name, 1 for the usual strength; `weights_of_terms` says what holds for those left out.
    contours: whether inks draw them beside their tones.
    Among the weights may be `faces`, how much more a face counts in the picture than its surroundings: 1 when left out.

    Raises InputError for a term that does not exist, a weight out of range, and contradictions.
    """

    text: str | None = None
    look: Image | None = None
    weights: Mapping[str, float] = field(default_factory=dict)
    contours: bool = True

    def __post_init__(self) -> None:
        check_weights(self.weights, self._given)

    @property
    def faces(self) -> float:
        """How much more a face counts than its surroundings, as `attention` takes it."""
        return float(self.weights.get(FACES, 1.0))

    @property
    def _given(self) -> dict[str, bool]:
        return {"text": self.text is not None, "look": self.look is not None}

    def weights_to_keep(self, *, has_picture: bool) -> dict[str, float]:
        """Return the weights for a painting's file: of the terms, and of faces where it is given."""
        given = {FACES: self.faces} if FACES in self.weights else {}
        return {**self.weights_of_terms(has_picture=has_picture), **given}

    def weights_of_terms(self, *, has_picture: bool) -> dict[str, float]:
        """Return the weights above 0 by term. Raises InputError where none is, or a term lacks its picture."""
        weights = {"tone": has_picture, **self._given, **self.weights}
        counting = {name: float(weight) for name, weight in weights.items() if weight}
        for name in counting:
            if not has_picture and name not in NEEDS:
                raise InputError(f"{name} compares with a picture; name one, or leave that weight out")
        counting.pop(FACES, None)
        if not counting:
            raise InputError("nothing is weighed, so any painting would do; give one of the terms a weight above 0")
        return counting


@dataclass(frozen=True)
class Reference:
    """Images that the terms compare the canvas with.

    target: (3, H, W), or None.  weights: (H, W).  paper: (3,), its colour.
    spacing: pixels between the lines that inks' tones are made of; None where there are paints.
    pull: (3, H, W), of inks, as `Halftone` takes it.
    weights_of: weights (H, W) of single terms by name, where they differ.  grey: whether networks see no colours.
    """

    target: Tensor | None
    weights: Tensor
    paper: Tensor
    spacing: float | None
    pull: Tensor | None = None
    weights_of: Mapping[str, Tensor] = field(default_factory=dict)
    grey: bool = False


def losses_of(
    loss_options: LossOptions, reference: Reference, network: Callable[[], Network]
) -> tuple[tuple[Weighted[Objective], ...], tuple[Weighted[NetworkLoss], ...]]:
    """Return the objectives and network losses of the options; `network` is called where a network loss needs one.

    Raises InputError as `LossOptions.weights_of_terms` does, and for a text with a network that cannot read.
    """
    network = cache(network)  # which takes seconds and a lot of memory to load
    objectives: list[Weighted[Objective]] = []
    network_losses: list[Weighted[NetworkLoss]] = []
    for name, weight in loss_options.weights_of_terms(has_picture=reference.target is not None).items():
        strength = weight * STRENGTHS[name]
        if name in ("tone", "edges"):
            objectives.append(Weighted(_objective(name, reference), strength))
        else:
            network_losses.append(Weighted(_network_loss(name, loss_options, reference, network()), strength))
    return tuple(objectives), tuple(network_losses)


def _objective(name: str, reference: Reference) -> Objective:
    assert reference.target is not None  # `LossOptions.weights_of_terms` has checked it
    weights = reference.weights_of.get(name, reference.weights)
    if name == "edges":
        return Edges(reference.target, weights)
    if reference.spacing is not None:
        return Halftone(reference.target, weights, reference.spacing, reference.pull)
    return Tone(reference.target, weights)


def _network_loss(name: str, loss_options: LossOptions, reference: Reference, network: Network) -> NetworkLoss:
    torch_rng = Generator().manual_seed(0)  # the same views for every seed, so that plans can be compared
    views = random_views(_VIEWS, reference.weights.shape[0], reference.weights.shape[1], torch_rng)
    if name == "text":
        if not isinstance(network, ReadingNetwork):
            raise InputError(f"{network.name} cannot read; a text needs CLIP: name a model with {option('clip')}")
        return TextMatch(network, loss_options.text or "", views, reference.paper)
    if name == "look":
        assert loss_options.look is not None
        picture = torch.from_numpy(np.ascontiguousarray(loss_options.look.transpose(2, 0, 1))).to(reference.weights)
        return Look(network, picture, views, reference.paper, torch_rng)
    assert reference.target is not None
    if name == "sketch":
        return sketch(network, reference.target, views, reference.paper, grey=reference.grey)
    return Likeness(network, reference.target, views, reference.paper, grey=reference.grey)
