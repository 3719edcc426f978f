"""Shapes as they lie on the sheet: their lines, cut by clips, and the regions they fill."""

from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from maulstick.drawing.layout import Layout
from maulstick.drawing.lines import cut, polylines
from maulstick.drawing.regions import region_of
from maulstick.drawing.shapes import Clip, Shape
from maulstick.storage.arrays import Floats

_ON_EDGE = 1e-9  # metres beyond the sheet's edge that count as rounding


class Placed:
    """Shapes on the sheet of a layout.

    lines: of each shape its lines (k, 2), metres, of which clips have cut away what lies outside.
    cropped: number of lines that `on_sheet` has cut so far.
    """

    def __init__(self, shapes: Sequence[Shape], layout: Layout) -> None:
        self.shapes, self.layout, self.cropped = shapes, layout, 0
        self._regions: dict[tuple[int, ...], BaseGeometry] = {}
        self._whole = self._polylines(shapes)
        self.lines = list(self._whole)
        clipped: dict[tuple[int, ...], list[int]] = {}
        for index, shape in enumerate(shapes):
            if shape.clips:
                clipped.setdefault(tuple(map(id, shape.clips)), []).append(index)
        for indices in clipped.values():
            region = self._within(shapes[indices[0]].clips)
            for index in indices:
                self.lines[index] = [piece for pieces in cut(self._whole[index], region) for piece in pieces]

    def filled(self, index: int) -> BaseGeometry:
        """Return the region of the sheet that a shape fills, within its clips."""
        shape = self.shapes[index]
        region = region_of(self._whole[index], shape.rule)
        if shape.clips:
            region = shapely.intersection(region, self._within(shape.clips))
        return region if shapely.covers(self._sheet, region) else shapely.intersection(region, self._sheet)

    def on_sheet(self, lines: Sequence[Floats]) -> list[Floats]:
        """Return what of the lines (k, 2) lies on the sheet, and count those that are cut."""
        if not lines:
            return []
        sizes = [len(line) for line in lines]
        points = np.concatenate(lines)
        off = ((points < -_ON_EDGE) | (points > self.layout.sheet + _ON_EDGE)).any(axis=1)
        beyond = np.logical_or.reduceat(off, np.cumsum([0, *sizes[:-1]]))
        self.cropped += int(beyond.sum())
        if not beyond.any():
            return list(lines)
        cut_ones = iter(cut([line for line, is_off in zip(lines, beyond, strict=True) if is_off], self._sheet))
        found: list[Floats] = []
        for line, is_off in zip(lines, beyond, strict=True):
            found += next(cut_ones) if is_off else [line]
        return found

    @property
    def _sheet(self) -> BaseGeometry:
        return shapely.box(0.0, 0.0, *self.layout.sheet)

    def _polylines(self, shapes: Sequence[Shape]) -> list[list[Floats]]:
        chains = [chain for shape in shapes for chain in shape.chains]
        lines = iter(polylines(chains, self.layout.turn, self.layout.shift))
        return [[next(lines) for _ in shape.chains] for shape in shapes]

    def _within(self, clips: tuple[Clip, ...]) -> BaseGeometry:
        """Return the region within all of the clips."""
        key = tuple(map(id, clips))
        if key not in self._regions:
            regions = [self._region(clip) for clip in clips]
            self._regions[key] = regions[0] if len(regions) == 1 else shapely.intersection_all(regions)
        return self._regions[key]

    def _region(self, clip: Clip) -> BaseGeometry:
        regions = []
        for shape, rings in zip(clip.shapes, self._polylines(clip.shapes), strict=True):
            region = region_of(rings, shape.rule)
            regions.append(shapely.intersection(region, self._within(shape.clips)) if shape.clips else region)
        return shapely.union_all(regions) if regions else shapely.Polygon()
