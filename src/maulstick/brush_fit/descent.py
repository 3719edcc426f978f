"""The numbers of one brush, found by gradient descent together with what differs from stroke to stroke."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import torch
from scipy.optimize import minimize_scalar
from torch import Tensor
from torch.nn.functional import softplus

from maulstick.brush_fit.mosaic import Mosaic
from maulstick.painting.brush import CURVE_PRESSURES
from maulstick.rendering.traj2stroke import Traj2Stroke

PAPER = ("scale", "alpha", "beta", "falloff")
"""The paper's numbers but for b, which is the middle of all strokes' own places."""

ADDITIONS = ("plateau", "curve", "lag", "nib")
"""What may be added to the paper's brush; a lag brings a touch along."""

_LEAST_C = 0.15  # below it a mark is as good as hard-edged, and no gradient finds its width any more
_RATE = 0.04
_WARM_UP = 0.15  # of the steps
_OFTEN = 25  # steps
_TURN = 0.3  # of the logarithm of opacity, at once
_PUREST = 1e-3  # of a colour, from black or white


@dataclass(frozen=True)
class Unknowns:
    """All that is sought, in units in which a step of one size suits each.

    unit: metres, about the half-width of the mark.  brush: name -> (k,) raw numbers, of those that are not neutral.
    place: (N, 2) how far each stroke lies beside where it was commanded, in units.  ink: (N,) log of its opacity.
    colour: (C,) logits, or None where full ink is 1 as in darkness images.
    """

    unit: float
    brush: Mapping[str, Tensor]
    place: Tensor
    ink: Tensor
    colour: Tensor | None

    def adding(self, additions: Iterable[str]) -> "Unknowns":
        """The same with some of `ADDITIONS`, near their neutral values."""
        return replace(self, brush={**self.brush, **{k: v for name in additions for k, v in _FIRST[name].items()}})

    def each(self, change: Callable[[Tensor], Tensor]) -> "Unknowns":
        """The same with every tensor changed alike."""
        return Unknowns(
            self.unit,
            {name: change(raw) for name, raw in self.brush.items()},
            change(self.place),
            change(self.ink),
            None if self.colour is None else change(self.colour),
        )

    def numbers(self) -> dict[str, Tensor]:
        """The brush's numbers (k,) in metres and shares, neutral ones too."""
        return {
            name: _MEANING[name](self.brush[name], self.unit) if name in self.brush else neutral
            for name, neutral in _NEUTRAL.items()
        }

    def ink_colour(self) -> Tensor:
        """(C,) of full ink."""
        return torch.ones(1) if self.colour is None else self.colour.sigmoid()


_FIRST: Mapping[str, Mapping[str, Tensor]] = {
    "plateau": {"plateau": torch.tensor([0.0])},
    "curve": {"curve": torch.zeros(len(CURVE_PRESSURES) + 1)},
    "lag": {"lag": torch.tensor([-0.7]), "touch": torch.zeros(2)},
    "nib": {"nib": torch.zeros(2)},
}

_MEANING: Mapping[str, Callable[[Tensor, float], Tensor]] = {
    "scale": lambda raw, unit: 1 + 0.1 * raw,
    "alpha": lambda raw, unit: unit * softplus(raw),
    "beta": lambda raw, unit: unit * raw,
    "falloff": lambda raw, unit: _LEAST_C + raw.exp(),
    "plateau": lambda raw, unit: 0.98 * raw.sigmoid(),
    "curve": lambda raw, unit: raw.softmax(0).cumsum(0)[:-1],
    "lag": lambda raw, unit: unit * raw.exp(),
    "touch": lambda raw, unit: unit * raw,
    "nib": lambda raw, unit: raw / (1.1 + raw.norm()),
}

_NEUTRAL = {
    "scale": torch.ones(2),
    "alpha": torch.zeros(1),
    "beta": torch.zeros(1),
    "falloff": torch.ones(1),
    "plateau": torch.zeros(1),
    "curve": torch.tensor(CURVE_PRESSURES),
    "lag": torch.zeros(1),
    "touch": torch.zeros(2),
    "nib": torch.zeros(2),
}


def each_stroke(numbers: Mapping[str, Tensor], place: Tensor, opacity: Tensor) -> Traj2Stroke:
    """One brush a stroke: the numbers (N, k) of each, its place (N, 2) in metres and its opacity (N,)."""
    alone = {name: numbers[name][:, 0] for name in ("alpha", "beta", "falloff", "plateau", "lag")}
    several = {name: numbers[name] for name in ("scale", "curve", "touch", "nib")}
    solid = torch.ones(len(place))
    return Traj2Stroke(**alone, **several, shift=place, opacity=opacity, faint=solid, solid=solid)


def stamped(mosaic: Mosaic, unknowns: Unknowns, taught: Tensor) -> Tensor:
    """The photographs (C, H, W) that the unknowns predict; only strokes (N,) that are `taught` teach the brush.

    The others still find their own place and ink, so what is left of their errors is the brush's.
    """
    count = len(mosaic)

    def shared(number: Tensor) -> Tensor:
        return torch.where(taught[:, None], number.expand(count, -1), number.detach().expand(count, -1))

    numbers = {name: shared(number) for name, number in unknowns.numbers().items()}
    return mosaic.stamped(
        each_stroke(numbers, unknowns.unit * unknowns.place, unknowns.ink.exp()), unknowns.ink_colour()
    )


def descend(mosaic: Mosaic, start: Unknowns, taught: Tensor, steps: int, progress: Callable[[], None]) -> Unknowns:
    """The unknowns after so many steps of Adam down the weighted L1 of the paper."""
    unknowns = start.each(lambda tensor: tensor.detach().clone().requires_grad_())
    leaves = [*unknowns.brush.values(), unknowns.place, unknowns.ink]
    leaves += [] if unknowns.colour is None else [unknowns.colour]
    optimiser = torch.optim.Adam(leaves, lr=_RATE)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, _RATE, total_steps=steps + 1, pct_start=_WARM_UP)
    for step in range(1, steps + 1):
        optimiser.zero_grad()
        mosaic.loss(stamped(mosaic, unknowns, taught)).backward()
        optimiser.step()
        with torch.no_grad():
            unknowns.ink.clamp_(max=0)  # beyond full ink no gradient would lead back
            if unknowns.colour is not None and step % _OFTEN == 0:
                _see_through(mosaic, unknowns, unknowns.colour, taught)
        schedule.step()
        progress()
    return unknowns.each(Tensor.detach)


def _see_through(mosaic: Mosaic, unknowns: Unknowns, colour: Tensor, taught: Tensor) -> None:
    """All strokes paler and their ink darker, or the reverse, as suits best what shines through where they cross.

    On bare paper both look alike, so that each number alone, which is all that the gradient sees, is best as it is.
    """
    ink, seen = unknowns.ink.clone(), colour.sigmoid()
    bare = mosaic.before[:, mosaic.counts > 0].median(dim=1).values

    def turned(opacity: float) -> float:
        unknowns.ink.copy_((ink + opacity).clamp(max=0))
        colour.copy_((bare + (seen - bare) / np.exp(opacity)).logit(_PUREST))
        return float(mosaic.loss(stamped(mosaic, unknowns, taught)))

    as_it_was = turned(0)
    best = minimize_scalar(turned, bounds=(-_TURN, _TURN), method="bounded", options={"xatol": 0.01})
    turned(best.x if best.fun < as_it_was else 0)
