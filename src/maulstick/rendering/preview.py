"""What a painting will look like: its marks, as its own brushes leave them."""

import torch
from torch import Tensor

from maulstick.painting.painting import Painting
from maulstick.painting.raster import Canvas
from maulstick.rendering.traj2stroke import Traj2Stroke, paint
from maulstick.storage.arrays import Image


def preview(painting: Painting, canvas: Canvas, strokes: int | None = None) -> Image:
    """The painting on the pixels of the canvas, (height_px, width_px, 3) sRGB in [0, 1].

    strokes: only the first so many.
    """
    sheet = torch.from_numpy(painting.sheet.image(canvas)).permute(2, 0, 1)
    shown = painting.strokes[:strokes]
    colours = [painting.paints[stroke.paint].colour for stroke in shown]
    return _painted(sheet, painting, torch.tensor(colours, dtype=torch.float32).reshape(-1, 3), canvas)


def coverage(painting: Painting, canvas: Canvas) -> Image:
    """How much of the sheet shows no more at each pixel of the canvas, (height_px, width_px) in [0, 1]."""
    bare = torch.zeros(1, canvas.height_px, canvas.width_px)
    return _painted(bare, painting, torch.ones(len(painting.strokes), 1), canvas)[..., 0]


def _painted(onto: Tensor, painting: Painting, colours: Tensor, canvas: Canvas) -> Image:
    """An image (C, H, W) after the first strokes, as many as there are colours (N, C); (H, W, C) in [0, 1]."""
    shown = painting.strokes[: len(colours)]
    brushes = Traj2Stroke.of([painting.brushes[painting.paints[stroke.paint].brush] for stroke in shown])
    trajectories = torch.tensor(painting.trajectories()[: len(shown)], dtype=torch.float32)
    with torch.no_grad():
        image = paint(onto.contiguous(), trajectories, colours, brushes, canvas.pixels_per_metre)
    return image.clamp(0, 1).permute(1, 2, 0).numpy()
