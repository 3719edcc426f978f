"""Gradient descent to the numbers of one brush, together with each stroke's own offset and opacity."""

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
"""Names of the paper's numbers, except b, which is the median of the strokes' own offsets."""

ADDITIONS = ("plateau", "curve", "lag", "nib")
"""Names of what may be added to the paper's brush; a lag comes with a touch."""

_LEAST_C = 0.15  # least falloff: below it a mark is nearly hard-edged, and no gradient finds its width any more
_RATE = 0.04  # highest learning rate, in the units of `Unknowns`
_WARM_UP = 0.15  # share of the steps in which the learning rate rises
_OFTEN = 25  # steps between searches along opacity and colour
_TURN = 0.3  # largest change of the logarithm of opacity in one search
_PUREST = 1e-3  # least distance of a colour from black and white, which have infinite logits


@dataclass(frozen=True)
class Unknowns:
    """Unknowns of a fit, scaled so that one step size suits all of them.

    unit: metres, about the half-width of the mark.  brush: raw numbers (k,) by name, of those that are not neutral.
    place: (N, 2) offset of each stroke from its commanded place, in units.  ink: (N,) log of each stroke's opacity.
    colour: (C,) logits, or None where full ink is 1 as in darkness images.
    """

    unit: float
    brush: Mapping[str, Tensor]
    place: Tensor
    ink: Tensor
    colour: Tensor | None

    def adding(self, additions: Iterable[str]) -> "Unknowns":
        """Return the unknowns with some of `ADDITIONS`, near their neutral values."""
        return replace(self, brush={**self.brush, **{k: v for name in additions for k, v in _FIRST[name].items()}})

    def pick(self, which: Tensor) -> "Unknowns":
        """Return the unknowns of the strokes of these indices (M,) alone."""
        return replace(self, place=self.place[which], ink=self.ink[which])

    def each(self, change: Callable[[Tensor], Tensor]) -> "Unknowns":
        """Return the unknowns with `change` applied to every tensor."""
        return Unknowns(
            self.unit,
            {name: change(raw) for name, raw in self.brush.items()},
            change(self.place),
            change(self.ink),
            None if self.colour is None else change(self.colour),
        )

    def numbers(self) -> dict[str, Tensor]:
        """Return all numbers (k,) of the brush by name, in metres and shares, neutral ones too."""
        return {
            name: _MEANING[name](self.brush[name], self.unit) if name in self.brush else neutral
            for name, neutral in _NEUTRAL.items()
        }

    def ink_colour(self) -> Tensor:
        """Return the colour (C,) of full ink."""
        return torch.ones(1) if self.colour is None else self.colour.sigmoid()


_FIRST: Mapping[str, Mapping[str, Tensor]] = {  # raw numbers with which an addition starts
    "plateau": {"plateau": torch.tensor([0.0])},
    "curve": {"curve": torch.zeros(len(CURVE_PRESSURES) + 1)},
    "lag": {"lag": torch.tensor([-0.7]), "touch": torch.zeros(2)},
    "nib": {"nib": torch.zeros(2)},
}

_MEANING: Mapping[str, Callable[[Tensor, float], Tensor]] = {  # number in metres or shares of a raw number
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

_NEUTRAL = {  # numbers that change nothing, in metres or shares
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
    """Return one brush per stroke from the numbers (N, k), offsets (N, 2) in metres and opacities (N,)."""
    alone = {name: numbers[name][:, 0] for name in ("alpha", "beta", "falloff", "plateau", "lag")}
    several = {name: numbers[name] for name in ("scale", "curve", "touch", "nib")}
    solid = torch.ones(len(place))
    return Traj2Stroke(**alone, **several, shift=place, opacity=opacity, faint=solid, solid=solid)


def stamped(mosaic: Mosaic, unknowns: Unknowns) -> Tensor:
    """Return the photographs (C, H, W) that the unknowns predict."""
    numbers = {name: number.expand(len(mosaic), -1) for name, number in unknowns.numbers().items()}
    return mosaic.stamped(
        each_stroke(numbers, unknowns.unit * unknowns.place, unknowns.ink.exp()), unknowns.ink_colour()
    )


def descend(mosaic: Mosaic, start: Unknowns, steps: int, progress: Callable[[], None]) -> Unknowns:
    """Return the unknowns after `steps` steps of Adam on the weighted L1 of the paper."""
    unknowns = start.each(lambda tensor: tensor.detach().clone().requires_grad_())
    leaves = [*unknowns.brush.values(), unknowns.place, unknowns.ink]
    leaves += [] if unknowns.colour is None else [unknowns.colour]
    optimiser = torch.optim.Adam(leaves, lr=_RATE)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, _RATE, total_steps=steps + 1, pct_start=_WARM_UP)
    for step in range(1, steps + 1):
        optimiser.zero_grad()
        mosaic.loss(stamped(mosaic, unknowns)).backward()
        for leaf in leaves:  # a pixel on the very edge of a mark whose c is below 1 has an infinite slope
            leaf.grad = None if leaf.grad is None else leaf.grad.nan_to_num(0, 0, 0)
        optimiser.step()
        with torch.no_grad():
            unknowns.ink.clamp_(max=0)  # beyond full ink the gradient is 0
            if unknowns.colour is not None and step % _OFTEN == 0:
                _see_through(mosaic, unknowns, unknowns.colour)
        schedule.step()
        progress()
    return unknowns.each(Tensor.detach)


def _see_through(mosaic: Mosaic, unknowns: Unknowns, colour: Tensor) -> None:
    """Make all strokes paler and their ink darker, or the reverse, by a line search on what shows where they cross.

    On bare paper the two changes cancel, so that the gradient, which sees each number alone, does not find this.
    """
    ink, seen = unknowns.ink.clone(), colour.sigmoid()
    bare = mosaic.before[:, mosaic.counts > 0].median(dim=1).values

    def turned(opacity: float) -> float:
        unknowns.ink.copy_((ink + opacity).clamp(max=0))
        colour.copy_((bare + (seen - bare) / np.exp(opacity)).logit(_PUREST))
        return float(mosaic.loss(stamped(mosaic, unknowns)))

    as_it_was = turned(0)
    best = minimize_scalar(turned, bounds=(-_TURN, _TURN), method="bounded", options={"xatol": 0.01})
    turned(best.x if best.fun < as_it_was else 0)
