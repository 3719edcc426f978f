"""Regions of a sheet: where which hand draws, with which brushes and colours, how densely, and where nothing may be."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import torch
from scipy.ndimage import distance_transform_edt
from torch import Tensor

from maulstick.painting.raster import Canvas
from maulstick.planning.bare_paper import BarePaper
from maulstick.planning.parameters import StrokeParameters
from maulstick.rendering.traj2stroke import Traj2Stroke
from maulstick.storage.arrays import Bools, Floats, Image, Ints
from maulstick.style import Style
from maulstick.style.regional import RegionalStyle

_SAME = 1.5 / 255  # of sRGB: a paint that is as near is the colour that a region names
_MANY = 10_000  # strokes, of which regions' shares are found


@dataclass(frozen=True)
class Region:
    """What holds in a region.

    hand: that draws there.  brushes: (B,), which of the plan's may be used there.
    colours: sRGB in [0, 1], the only ones there, None for all.  share: of all strokes, None for what its details need.
    bare: whether no ink may lie there.  angle: radians clockwise from the right, of the chords of all strokes there.
    follows_guides: whether all strokes there lie along the nearest guide.
    importance: how much more it counts than the rest of the sheet.
    weights: of terms of the loss by name, in multiples of the plan's own.
    """

    name: str
    hand: Style
    brushes: tuple[bool, ...]
    colours: tuple[tuple[float, float, float], ...] | None = None
    share: float | None = None
    bare: bool = False
    angle: float | None = None
    follows_guides: bool = False
    importance: float = 1.0
    weights: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True)
class Regions:
    """Regions of a canvas: labels (H, W), each the index of one of those that are `said`; the first is the rest."""

    labels: Ints
    said: tuple[Region, ...]
    canvas: Canvas

    @cached_property
    def style(self) -> RegionalStyle:
        """The hands of all regions as one style."""
        return RegionalStyle([region.hand for region in self.said])

    @cached_property
    def bare_paper(self) -> BarePaper:
        """Where no ink may lie."""
        return BarePaper(np.array([region.bare for region in self.said])[self.labels], self.canvas)

    @cached_property
    def pools(self) -> list[tuple[Bools, float | None]]:
        """Parts of the sheet that strokes do not leave for another, (R,) regions each, and the shares of all strokes.

        Regions with a share of their own are one each; all others are the last. Bare paper, and regions of which no
        pixel is seen, are in none.
        """
        drawn = [region for number, region in enumerate(self.said) if (self.labels == number).any() and not region.bare]
        own = [[region is other for other in self.said] for region in drawn if region.share]
        shares: list[float | None] = [region.share for region in drawn if region.share]
        if any(not region.share for region in drawn):
            own, shares = [*own, [not region.bare and not region.share for region in self.said]], [*shares, None]
        return list(zip(np.array(own, dtype=bool), shares, strict=True))

    def counts(self, strokes: int) -> list[int]:
        """Return how many of so many strokes each pool has."""
        shares = [share or 0.0 for _, share in self.pools]
        if any(share is None for _, share in self.pools):
            shares[-1] = max(1 - sum(shares), 0.0)
        ends = np.round(strokes * np.cumsum(shares) / sum(shares))
        counts: list[int] = np.diff(ends, prepend=0).astype(int).tolist()
        return counts

    def stroke_shares(self, density: Floats) -> Floats:
        """Return the share of all strokes that each region has, (R,), where a density (H, W) spreads a pool's."""
        shares = np.zeros(len(self.said))
        for (members, _), count in zip(self.pools, self.counts(_MANY), strict=True):
            wanted = np.bincount(self.labels.ravel(), self.within(members, density).ravel(), len(self.said))
            shares += count / _MANY * wanted / wanted.sum()
        return shares

    def within(self, members: Bools, density: Floats) -> Floats:
        """Return a density (H, W) in a pool's members (R,) alone; where it is 0 in all of them, an even one there."""
        there = members[self.labels]
        own = density * there
        return own if own.any() else there.astype(np.float64)

    def at(self, centres: Tensor) -> Tensor:
        """Return the region that each of the centres (N, 2), metres, lies in, (N,)."""
        return torch.from_numpy(self.labels[self._pixels(centres.detach().numpy())])

    def emphasis(self, importance: Image, term: str | None = None) -> Image:
        """Return how much each pixel counts in a term of the loss, (H, W); bare paper, where nothing is, not at all."""
        times = np.array([
            0.0 if region.bare else region.importance * dict(region.weights).get(term or "", 1.0)
            for region in self.said
        ])  # fmt: skip
        return np.asarray(importance * times[self.labels], dtype=np.float32)

    def allows_brush(self, number: int) -> Bools:
        """Return where the brush of this number may be used, (H, W)."""
        return np.asarray(np.array([region.brushes[number] for region in self.said])[self.labels])

    def allowed_paints(self, regions: Tensor, paints: Floats) -> Bools:
        """Return which of the paints (k, 3) strokes of these regions, (N,), may have, (N, k)."""
        allowed = np.ones((len(self.said), len(paints)), dtype=bool)
        for number, region in enumerate(self.said):
            if region.colours is not None:
                away = np.abs(paints[:, None] - np.array(region.colours)[None]).max(axis=2)
                allowed[number] = (away < _SAME).any(axis=1)
        return np.asarray(allowed[regions.numpy()])

    def moved_into(self, numbers: tuple[int, ...], centres: Floats) -> Floats:
        """Return centres (N, 2), metres, those outside the regions of these numbers in the nearest of their pixels."""
        if numbers not in self._nearest:
            there = np.isin(self.labels, numbers)
            away = distance_transform_edt(~there, return_distances=False, return_indices=True) if there.any() else None
            self._nearest[numbers] = None if away is None else away.astype(np.int64)
        nearest = self._nearest[numbers]
        here = self._pixels(centres)
        if nearest is None:
            return centres
        row, column = nearest[0][here], nearest[1][here]
        moved = (np.stack([column, row], axis=-1) + 0.5) / self.canvas.pixels_per_metre
        outside = ~np.isin(self.labels[here], numbers)
        return np.where(outside[:, None], moved.astype(centres.dtype), centres)

    @torch.no_grad()
    def move_in(self, strokes: StrokeParameters) -> None:
        """Move strokes by the least that keeps their middles in their regions."""
        regions = self.style.regions_of(strokes.codes)
        centres = strokes.centres.numpy()
        for number in range(len(self.said)):
            rows = (regions == number).numpy()
            centres[rows] = self.moved_into((number,), centres[rows])

    @torch.no_grad()
    def move_off_bare(self, strokes: StrokeParameters, brushes: Traj2Stroke) -> None:
        """Move strokes by the least that keeps them off bare paper. brushes: of each stroke."""
        if self.bare_paper.exists:
            marks = brushes.marks(strokes.trajectories(self.style), 1.0)
            moves = self.bare_paper.moves_off(marks.points.numpy(), marks.thickness.numpy())
            strokes.centres.add_(torch.from_numpy(moves).float())

    @cached_property
    def _nearest(self) -> dict[tuple[int, ...], Ints | None]:
        """Rows and columns of the nearest pixel of some regions, (2, H, W), as they are needed; None for none."""
        return {}

    def _pixels(self, points: Floats) -> tuple[Ints, Ints]:
        place = (points * self.canvas.pixels_per_metre).astype(int)
        height, width = self.labels.shape
        return place[..., 1].clip(0, height - 1), place[..., 0].clip(0, width - 1)
