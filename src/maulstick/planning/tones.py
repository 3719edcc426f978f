"""Tones of one ink: how dark so many strokes of a hand can make a sheet, and the picture made as light as that."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import ceil
from typing import Self

import numpy as np
import torch
from scipy.optimize import brentq
from torch import Tensor

from maulstick.colour.palette import lightness
from maulstick.painting.brush import Brush
from maulstick.planning.layout import Layout
from maulstick.planning.placement import ink_density
from maulstick.rendering.kernels.render import composite
from maulstick.rendering.threads import one_torch_thread
from maulstick.rendering.traj2stroke import Traj2Stroke
from maulstick.storage.arrays import Floats
from maulstick.style import Style
from maulstick.style.lengths import keep_lengths

_SAMPLES = 64  # strokes whose ink is measured: their lengths are the hand's quantiles, so few make a steady mean
_MOST = 0.95  # share of a place that ink may be asked to hide: the last white between lines takes endless strokes
_CROSSING = 0.65  # how far planned strokes cross like random ones, which hide 1 - exp(-ink); 0: they never cross
_NOTHING = 1e-3  # amount below which a place is paper
_LIGHT, _DARK = 0.01, 0.99  # quantiles of a picture that count as its lightest and darkest tone

Colour = tuple[float, float, float]


@dataclass(frozen=True)
class Tones:
    """How amounts of ink in a picture, from 0 (paper) to 1 (ink), become what strokes can give.

    amount' = contrast * max(amount - veil, 0): first the lightest tone becomes the paper, so that differences stay;
    where that is not enough, contrast falls.

    lightest, darkest: L* of the picture's tones in this way.
    """

    veil: float
    contrast: float
    lightest: float
    darkest: float

    @property
    def compressed(self) -> bool:
        """Whether they are not the picture's own."""
        return (self.veil, self.contrast) != (0, 1)

    def apply(self, target: Tensor, paper: Tensor, ink: Colour) -> Tensor:
        """Return the target (C, H, W) in these tones, beside the paper (C, H, W); itself where they are its own."""
        if not self.compressed:
            return target
        full = torch.tensor(ink).to(paper)[:, None, None] - paper
        amount = ((target - paper) * full).sum(dim=0) / full.square().sum(dim=0).clamp(min=1e-9)
        return paper + self.contrast * (amount.clamp(0, 1) - self.veil).clamp(min=0) * full


@dataclass(frozen=True)
class InkSupply:
    """Ink that a picture needs, and that a stroke of a hand gives.

    amounts: (H, W), ink that the picture shows on the sheet as it is.  per_stroke: pixels that a stroke hides alone.
    paper, ink: colours, sRGB in [0, 1].
    """

    amounts: Floats
    per_stroke: float
    paper: Colour
    ink: Colour

    @classmethod
    def of(cls, layout: Layout, brush: Brush, style: Style, ink: Colour) -> Self | None:
        """Return the supply; None without a picture, and for a style that may grow its strokes."""
        if layout.target is None or style.lengths(1) is None:
            return None
        image, under = (each.transpose(2, 0, 1).astype(np.float64) for each in (layout.target, layout.under))
        amounts = ink_density(image, under, np.array(ink))
        return cls(amounts, ink_per_stroke(brush, style, layout.canvas.pixels_per_metre), layout.sheet.paper, ink)

    @property
    def enough(self) -> int:
        """Number of strokes that give all the ink that the picture needs."""
        return max(1, ceil(_needed(self.amounts) / self.per_stroke))

    def tones(self, strokes: int) -> Tones:
        """Return the tones that so many strokes can give."""
        veil, contrast = _compressed(self.amounts, strokes * self.per_stroke)
        shown = self.amounts[self.amounts > _NOTHING] if (self.amounts > _NOTHING).any() else self.amounts
        ends = contrast * (np.quantile(shown, (_LIGHT, _DARK)) - veil).clip(min=0)
        paper = np.array(self.paper)
        return Tones(veil, contrast, *lightness(paper + ends[:, None] * (np.array(self.ink) - paper)).tolist())

    def note(self, strokes: int) -> str | None:
        """Return a sentence for people where so many strokes cannot give the picture's tones."""
        own, tones, share = self.tones(self.enough), self.tones(strokes), strokes / self.enough
        if not tones.compressed:
            return None
        return (
            f"{strokes:,} strokes of this length give {share:.0%} of the ink that the picture needs: its tones, "
            f"L* {own.darkest:.0f} to {own.lightest:.0f}, become {tones.darkest:.0f} to {tones.lightest:.0f}; "
            f"{self.enough:,} strokes would reach them"
        )


def in_tones(layout: Layout, brush: Brush, style: Style, ink: Colour, strokes: int) -> Layout:
    """Return the layout with its picture in the tones that so many strokes can give."""
    supply = InkSupply.of(layout, brush, style, ink)
    if supply is None or layout.target is None:
        return layout
    target, paper = (torch.from_numpy(each.transpose(2, 0, 1).copy()) for each in (layout.target, layout.under))
    image = supply.tones(strokes).apply(target, paper, ink).permute(1, 2, 0).numpy()
    return replace(layout, target=np.ascontiguousarray(image))


@one_torch_thread()
def ink_per_stroke(brush: Brush, style: Style, pixels_per_metre: float) -> float:
    """Return the mean area, pixels, that a stroke of the style hides alone, pressed hardest."""
    generator = torch.Generator().manual_seed(0)
    codes, _ = style.sample(_SAMPLES, generator)
    if (lengths := style.lengths(_SAMPLES)) is not None:
        keep_lengths(codes, style, lengths)
    paths = style.decode(codes).detach()
    hidden = 0.0
    for path in paths:
        corner = path.amin(dim=0) - 2 * brush.widest
        trajectory = torch.cat([path - corner, torch.ones(len(path), 1)], dim=1)[None]
        marks = Traj2Stroke.of([brush]).marks(trajectory, pixels_per_metre)
        size = ((path.amax(dim=0) - corner + 2 * brush.widest) * pixels_per_metre).ceil().int().tolist()
        bare, ones = torch.zeros(1, size[1], size[0]), torch.ones(1, 1)
        profile = marks.falloff, marks.plateau, marks.opacity
        hidden += float(composite(bare, marks.points, marks.thickness, ones, *profile).sum())
    return hidden / _SAMPLES


def _needed(amounts: Floats) -> float:
    """Ink of strokes, in pixels hidden by each alone, that makes these amounts (H, W) where strokes cross."""
    amounts = amounts.clip(0, _MOST)
    return float((amounts + _CROSSING * (-np.log1p(-amounts) - amounts)).sum())


def _compressed(amounts: Floats, given: float) -> tuple[float, float]:
    """Return veil and contrast that make amounts (H, W) need no more ink than is given."""
    if _needed(amounts) <= given:
        return 0.0, 1.0
    lightest = float(np.quantile(amounts[amounts > _NOTHING], _LIGHT))
    if _needed((amounts - lightest).clip(min=0)) <= given:
        return _root(lambda veil: _needed((amounts - veil).clip(min=0)) - given, lightest), 1.0
    return lightest, _root(lambda contrast: _needed(contrast * (amounts - lightest).clip(min=0)) - given, 1.0)


def _root(excess: Callable[[float], float], most: float) -> float:
    return float(brentq(excess, 0.0, most, xtol=1e-6))
