"""From a photograph to a painting: lay the picture out on a sheet, plan it, write down the result."""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from importlib.metadata import version

import numpy as np
import torch
from numpy.typing import NDArray

from maulstick.brush.preview import preview
from maulstick.canvas import Canvas
from maulstick.errors import InputError
from maulstick.figures import Figures, compare
from maulstick.medium import Brush
from maulstick.painting import Making, Paint, Painting, Sheet, Stroke, StyleUse
from maulstick.picture import lay_out
from maulstick.plan.attention import attention
from maulstick.plan.commission import Commission, PlanOptions, Weighted
from maulstick.plan.objectives import Tone
from maulstick.plan.planner import Plan, Progress, plan
from maulstick.style import Style

Image = NDArray[np.float32]

_HEIGHT_PX = 256
_LONGEST_PX, _MOST_PX = 2048, 6144
_PAPER = (1.0, 1.0, 1.0)


@dataclass(frozen=True)
class Layout:
    """A picture on a sheet: target (H, W, 3) of the canvas' pixels, and the picture's area (x, y, width, height), m."""

    canvas: Canvas
    target: Image
    area: tuple[float, float, float, float]

    def crop(self, image: Image) -> Image:
        """The part of an image of the canvas, (H, W, 3), that the picture covers."""
        left, top, width, height = (round(x * self.canvas.pixels_per_metre) for x in self.area)
        return image[top : top + max(height, 1), left : left + max(width, 1)]


def lay_out_for(
    picture: Image, size: tuple[float, float], brush: Brush, fit: str = "contain", height_px: int | None = None
) -> Layout:
    """Lay a picture (h, w, 3) out on a sheet of `size` (width, height), metres, at the resolution to plan it in.

    height_px: of the picture on the canvas; when left out, at least 256 and as many as show the brush's thinnest mark
    with a half-width of a pixel, as long as no side of the canvas needs more than 2048.
    Raises InputError for a sheet that is too narrow or too large in pixels.
    """
    size = (round(size[0], 6), round(size[1], 6))  # as its file will say, so that the style is known again from there
    down = size[1] / picture.shape[0]
    across = size[0] / picture.shape[1]
    picture_height = picture.shape[0] * (max(down, across) if fit == "cover" else min(down, across))
    if height_px is None:
        resolution = max(_HEIGHT_PX / min(picture_height, size[1]), 1 / (brush.thinnest or brush.widest / 4))
        resolution = min(resolution, _LONGEST_PX / max(size))
    elif height_px < 1:
        raise InputError.of_range("the height of the picture", f"{height_px} pixels", "at least 1")
    else:
        resolution = height_px / min(picture_height, size[1])
        if resolution * max(size) > _MOST_PX:
            allowed = f"less, so that no side of the sheet has more than {_MOST_PX}"
            raise InputError.of_range("the height of the picture", f"{height_px} pixels", allowed)
    canvas = Canvas(size[0], size[1], resolution)
    if min(canvas.width_px, canvas.height_px) < 2:
        pixels = f"{canvas.width_px} x {canvas.height_px}"
        raise InputError.of_range("the sheet in pixels", pixels, "at least 2 x 2; choose a less narrow size")
    return Layout(canvas, *lay_out(picture, canvas, fit))


def plan_photograph(
    layout: Layout,
    brush: Brush,
    style: Style,
    options: PlanOptions,
    made: Making,
    watch: Callable[[Progress], bool] = lambda progress: True,
) -> Painting:
    """Plan the painting of a picture that is laid out."""
    planned = plan(commission_of(layout, brush, style, options), options, watch)
    return as_painting(planned, layout, brush, style, made)


def commission_of(layout: Layout, brush: Brush, style: Style, options: PlanOptions) -> Commission:
    """What a picture that is laid out asks of the planner: its tones, on white paper."""
    target = torch.from_numpy(np.ascontiguousarray(layout.target.transpose(2, 0, 1)))
    paper = torch.tensor(_PAPER)[:, None, None].expand_as(target).contiguous()
    weights = torch.ones_like(target[0])
    layout.crop(weights.numpy())[:] = attention(layout.crop(layout.target))
    tone = Weighted(Tone(target, weights, halftone=options.one_ink), 1.0)
    return Commission(target, paper, weights, layout.canvas, brush, style, (tone,))


def making(options: PlanOptions, image: str | None = None, sha256: str | None = None, **more: object) -> Making:
    """How a painting is made, for its file: all options, with `more` that the planner itself does not see."""
    return Making.model_validate(
        {
            "version": version("maulstick"),
            "image": image,
            "image_sha256": sha256,
            "seed": options.seed,
            "options": {**asdict(options), "palette": [list(colour) for colour in options.palette], **more},
        }
    )


def figures_of(painting: Painting, layout: Layout) -> Figures:
    """How near the painting, as its file orders it, comes to the picture over the picture's area."""
    return compare(layout.crop(preview(painting, layout.canvas)), layout.crop(layout.target))


def as_painting(planned: Plan, layout: Layout, brush: Brush, style: Style, made: Making) -> Painting:
    """A plan as a painting, whose file says all that planning it again needs."""
    codes = planned.strokes.codes
    poses = planned.strokes.poses(style.decode(codes))
    trajectories = planned.strokes.trajectories(style)
    trajectories[..., 2].clamp_(0, 1)
    speeds = style.speeds(codes)
    timed = [None] * len(codes) if speeds is None else speeds.tolist()
    used = torch.unique(planned.paint_of)
    paint_of = torch.searchsorted(used, planned.paint_of)
    strokes = [
        Stroke.model_validate(
            {
                "id": number,
                "paint": paint,
                "trajectory": trajectory,
                "speed": speed,
                "style": StyleUse(name=style.name, hash=style.hash, code=tuple(code), pose=tuple(pose)),
            }
        )
        for number, (paint, trajectory, speed, code, pose) in enumerate(
            zip(paint_of.tolist(), trajectories.tolist(), timed, codes.tolist(), poses.tolist(), strict=True)
        )
    ]
    paints = [Paint(colour=tuple(colour), brush=brush.name) for colour in planned.paints[used].tolist()]
    return Painting(
        canvas=Sheet(width=layout.canvas.width, height=layout.canvas.height, paper=_PAPER),
        area=layout.area,
        made=made,
        brushes={brush.name: brush},
        paints=tuple(paints),
        strokes=tuple(strokes),
    )
