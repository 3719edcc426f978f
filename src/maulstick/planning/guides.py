"""Guides: lines that a person drew on a picture, and angles that regions name, along which strokes lie there."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import torch
from scipy.ndimage import distance_transform_edt, gaussian_filter

from maulstick.painting.raster import Canvas
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.placement import Places, at_pixels
from maulstick.planning.regions import Regions
from maulstick.planning.tracing import parts
from maulstick.storage.arrays import Bools, Complexes, Floats

_REACH = 0.12  # of the canvas' shorter side: so far from a guide strokes still follow it, though less strictly
_BLUR_IN_REACHES = 0.25  # between two guides directions go over into each other
_STEP = 0.5  # pixels between samples of a guide, so that it has no gap
_WANDER = np.pi / 18  # radians that strokes may turn away from a direction that is strict
_CROSSED = 1e-6  # of lines that cross at right angles at a pixel, which has no direction then


@dataclass(frozen=True)
class Guides:
    """Directions that are said, on a canvas.

    field: (H, W), exp(2i angle) of the direction at each pixel, times how strictly strokes lie along it, from 0 to 1.
    angled: (H, W), where it is the angle of a region.
    """

    field: Complexes
    angled: Bools
    canvas: Canvas

    @classmethod
    def of(cls, canvas: Canvas, lines: Sequence[Floats], regions: Regions | None = None) -> Self:
        """Return the directions of lines (k, 2), metres on the canvas, and of regions, which come before lines.

        Lines are followed near by, and all over a region that follows guides, by the nearest of them.
        """
        field = np.zeros((canvas.height_px, canvas.width_px), dtype=complex)
        everywhere, angled = field, np.zeros(field.shape, dtype=bool)
        if lines:
            reach = _REACH * min(field.shape)
            everywhere, away = _nearest(lines, canvas, _BLUR_IN_REACHES * reach)
            field = everywhere * np.exp(-0.5 * (away / reach) ** 2)
        for number, region in enumerate(() if regions is None else regions.said):
            assert regions is not None
            there = regions.labels == number
            if region.follows_guides:
                field[there] = everywhere[there] / np.maximum(np.abs(everywhere[there]), 1e-12)
            elif region.angle is not None:
                field[there] = np.exp(2j * region.angle)
                angled |= there
        return cls(field, angled, canvas)

    def over(self, lines: Complexes) -> Complexes:
        """Return other directions (H, W) of the same kind, less and less so the stricter these are, and these."""
        both: Complexes = self.field + (1 - np.abs(self.field)) * lines
        return both

    def turned(self, places: Places) -> Places:
        """Return places of strokes turned along the directions there, as far as these are strict."""
        said = self._at(self.field, places.centres)
        both = said + (1 - np.abs(said)) * np.exp(2j * places.angles)
        turns = (np.angle(both) / 2 - places.angles + np.pi / 2) % np.pi - np.pi / 2
        return replace(places, angles=places.angles + turns)

    def followed(self, line: Floats) -> list[Floats]:
        """Return the parts of a line (n, 2), pixels, that go along the directions there, as far as these are strict."""
        said = self._at(self.field, line)
        off = np.angle(np.gradient(line @ np.array([1, 1j])) ** 2 * said.conj()) / 2
        return parts(line, np.abs(off) * np.abs(said) <= _WANDER)

    @torch.no_grad()
    def keep(self, strokes: StrokeParameters, *, in_groups: bool = False) -> None:
        """Turn strokes back that have turned away from the directions where they lie.

        in_groups: whether they lie in groups, whose strokes cross; those are turned back by angles of regions alone.
        """
        field = np.where(self.angled, self.field, 0) if in_groups else self.field
        said = self._at(field, self.canvas.pixels_per_metre * strokes.centres.numpy())
        angles = torch.from_numpy(np.angle(said) / 2).to(strokes.angles)
        free = torch.from_numpy(_WANDER / np.maximum(np.abs(said), 1e-12)).to(strokes.angles)
        away = (strokes.angles - angles + torch.pi / 2).remainder(torch.pi) - torch.pi / 2
        strokes.angles.add_(torch.minimum(torch.maximum(away, -free), free) - away)

    def _at(self, field: Complexes, centres: Floats) -> Complexes:
        height, width = field.shape
        found: Complexes = field[at_pixels(centres, width, height)]
        return found


def _nearest(lines: Sequence[Floats], canvas: Canvas, blur: float) -> tuple[Complexes, Floats]:
    """Return the directions of the nearest line, blurred by so many pixels, (H, W), and how far it is, pixels."""
    drawn = np.zeros((canvas.height_px, canvas.width_px), dtype=complex)
    for line in lines:
        points, directions = _samples(canvas.pixels_per_metre * line)
        there = ((points >= 0) & (points < (canvas.width_px, canvas.height_px))).all(axis=1)
        np.add.at(drawn, at_pixels(points[there], canvas.width_px, canvas.height_px), directions[there])
    directed = np.abs(drawn) > _CROSSED
    if not directed.any():
        return drawn, np.full(drawn.shape, np.inf)
    away, at = distance_transform_edt(~directed, return_indices=True)
    nearest = (drawn / np.maximum(np.abs(drawn), 1e-12))[tuple(at)]
    return gaussian_filter(nearest.real, blur) + 1j * gaussian_filter(nearest.imag, blur), away


def _samples(line: Floats) -> tuple[Floats, Complexes]:
    """Return points along a line (k, 2), pixels, without gaps, (n, 2), and exp(2i angle) of the line there, (n,)."""
    steps = np.diff(line, axis=0)
    lengths = np.hypot(*steps.T)
    counts = np.where(lengths > 0, (lengths / _STEP).astype(int) + 2, 0)
    part = np.repeat(np.arange(len(steps)), counts)
    along = np.concatenate([np.zeros(0), *(np.linspace(0, 1, count) for count in counts)])
    directions: Complexes = np.exp(2j * np.arctan2(steps[:, 1], steps[:, 0]))[part]
    return line[:-1][part] + along[:, None] * steps[part], directions
