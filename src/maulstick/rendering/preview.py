"""Previews of a painting: the marks of its own brushes."""

import torch
from torch import Tensor

from maulstick.errors import InputError, option
from maulstick.painting.painting import Painting
from maulstick.painting.raster import Canvas
from maulstick.rendering.traj2stroke import Traj2Stroke, paint
from maulstick.storage.arrays import Image

_LARGEST_PX = 8192  # pixels on a side: what image viewers open without trouble


def preview(painting: Painting, canvas: Canvas, strokes: int | None = None) -> Image:
    """Render the painting on the pixels of the canvas, (height_px, width_px, 3) sRGB in [0, 1].

    strokes: number of strokes that are rendered, from the first; all by default.
    """
    sheet = torch.from_numpy(painting.sheet.image(canvas)).permute(2, 0, 1)
    shown = painting.model_copy(update={"strokes": painting.strokes[:strokes]})
    colours = [painting.paints[stroke.paint].colour for stroke in shown.strokes]
    return _painted(sheet, shown, torch.tensor(colours, dtype=torch.float32).reshape(-1, 3), canvas)


def preview_of_height(painting: Painting, px: int) -> Image:
    """Return the painting as an image that is `px` pixels high, (px, W, 3) sRGB in [0, 1].

    Raises InputError where that, or its width, is out of range.
    """
    longest = px * max(1.0, painting.sheet.width / painting.sheet.height)
    if not 1 <= px <= longest <= _LARGEST_PX:
        raise InputError.of_range(option("px"), px, f"at least 1, with no side of the image above {_LARGEST_PX}")
    return preview(painting, Canvas.of_height((painting.sheet.width, painting.sheet.height), px))


def coverage(painting: Painting, canvas: Canvas) -> Image:
    """Share of the sheet that paint hides at each pixel of the canvas, (height_px, width_px) in [0, 1]."""
    bare = torch.zeros(1, canvas.height_px, canvas.width_px)
    return _painted(bare, painting, torch.ones(len(painting.strokes), 1), canvas)[..., 0]


def _painted(onto: Tensor, painting: Painting, colours: Tensor, canvas: Canvas) -> Image:
    """Return an image (C, H, W) after all strokes in the colours (N, C), as (H, W, C) in [0, 1]."""
    image = onto.contiguous()
    for part in painting.parts():
        brushes = Traj2Stroke.of([part.brushes[part.paints[stroke.paint].brush] for stroke in part.strokes])
        trajectories = torch.tensor(part.trajectories(), dtype=torch.float32)
        own, colours = colours.tensor_split([len(part.strokes)])
        with torch.no_grad():
            image = paint(image, trajectories, own, brushes, canvas.pixels_per_metre)
    return image.clamp(0, 1).permute(1, 2, 0).numpy()
