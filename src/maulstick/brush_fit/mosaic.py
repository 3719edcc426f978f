"""Mosaic of all windows of a fit, so that one pass of the renderer stamps every stroke onto its own paper."""

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
"""Weight of a pixel that the new stroke covers; others have 1 (paper: Traj2Stroke Model)."""


@dataclass(frozen=True)
class Mosaic:
    """Windows side by side on one canvas, N of them.

    before, after: (C, H, W).  counts: (H, W), 1 where a pixel counts, 0 where not, between windows too.
    weights: (H, W), `counts` with more weight on covered pixels.  of: (H, W) int64, index of the window, N outside.
    trajectories: (N, n, 3) commanded, metres, at their place on the mosaic.  areas: (N,) pixels of each window.
    places: rows and columns of each window.
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
        """Arrange windows in rows; `paths` are those of the windows, resampled to n points each, (n, 3)."""
        places, height, width = _packed(*_rooms(windows, pixels_per_metre))
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
        """Return the predicted photographs (C, H, W) of strokes drawn by their brushes with ink of a colour (C,)."""
        marks = brushes.marks(self.trajectories, self.pixels_per_metre)
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
        """Weighted L1 between the photographs after the strokes and the prediction `stamped`, (C, H, W)."""
        return ((stamped - self.after).abs().mean(dim=0) * self.weights).sum() / self.areas.sum()

    def l1(self, stamped: Tensor) -> Tensor:
        """Mean absolute difference (N,) from the photograph after the stroke in each window, without specks."""
        off = (stamped - self.after).abs().mean(dim=0) * self.counts
        sums = off.new_zeros(len(self) + 1).index_add(0, self.of.reshape(-1), off.reshape(-1))
        return sums[:-1] / self.areas

    def window(self, image: Tensor, stroke: int) -> Pixels:
        """Return the part (h, w, C) of an image (C, H, W) that lies in the window of a stroke."""
        rows, columns = self.places[stroke]
        return np.asarray(image[:, rows, columns].permute(1, 2, 0).numpy())


_GAP = 8
"""Pixels between windows, because during the descent a stroke may lie outside its window."""


def _rooms(windows: Sequence[Window], pixels_per_metre: float) -> tuple[list[tuple[int, int]], Ints]:
    """Return height and width of each window, and the margins (N, 2, 2) above and below, left and right, pixels.

    The edge of a photograph cuts a window, but not the stroke that is stamped there.
    """
    shapes = [(window.covered.shape[0], window.covered.shape[1]) for window in windows]
    corners = np.array([window.corner for window in windows])
    low = np.array([window.path[:, :2].min(axis=0) for window in windows]) - corners
    high = corners + np.array(shapes)[:, ::-1] / pixels_per_metre
    high -= np.array([window.path[:, :2].max(axis=0) for window in windows])
    margins = np.stack([low, high], axis=2)[:, ::-1]
    return shapes, _GAP // 2 + np.ceil((margins.max() - margins) * pixels_per_metre).astype(int)


def _packed(shapes: Sequence[tuple[int, int]], rooms: Ints) -> tuple[list[tuple[slice, slice]], int, int]:
    """Pack images with margins in rows, the highest first, on a canvas about as high as wide.

    Returns rows and columns of each image, and the height and width of the canvas, pixels.
    """
    heights, widths = (np.array(shapes) + rooms.sum(axis=2)).T
    width = max(widths.max(), int(np.sqrt(1.1 * (heights * widths).sum())))
    places: dict[int, tuple[slice, slice]] = {}
    x = y = row_height = 0
    for i in np.argsort(-heights, kind="stable"):
        if x + widths[i] > width:
            x, y, row_height = 0, y + row_height, 0
        top, left = y + rooms[i, 0, 0], x + rooms[i, 1, 0]
        places[i] = (slice(top, top + shapes[i][0]), slice(left, left + shapes[i][1]))
        x, row_height = x + widths[i], max(row_height, heights[i])
    return [places[i] for i in range(len(shapes))], int(y + row_height), int(width)
