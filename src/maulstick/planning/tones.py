"""Tones of inks: how dark so many strokes of a hand can make a sheet, and the picture with no more ink than that."""

from dataclasses import dataclass, replace
from math import ceil, e, log, pi, sqrt
from typing import Self

import numpy as np
import torch
from scipy.ndimage import gaussian_filter, gaussian_filter1d
from scipy.optimize import brentq
from torch import Tensor

from maulstick.colour.palette import lightness
from maulstick.painting.brush import Brush
from maulstick.planning.layout import Layout
from maulstick.planning.problem import Colour
from maulstick.planning.regions import Regions
from maulstick.planning.separation import separated
from maulstick.rendering.kernels.render import composite
from maulstick.rendering.threads import one_torch_thread
from maulstick.rendering.traj2stroke import Traj2Stroke
from maulstick.storage.arrays import Floats
from maulstick.storage.text import counted
from maulstick.style import Style
from maulstick.style.lengths import keep_lengths

_SAMPLES = 64  # strokes whose ink is measured: their lengths are the hand's quantiles, so few make a steady mean
_MOST = 0.95  # share of a place that ink may be asked to hide: the last white between lines takes endless strokes
_CROSSING = 0.65  # how far planned strokes cross like random ones, which hide 1 - exp(-ink); 0: they never cross
_ENOUGH = 0.93  # share of that ink with which plans reach 97 % of a picture's, by bisecting (benchmarks/enough.py)
_NOTHING = 1e-3  # amount below which a place is paper
_LIGHTS = 0.4  # how much ink costs in lights left blank; by eye: at 0.1 long strokes lie across faces
_LINES = 0.8  # how much ink earns on lines, which strokes leave for darks else: faces lost their mouths
_LIGHT, _DARK = 0.01, 0.99  # quantiles of a picture that count as its lightest and darkest tone
_GLANCE = 2e-3  # metres: standard deviation of a Gaussian, within which an eye sees lines at once, as a tone
_LEVELS = 512  # amounts that are told apart while tones are chosen
_VEILS = 64  # tried
_BINS = 20  # of a histogram, for each standard deviation of what lines tell


@dataclass(frozen=True)
class Tones:
    """How amounts of ink in a picture, from 0 (paper) to 1 (ink), become what strokes can give.

    amount' = contrast * max(amount - veil, 0): what is lighter than the veil is left blank. Of several inks it is their
    sum, and all change alike.

    lightest, darkest: L* of the picture's tones in this way, in the strongest ink.  inks: sRGB in [0, 1].
    lines: how dark the lines that carry the picture are drawn over its tones, from 0 to 1.
    """

    veil: float
    contrast: float
    lightest: float
    darkest: float
    inks: tuple[Colour, ...]
    lines: float = 0.0

    @property
    def compressed(self) -> bool:
        """Whether they are not the picture's own."""
        return (self.veil, self.contrast) != (0, 1)

    def apply(self, target: Tensor, paper: Tensor) -> Tensor:
        """Return the target (C, H, W) in these tones, beside the paper (C, H, W); itself where they are its own."""
        if not self.compressed:
            return target
        amounts = separated(target, paper, self.inks)
        own = amounts.sum(dim=0)
        wanted = (self.contrast * (own - self.veil)).clamp(0, 1)
        return self._mixed(amounts / own.clamp(min=torch.finfo(own.dtype).tiny) * wanted, paper)

    def in_ink(self, image: Tensor, paper: Tensor) -> Tensor:
        """Return the image (C, H, W) as these inks can show it on the paper (C, H, W): without colours of its own."""
        return self._mixed(separated(image, paper, self.inks), paper)

    def away_from_lights(self, target: Tensor, picture: Tensor, paper: Tensor) -> Tensor | None:
        """Return the slope (C, H, W) of a canvas whose ink costs in lights left blank, or None where these leave none.

        target: (C, H, W), in these tones.  picture: (C, H, W), in its own: the lighter it is, the more ink costs.
        paper: (C, H, W), under the ink.  Images that are blurred to tones hardly see a line there.
        """
        if not self.compressed:
            return None
        wanted, own = (separated(image, paper, self.inks).sum(dim=0) for image in (target, picture))
        full = self._full(paper)
        slope = full.mean(dim=0)
        for each in [*full, *full]:  # on toned paper the mean of dark and light ink would pay for one of them
            product, square = (slope * each).sum(dim=0), each.square().sum(dim=0).clamp(min=1e-9)
            slope = slope - product.clamp(max=0) / square * each
        return 2 * _LIGHTS * (wanted < _NOTHING) * (1 - own) * slope

    def with_lines(self, target: Tensor, dark: Tensor, ink: Tensor) -> Tensor:
        """Return the target (C, H, W), in these tones, under lines of an ink (C, 1, 1) that are so dark (H, W)."""
        return target + self.lines * dark * (ink - target)

    def towards_lines(self, dark: Tensor, ink: Tensor, paper: Tensor) -> Tensor:
        """Return the slope (C, H, W) of a canvas whose ink (C, 1, 1) earns on lines that are so dark (H, W)."""
        return _LINES * self.lines * dark * (paper - ink)

    def _mixed(self, amounts: Tensor, paper: Tensor) -> Tensor:
        return paper + (amounts[:, None] * self._full(paper)).sum(dim=0)

    def _full(self, paper: Tensor) -> Tensor:
        return torch.tensor(self.inks, dtype=paper.dtype, device=paper.device)[:, :, None, None] - paper


@dataclass(frozen=True)
class InkSupply:
    """Ink that a picture needs, and that a stroke of a hand, or of several hands, gives.

    amounts: (H, W), ink that the picture shows on the sheet as it is.  glanced: (H, W), the same as an eye sees it.
    per_stroke: pixels that a stroke hides alone, pressed hardest.  per_line: the same, pressed so that it is no wider
    than what an eye sees at once.  glance_lines: strokes that hide what an eye sees at once.
    paper, inks: colours, sRGB in [0, 1].  with_lines: whether lines are drawn over tones, as dark as ink is short.
    """

    amounts: Floats
    glanced: Floats
    per_stroke: float
    per_line: float
    glance_lines: float
    paper: Colour
    inks: tuple[Colour, ...]
    with_lines: bool

    @classmethod
    def of(
        cls,
        layout: Layout,
        brush: Brush,
        style: Style,
        inks: tuple[Colour, ...],
        *,
        with_lines: bool,
        regions: Regions | None = None,
    ) -> Self | None:
        """Return the supply; None without a picture, and where all strokes may grow.

        regions: of the sheet, whose hands count in place of the style, each by its strokes. Bare paper needs no ink;
        where strokes may grow they give what is needed there, and nothing elsewhere.
        """
        if layout.target is None:
            return None
        image, under = (torch.from_numpy(each).permute(2, 0, 1).double() for each in (layout.target, layout.under))
        amounts = separated(image, under, inks).sum(dim=0).numpy()
        hands = [style] if regions is None else [region.hand for region in regions.said]
        may_grow, shares = np.array([hand.lengths(1) is None for hand in hands]), np.ones(1)
        if regions is not None:
            amounts[regions.bare_paper.bare] = 0
            shares = regions.stroke_shares(amounts)
            amounts[may_grow[regions.labels]] = 0
        of_hands = [(hands[number], float(shares[number])) for number in np.flatnonzero(shares * ~may_grow)]
        if not of_hands:
            return None
        resolution = layout.canvas.pixels_per_metre
        glanced = gaussian_filter(amounts, _GLANCE * resolution)
        lines = sqrt(pi) * _GLANCE / brush.widest
        per_stroke = per_line = _mean_ink(brush, of_hands, resolution, 1)
        if brush.pressure_matters:
            per_line = _mean_ink(brush, of_hands, resolution, float(brush.pressure_for(np.array(_GLANCE / 2))))
        return cls(amounts, glanced, per_stroke, per_line, lines, layout.sheet.paper, inks, with_lines)

    @property
    def needed(self) -> float:
        """Ink of strokes, in pixels hidden by each alone, with which plans show the picture in its own tones."""
        return _ENOUGH * Amounts.of(self.amounts).needed

    @property
    def enough(self) -> int:
        """Number of lines that give the ink that the picture needs; fewer, broader strokes would not show it."""
        return max(1, ceil(self.needed / self.per_line))

    @property
    def fewest(self) -> int:
        """Number of strokes, pressed hardest, that give the ink that the picture needs."""
        return max(1, ceil(self.needed / self.per_stroke))

    def tones(self, strokes: int) -> Tones:
        """Return the tones that so many strokes can give: of all that need their ink, those that tell most.

        A person leaves the lights blank, and has ink for the darks. Lines lie by chance: n of them where an eye sees
        them at once spread by sqrt(n), so 2 sqrt(n) spreads by 1 in all tones (Anscombe 1948), and what a picture
        tells is the entropy of that number with this noise, less the noise's own.
        """
        given = strokes * self.per_stroke
        shown = self.amounts > _NOTHING
        lightest, darkest = np.quantile(self.amounts[shown], (_LIGHT, _DARK)) if shown.any() else (0.0, 0.0)
        veil, contrast, lines = 0.0, 1.0, 0.0
        if shown.any() and given < self.needed:
            amounts, seen = Amounts.of(self.amounts), Amounts.of(self.glanced[shown])
            lines = self.with_lines * (1 - given / amounts.needed)
            choices = _choices(amounts, darkest, given)
            veil, contrast = max(choices, key=lambda choice: seen.inked(*choice).told(self.glance_lines))
        ends = (contrast * (np.array([lightest, darkest]) - veil)).clip(0, 1)
        paper = np.array(self.paper)
        light, dark = lightness(
            paper + ends[:, None] * (np.array(strongest_of(self.inks, self.paper)) - paper)
        ).tolist()
        return Tones(veil, contrast, light, dark, self.inks, lines)

    def note(self, strokes: int) -> str | None:
        """Return a sentence for people where so many strokes cannot give the picture's tones."""
        own, tones, share = self.tones(self.fewest), self.tones(strokes), strokes / self.fewest
        if not tones.compressed:
            return None
        given = counted(strokes, "stroke of this length gives", "strokes of this length give")
        return (
            f"{given} {share:.0%} of the ink that the picture needs: its tones, "
            f"L* {own.darkest:.0f} to {own.lightest:.0f}, become {tones.darkest:.0f} to {tones.lightest:.0f}; "
            f"{counted(self.fewest, 'stroke')} would reach them"
        )


def _mean_ink(brush: Brush, hands: list[tuple[Style, float]], pixels_per_metre: float, pressure: float) -> float:
    """Return the mean area, pixels, that a stroke hides alone, of hands that have these shares of all strokes."""
    each = {id(hand): ink_per_stroke(brush, hand, pixels_per_metre, pressure) for hand, _ in hands}
    return sum(each[id(hand)] * share for hand, share in hands)


@one_torch_thread()
def ink_per_stroke(brush: Brush, style: Style, pixels_per_metre: float, pressure: float = 1) -> float:
    """Return the mean area, pixels, that a stroke of the style hides alone, at a pressure in [0, 1]."""
    generator = torch.Generator().manual_seed(0)
    codes, _ = style.sample(_SAMPLES, generator)
    if (lengths := style.lengths(_SAMPLES)) is not None:
        keep_lengths(codes, style, lengths)
    paths = style.decode(codes).detach()
    hidden = 0.0
    for path in paths:
        corner = path.amin(dim=0) - 2 * brush.widest
        trajectory = torch.cat([path - corner, torch.full((len(path), 1), pressure)], dim=1)[None]
        marks = Traj2Stroke.of([brush]).marks(trajectory, pixels_per_metre)
        size = ((path.amax(dim=0) - corner + 2 * brush.widest) * pixels_per_metre).ceil().int().tolist()
        bare, ones = torch.zeros(1, size[1], size[0]), torch.ones(1, 1)
        profile = marks.falloff, marks.plateau, marks.opacity
        hidden += float(composite(bare, marks.points, marks.thickness, ones, *profile).sum())
    return hidden / _SAMPLES


@dataclass(frozen=True)
class Amounts:
    """Histogram of amounts of ink: mean values (N,), and pixels (N,) of each."""

    values: Floats
    pixels: Floats

    @classmethod
    def of(cls, amounts: Floats) -> Self:
        """Return the histogram of amounts in [0, 1]."""
        amounts = amounts.clip(0, 1).ravel()
        level = (amounts * (_LEVELS - 1)).round().astype(np.int64)
        pixels = np.bincount(level, minlength=_LEVELS).astype(np.float64)
        means = np.bincount(level, amounts, _LEVELS)[pixels > 0] / pixels[pixels > 0]  # a veil may lie within a level
        return cls(means, pixels[pixels > 0])

    def inked(self, veil: float, contrast: float) -> Self:
        """Return them as `Tones` make them."""
        return replace(self, values=(contrast * (self.values - veil)).clip(0, 1))

    @property
    def needed(self) -> float:
        """Ink of strokes, in pixels hidden by each alone, that makes these amounts where strokes cross."""
        amounts = self.values.clip(0, _MOST)
        return float(self.pixels @ (amounts + _CROSSING * (-np.log1p(-amounts) - amounts)))

    def told(self, lines: float) -> float:
        """Return what they tell, nats, where 1 is so many lines; see `InkSupply.tones`."""
        seen = 2 * np.sqrt(lines * self.values) * _BINS
        margin = 5 * _BINS
        counts = np.bincount(seen.round().astype(np.int64) + margin, self.pixels, round(seen.max()) + 2 * margin + 1)
        share = gaussian_filter1d(counts / counts.sum(), _BINS, mode="constant")
        share = share[share > 0]
        return float(-(share * np.log(share * _BINS)).sum()) - log(2 * pi * e) / 2


def strongest_of(inks: tuple[Colour, ...], paper: Colour) -> Colour:
    """Return that of the inks which differs most from the paper."""
    return inks[int(np.argmax(np.square(np.array(inks) - paper).sum(axis=1)))]


def draw_light(inks: tuple[Colour, ...], paper: Colour) -> bool:
    """Return whether the strongest of the inks is lighter than the paper, so that it draws what is light."""
    ink_lightness, paper_lightness = lightness(np.array([strongest_of(inks, paper), paper])).tolist()
    return bool(ink_lightness > paper_lightness)


def _choices(amounts: Amounts, darkest: float, given: float) -> list[tuple[float, float]]:
    """Return veils and contrasts that need so much ink: from no veil on, until the darkest tone is its own."""
    choices = []
    for veil in np.linspace(0, darkest, _VEILS, endpoint=False).tolist():
        most = darkest / (darkest - veil)
        if amounts.inked(veil, most).needed < given:
            break
        choices.append((veil, _contrast(amounts, veil, most, given)))
    return choices


def _contrast(amounts: Amounts, veil: float, most: float, given: float) -> float:
    return float(brentq(lambda contrast: amounts.inked(veil, contrast).needed - given, 0.0, most, xtol=1e-6))
