"""Initial strokes: all of them on the empty sheet, and later a few where the canvas is furthest from the picture."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import torch
from scipy.ndimage import gaussian_filter
from torch import Generator, Tensor

from maulstick.painting.brush import Brush
from maulstick.planning.arranged_start import ArrangedStart
from maulstick.planning.inks import Inks
from maulstick.planning.lone_start import OnLines, strokes_on_lines
from maulstick.planning.parameters import StrokeParameters, joined
from maulstick.planning.placement import (
    HALF_WIDTH_IN_SPACINGS,
    Places,
    colours_at,
    detail,
    find_places,
    sizes_at,
    start_strokes,
    unlike,
)
from maulstick.planning.problem import Colour, PlannerSettings, PlanningProblem
from maulstick.planning.regions import Regions
from maulstick.planning.room import surface_of
from maulstick.planning.stroke_canvas import StrokeCanvas, as_array
from maulstick.planning.stroke_effects import TargetView
from maulstick.planning.tracing import drawn, traced, within
from maulstick.storage.arrays import Floats

_LEAST_SHARE = 0.1  # of the strokes of a brush that fills its room, that one gets which cannot: its details need some
_FINER = 0.3  # size of a brush's first strokes beside those of the broader one before, whose details they are
_COLOUR_PX = 2.0  # about a stroke in a region, over which its first colour is averaged: not over its border
_VISIBLE = 2 / 255  # least difference of sRGB between paper and picture that wants a stroke: two steps of 8 bits


class Initialiser:
    """New strokes for a planning problem. All random numbers come from the two generators.

    arranged: whether groups of the hands are placed, where a hand's are known; else each stroke is placed alone.
    """

    def __init__(
        self,
        problem: PlanningProblem,
        options: PlannerSettings,
        arranged: bool,
        rng: np.random.Generator,
        torch_rng: Generator,
    ) -> None:
        self._problem, self._options, self._arranged = problem, options, arranged
        self._rng, self._torch_rng = rng, torch_rng
        self._paper, self._weights = as_array(problem.paper), as_array(problem.weights)
        self._inks = Inks(problem, options.palette)
        self.usual_spacing = (surface_of(problem.room, problem.canvas) / options.strokes) ** 0.5  # metres
        self._arranged_start = ArrangedStart(problem, self.usual_spacing, rng, torch_rng)

    @property
    def palette(self) -> tuple[Colour, ...]:
        """Colours of the inks, or of the paints that are given, the lightest first."""
        return self._inks.palette

    def first(self) -> tuple[StrokeParameters, float]:
        """Return as many strokes as are planned, on the sheet as it is, and the median of their spacing, metres."""
        target = self._problem.target
        if target is None:
            return self._anywhere(self._options.strokes)
        image = as_array(target)
        if self._options.in_ink:
            return self._of_inks(target, self._inks.wanted(target), self._options.strokes, lines=self._lines())
        differs = np.abs(image - self._paper).max(axis=0) > _VISIBLE
        density = detail(image) * gaussian_filter(differs.astype(np.float64), 1) * self._weights
        return self.strokes(target, density, self._options.strokes)

    def completed(self, start: StrokeParameters, pool: int) -> StrokeParameters:
        """Return strokes to start with, and those that are left out, where these leave the canvas furthest off.

        pool: as in `TargetView`. Without a target they are anywhere.
        """
        problem, count = self._problem, self._options.strokes - len(start)
        if problem.target is None:
            return joined([start, self._anywhere(count, self.usual_spacing)[0]])
        with torch.no_grad():
            canvas = StrokeCanvas(start, problem).render()
            missing = self.missing(TargetView(problem.target, problem.weights, pool), canvas)
        if self._options.in_ink:
            return joined([start, self._of_inks(problem.target, missing, count, self.usual_spacing)[0]])
        return joined([start, self.strokes(problem.target, missing[0], count, self.usual_spacing)[0]])

    def by_pool(
        self, rows: Tensor, strokes: StrokeParameters, paint_of: Tensor, density: Floats
    ) -> list[tuple[Tensor, Floats]]:
        """Return rows of the strokes ink by ink and pool by pool, and of each the density (H, W) where it may be.

        paint_of: (N,).  density: as `missing` returns it. Without regions there is one pool.
        """
        ink_of = paint_of[rows] if self._options.in_ink else torch.zeros_like(rows)
        parts = [(rows[ink_of == ink], there) for ink, there in enumerate(density)]
        several = len(density) > 1  # of which one that is nowhere missing stays where it is
        if (regions := self._problem.regions) is not None:
            region_of = regions.style.regions_of(strokes.codes)
            parts = [
                (own[torch.from_numpy(members)[region_of[own]]], regions.within(members, there))
                for own, there in parts
                for members, _ in regions.pools
                if not several or (there * members[regions.labels]).any()
            ]
        return [(own, there) for own, there in parts if len(own) and (there.any() or not several)]

    def missing(self, view: TargetView, canvas: Tensor) -> Floats:
        """Return the density of strokes of each ink that the canvas (C, H, W) still needs to become the target.

        It is (k, H, W), from the lightest ink on, or (1, H, W) of paints.
        """
        if self._options.in_ink:
            return self._inks.missing(view, canvas)
        return unlike(as_array(canvas) - as_array(view.target))[None] * self._weights

    def _lines(self) -> list[Floats]:
        """Return the lines of the picture that strokes may follow, as `traced` does.

        Strokes that are placed alone follow them where one hand draws all.
        """
        problem, guides = self._problem, self._problem.guides
        if problem.lines is None or not (self._arranged or problem.regions is None):
            return []
        lines = traced(problem.lines().astype(np.float64), self._weights)
        return lines if guides is None else [part for line in lines for part in guides.followed(line)]

    def _of_inks(
        self, target: Tensor, density: Floats, count: int, room: float = np.inf, lines: Sequence[Floats] = ()
    ) -> tuple[StrokeParameters, float]:
        """Return `count` strokes as `strokes` does, each ink's as many as its share of the density (k, H, W).

        lines: of the target, that strokes follow, each of the ink that most of it is drawn in.
        """
        parts, all_inks = [], density.sum(axis=0)
        for ink, there, own in self._inks.shares(density, count):
            strokes, spacing = self.pooled(target, there, own, room, within(lines, there > all_inks / 2))
            parts.append((replace(strokes, colours=torch.tensor(ink).expand(own, -1).clone()), spacing))
        return joined([strokes for strokes, _ in parts]), min(spacing for _, spacing in parts)

    def strokes(
        self, target: Tensor, density: Floats, count: int, room: float = np.inf
    ) -> tuple[StrokeParameters, float]:
        """Return `count` strokes spread by the density (H, W) along edges of the target, and their median spacing.

        room: the largest spacing that a stroke is sized for. Both are in metres. Each region's share is kept.
        """
        if (regions := self._problem.regions) is None:
            return self.pooled(target, density, count, room)
        parts = [
            self.pooled(target, regions.within(members, density), own, room)
            for (members, _), own in zip(regions.pools, regions.counts(count), strict=True)
            if own
        ]
        return joined([strokes for strokes, _ in parts]), min(spacing for _, spacing in parts)

    def pooled(
        self, target: Tensor, density: Floats, count: int, room: float = np.inf, lines: Sequence[Floats] = ()
    ) -> tuple[StrokeParameters, float]:
        """Return strokes as `strokes` does, wherever the density is. Each brush is spread over all where it may be.

        lines: as in `ArrangedStart.strokes`.
        """
        if self._arranged:
            return self._in_groups(target, density, count, lines=lines), self.usual_spacing
        layers, spacing, others = [], [], None
        if lines and (on_lines := self._on_lines(target, density, count, lines)) is not None:
            strokes, others, density = on_lines
            layers.append(strokes)
        for number, (share, there) in enumerate(self._shares(count - sum(map(len, layers)), density)):
            if share:
                places = self._places(target, there, share, room)
                layers.append(self._with_brush(number, places, others))
                spacing.append(places.spacing)
        if not spacing:
            return joined(layers), self.usual_spacing
        apart = np.concatenate(spacing)
        nearer = (len(apart) / count) ** 0.5  # as near as these would lie if none were on lines
        return joined(layers), nearer * float(np.median(apart)) / self._problem.canvas.pixels_per_metre

    def _on_lines(self, target: Tensor, density: Floats, count: int, lines: Sequence[Floats]) -> OnLines | None:
        """Return those of `count` strokes that fit lines, laid along them."""
        problem, here = self._problem, drawn(lines, density)
        scale, image = problem.canvas.pixels_per_metre, as_array(target)
        return strokes_on_lines(problem.style, here, image, density, count, problem.brushes[0], scale, self._torch_rng)

    def moved(
        self, strokes: StrokeParameters, target: Tensor, canvas: Tensor, density: Floats, room: float
    ) -> list[StrokeParameters]:
        """Return others in place of some strokes, each alone: of each brush, at the same places; else as `strokes`.

        In colours each is as wide as what is wrong on the canvas (C, H, W) there: a dot is mended by a dot.
        Of an ink they keep it, and are around the hand's strokes that those before are most like. Most of these are
        long, and if others of any length took their place, the hand's lengths would make the rest longer than their
        shapes are.
        """
        like = self._problem.style.decode(strokes.codes).detach() if self._options.in_ink else None
        if self._arranged:
            return [replace(self._in_groups(target, density, len(strokes), like), colours=strokes.colours)]
        places = self._places(target, density, len(strokes), room)
        if not self._options.in_ink:
            widest = HALF_WIDTH_IN_SPACINGS * self.usual_spacing * self._problem.canvas.pixels_per_metre
            sizes = sizes_at(as_array(canvas) - as_array(target), places.centres, widest)
            places = replace(places, spacing=np.minimum(places.spacing, sizes / HALF_WIDTH_IN_SPACINGS))
        others = [self._with_brush(number, places, like) for number in range(len(self._problem.brushes))]
        return [replace(each, colours=strokes.colours) for each in others] if self._options.in_ink else others

    def _shares(self, count: int, density: Floats) -> list[tuple[int, Floats]]:
        """Return how many of the strokes each brush is given, and the density (H, W) where it may be.

        The less of a stroke's room a brush can fill, and of the density it may be on, the fewer.
        """
        problem, there = self._problem, []
        fills = [brush.widest / (HALF_WIDTH_IN_SPACINGS * self.usual_spacing) for brush in problem.brushes]
        parts = np.clip(fills, _LEAST_SHARE, 1)
        for number in range(len(problem.brushes)):
            allowed = 1.0 if problem.regions is None else problem.regions.allows_brush(number)
            there.append(density * allowed)
            if problem.regions is not None:
                parts[number] *= there[number].sum() / max(density.sum(), 1e-9)
        ends = np.cumsum(parts if parts.sum() > 0 else np.eye(len(parts))[0])
        shares = np.diff(np.round(count * ends / ends[-1]), prepend=0).astype(int).tolist()
        return list(zip(shares, there, strict=True))

    def _places(self, target: Tensor, density: Floats, count: int, room: float) -> Places:
        scale = self._problem.canvas.pixels_per_metre
        places = find_places(as_array(target), density, count, self._rng, room * scale)
        if (regions := self._problem.regions) is None:
            return places
        wanted = np.flatnonzero(np.bincount(regions.labels.ravel(), density.ravel(), len(regions.said)))
        centres = scale * regions.moved_into(tuple(wanted.tolist()), places.centres / scale)
        return replace(places, centres=centres, colours=colours_at(as_array(target), centres, _COLOUR_PX))

    def _with_brush(self, number: int, places: Places, like: Tensor | None = None) -> StrokeParameters:
        """Return strokes of the brush of that number at the places, each by the hand of its region, along guides.

        like: as in `start_strokes`.
        """
        problem, scale = self._problem, self._problem.canvas.pixels_per_metre
        finer = replace(places, spacing=_FINER**number * places.spacing)
        if problem.guides is not None:
            finer = problem.guides.turned(finer)
        if problem.regions is None:
            strokes = start_strokes(finer, problem.style, problem.brushes[number], scale, self._torch_rng, like)
        else:
            strokes = self._of_regions(problem.regions, finer, problem.brushes[number], like)
        strokes.brush_of.fill_(number)
        return strokes

    def _of_regions(self, regions: Regions, places: Places, brush: Brush, like: Tensor | None) -> StrokeParameters:
        """Return strokes at the places, each by the hand of its region."""
        scale, parts, order = self._problem.canvas.pixels_per_metre, [], []
        region_of = regions.at(torch.from_numpy(places.centres / scale)).numpy()
        for number in np.unique(region_of).tolist():
            rows, region = np.flatnonzero(region_of == number), regions.said[number]
            own = Places(**{name: array[rows] for name, array in vars(places).items()})
            strokes = start_strokes(
                own, region.hand, brush, scale, self._torch_rng, None if like is None else like[rows]
            )
            parts.append(replace(strokes, codes=regions.style.codes_in(number, strokes.codes)))
            order.append(rows)
        return joined(parts)[torch.from_numpy(np.concatenate(order).argsort())]

    def _in_groups(
        self, target: Tensor, density: Floats, count: int, like: Tensor | None = None, lines: Sequence[Floats] = ()
    ) -> StrokeParameters:
        """Return `count` strokes as `strokes` does, arranged as the hand, or the hand of each region, arranges them.

        like, lines: as in `ArrangedStart.strokes`.
        """
        regions, style = self._problem.regions, self._problem.style
        if regions is None:
            return self._arranged_start.strokes(style, target, density, count, like, lines)
        ends = np.cumsum(np.bincount(regions.labels.ravel(), density.ravel(), len(regions.said)))
        counts = np.diff(np.round(count * ends / ends[-1]), prepend=0).astype(int).tolist()
        likes = [None] * len(counts) if like is None else like.split(counts)
        parts = []
        for number, (region, own, own_like) in enumerate(zip(regions.said, counts, likes, strict=True)):
            there = density * (regions.labels == number)
            if own and region.hand.arrangement is None:
                parts.append(self._with_brush(0, self._places(target, there, own, np.inf), own_like))
            elif own:
                strokes = self._arranged_start.strokes(region.hand, target, there, own, own_like, lines)
                parts.append(replace(strokes, codes=regions.style.codes_in(number, strokes.codes)))
        return joined(parts)

    def _anywhere(self, count: int, room: float = np.inf) -> tuple[StrokeParameters, float]:
        """Return strokes all over the sheet in random colours, and their spacing, both as `strokes` does."""
        density = np.ones_like(self._weights)
        if (free := self._problem.room) is not None:
            left, top, right, bottom = (round(edge * self._problem.canvas.pixels_per_metre) for edge in free)
            density[:] = 0
            density[top:bottom, left:right] = 1
        if self._options.in_ink:
            return self._of_inks(self._problem.paper, self._inks.everywhere(density), count, room)
        strokes, spacing = self.strokes(self._problem.paper, density, count, room)
        strokes.colours.copy_(torch.rand(strokes.colours.shape, generator=self._torch_rng))
        return strokes, spacing
