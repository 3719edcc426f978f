"""All windows of a fit on one canvas, so that a single pass of the renderer stamps every stroke onto its own paper."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
import torch
from torch import Tensor

from maulstick.brush_fit.window import Window
from maulstick.rendering.kernels.render import composite
from maulstick.rendering.traj2stroke import Traj2Stroke
from maulstick.storage.arrays import Floats, Ints, Pixels

_COVERED = 2.0
"""How much more a pixel counts that the new stroke covers (paper: Traj2Stroke Model)."""


@dataclass(frozen=True)
class Mosaic:
    """N windows side by side.

    before, after: (C, H, W).  counts: (H, W), 1 where a pixel counts, 0 where not, between windows too.
    weights: (H, W), the same with more weight on covered pixels.  of: (H, W) int64, whose window it is, N for nobody's.
    trajectories: (N, n, 3) commanded, metres, where they are on the mosaic.  areas: (N,) pixels of each window.
    """

    pixels_per_metre: float
    before: Tensor
    after: Tensor
    counts: Tensor
    weights: Tensor
    of: Tensor
    trajectories: Tensor
    areas: Tensor
    places: tuple[tuple[slice, slice], ...]

    @classmethod
    def of_windows(cls, windows: Sequence[Window], paths: Sequence[Floats], pixels_per_metre: float) -> Self:
        """The windows in rows; `paths` are theirs with equally many points each, (n, 3)."""
        places, height, width = _libraries(*_rooms(windows, pixels_per_metre))
        channels = windows[0].after.shape[2]
        before = np.zeros((height, width, channels), dtype=np.float32)
        after, counts, weights = before.copy(), before[..., 0].copy(), before[..., 0].copy()
        of = np.full((height, width), len(windows))
        moved = []
        for i, (window, path, place) in enumerate(zip(windows, paths, places, strict=True)):
            before[place], after[place], of[place] = window.before, window.after, i
            counts[place] = window.weights
            weights[place] = window.weights * np.where(window.covered, _COVERED, 1)
            here = np.array([place[1].start, place[0].start]) / pixels_per_metre - window.corner
            moved.append(path + np.append(here, 0))
        return cls(
            pixels_per_metre,
            torch.tensor(before).permute(2, 0, 1).contiguous(),
            torch.tensor(after).permute(2, 0, 1).contiguous(),
            torch.tensor(counts),
            torch.tensor(weights),
            torch.tensor(of),
            torch.tensor(np.array(moved), dtype=torch.float32),
            torch.tensor([window.covered.size for window in windows]),
            tuple(places),
        )

    def __len__(self) -> int:
        return len(self.trajectories)

    def stamped(self, brushes: Traj2Stroke, colour: Tensor) -> Tensor:
        """The photographs after, (C, H, W), if each stroke were drawn by its brush with ink of a colour (C,)."""
        marks = brushes.bare(self.trajectories, self.pixels_per_metre)
        colours = colour.expand(len(self), -1)
        return composite(
            self.before,
            marks.points,
            marks.thickness,
            colours,
            marks.falloff,
            marks.plateau,
            marks.opacity.clamp(1e-4, 1),
        )

    def loss(self, stamped: Tensor) -> Tensor:
        """The weighted L1 between the photographs after and what was `stamped`, (C, H, W)."""
        return ((stamped - self.after).abs().mean(dim=0) * self.weights).sum() / self.areas.sum()

    def l1(self, stamped: Tensor) -> Tensor:
        """The mean absolute difference from the photograph after in each window, specks apart, (N,)."""
        off = (stamped - self.after).abs().mean(dim=0) * self.counts
        sums = off.new_zeros(len(self) + 1).index_add(0, self.of.reshape(-1), off.reshape(-1))
        return sums[:-1] / self.areas

    def window(self, image: Tensor, stroke: int) -> Pixels:
        """(h, w, C): what of an image (C, H, W) lies in the window of a stroke."""
        rows, columns = self.places[stroke]
        return np.asarray(image[:, rows, columns].permute(1, 2, 0).numpy())


_GAP = 8
"""Pixels between windows: a stroke may lie further beside its place than where it was seen."""


def _rooms(windows: Sequence[Window], pixels_per_metre: float) -> tuple[list[tuple[int, int]], Ints]:
    """Height and width of each window, and pixels (N, 2, 2) above and below, left and right of it.

    The edge of a photograph cuts a window short, but not the stroke that is stamped there.
    """
    shapes = [(window.covered.shape[0], window.covered.shape[1]) for window in windows]
    corners = np.array([window.corner for window in windows])
    low = np.array([window.path[:, :2].min(axis=0) for window in windows]) - corners
    high = corners + np.array(shapes)[:, ::-1] / pixels_per_metre
    high -= np.array([window.path[:, :2].max(axis=0) for window in windows])
    margins = np.stack([low, high], axis=2)[:, ::-1]
    return shapes, _GAP // 2 + np.ceil((margins.max() - margins) * pixels_per_metre).astype(int)


def _libraries(shapes: Sequence[tuple[int, int]], rooms: Ints) -> tuple[list[tuple[slice, slice]], int, int]:
    """Where each image goes, the highest first, on a canvas about as high as wide; and its height and width."""
    heights, widths = (np.array(shapes) + rooms.sum(axis=2)).T
    width = max(widths.max(), int(np.sqrt(1.1 * (heights * widths).sum())))
    places: dict[int, tuple[slice, slice]] = {}
    x = y = library = 0
    for i in np.argsort(-heights, kind="stable"):
        if x + widths[i] > width:
            x, y, library = 0, y + library, 0
        top, left = y + rooms[i, 0, 0], x + rooms[i, 1, 0]
        places[i] = (slice(top, top + shapes[i][0]), slice(left, left + shapes[i][1]))
        x, library = x + widths[i], max(library, heights[i])
    return [places[i] for i in range(len(shapes))], int(y + library), int(width)
