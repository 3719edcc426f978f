"""What a painting will look like: its marks, as its own brushes leave them."""

import numpy as np
import torch
from numpy.typing import NDArray

from maulstick.brush.traj2stroke import Traj2Stroke, paint
from maulstick.canvas import Canvas
from maulstick.painting import Painting


def preview(painting: Painting, canvas: Canvas, strokes: int | None = None) -> NDArray[np.float32]:
    """The painting on the pixels of the canvas, (height_px, width_px, 3) sRGB in [0, 1].

    strokes: only the first so many.
    """
    shown = painting.strokes[:strokes]
    paper = torch.tensor(painting.canvas.paper)[:, None, None].expand(3, canvas.height_px, canvas.width_px)
    paints = [painting.paints[stroke.paint] for stroke in shown]
    brushes = Traj2Stroke.of([painting.brushes[p.brush] for p in paints])
    colours = torch.tensor([p.colour for p in paints], dtype=torch.float32).reshape(-1, 3)
    trajectories = torch.tensor(painting.trajectories()[: len(shown)], dtype=torch.float32)
    with torch.no_grad():
        image = paint(paper, trajectories, colours, brushes, canvas.pixels_per_metre)
    return image.clamp(0, 1).permute(1, 2, 0).numpy()
