"""Previews of a painting: the marks of its own brushes, drawn along its refined strokes."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from statistics import fmean

import torch
from torch import Tensor
from torch.nn.functional import avg_pool2d

from maulstick.errors import InputError, option
from maulstick.painting.painting import Painting
from maulstick.painting.raster import Canvas
from maulstick.painting.refined import refined
from maulstick.rendering.kernels.render import composite
from maulstick.rendering.traj2stroke import Marks, Traj2Stroke
from maulstick.storage.arrays import Image

_LARGEST_PX = 8192  # pixels on a side: what image viewers open without trouble
_FINER = 4  # times finer pixels of the truth: with 16 times finer ones plans come within 0.05 dB of the same
_BAND_PX = 2**22  # finer pixels drawn at a time, 50 MB: a canvas of 2048 by 2048 would fill 805 MB


def preview(painting: Painting, canvas: Canvas, strokes: int | None = None) -> Image:
    """Render the painting on the pixels of the canvas, (height_px, width_px, 3) sRGB in [0, 1].

    strokes: number of strokes that are rendered, from the first; all by default.
    """
    shown = painting.model_copy(update={"strokes": painting.strokes[:strokes]})
    return _image(_painted(_bare_sheet(painting, canvas), _drawn(shown, canvas.pixels_per_metre)))


def growing(painting: Painting, canvas: Canvas, ends: Sequence[int]) -> Iterator[Image]:
    """Yield what `preview` renders of the first strokes, as many as each of `ends`, which do not fall, says.

    No stroke is rendered twice, so all images together take little longer than the last one alone.
    """
    image, begin = _bare_sheet(painting, canvas), 0
    for end in ends:
        if end > begin:
            more = painting.model_copy(update={"strokes": painting.strokes[begin:end]})
            image, begin = _painted(image, _drawn(more, canvas.pixels_per_metre)), end
        yield _image(image)


def truth(painting: Painting, canvas: Canvas, finer: int = _FINER) -> Image:
    """Return what the painting looks like where each pixel is the mean of what lies on it, as `preview` does.

    `preview` knows how much of a pixel each mark hides, but not which part of it, where several marks meet in one. Here
    strokes are painted on pixels that are so many times finer each way, and their sRGB values are averaged; the sheet
    itself stays as the canvas shows it. Bands are drawn one after another, so memory stays within a few hundred MB.
    """
    drawn = list(_drawn(painting, finer * canvas.pixels_per_metre))
    rows = max(1, _BAND_PX // (finer**2 * canvas.width_px))
    bands = []
    for number, bare in enumerate(_bare_sheet(painting, canvas).split(rows, dim=1)):
        fine = bare.repeat_interleave(finer, dim=1).repeat_interleave(finer, dim=2)
        bands.append(avg_pool2d(_painted(fine, drawn, top=number * rows * finer), finer))
    return _image(torch.cat(bands, dim=1))


def preview_of_height(painting: Painting, px: int) -> Image:
    """Return the painting as an image that is `px` pixels high, (px, W, 3) sRGB in [0, 1].

    Raises InputError where that, or its width, is out of range.
    """
    if px % 1:
        raise InputError.of_range(option("px"), px, "a whole number")
    if not 1 <= px <= _LARGEST_PX / max(1.0, painting.sheet.width / painting.sheet.height):
        raise InputError.of_range(option("px"), px, f"at least 1, with no side of the image above {_LARGEST_PX}")
    return preview(painting, Canvas.of_height((painting.sheet.width, painting.sheet.height), px))


def coverage(painting: Painting, canvas: Canvas) -> Image:
    """Share of the sheet that paint hides at each pixel of the canvas, (height_px, width_px) in [0, 1]."""
    bare = torch.zeros(1, canvas.height_px, canvas.width_px)
    white = [
        replace(each, colours=torch.ones(len(each.colours), 1)) for each in _drawn(painting, canvas.pixels_per_metre)
    ]
    return _image(_painted(bare, white))[..., 0]


def _bare_sheet(painting: Painting, canvas: Canvas) -> Tensor:
    return torch.from_numpy(painting.sheet.image(canvas)).permute(2, 0, 1)


@dataclass(frozen=True)
class _Drawn:
    """Marks of consecutive strokes, and their colours (N, C)."""

    marks: Marks
    colours: Tensor


@torch.no_grad()
def _drawn(painting: Painting, pixels_per_metre: float) -> Iterator[_Drawn]:
    """Yield the marks of all refined strokes, in painting order."""
    colours = torch.tensor([painting.paints[stroke.paint].colour for stroke in painting.strokes]).reshape(-1, 3)
    pressures = torch.tensor([fmean(p for _, _, p in stroke.trajectory) for stroke in painting.strokes])  # as given
    begin = 0
    for part in refined(painting).parts():
        rows = slice(begin, begin := begin + len(part.strokes))
        brushes = Traj2Stroke.of([part.brushes[part.paints[stroke.paint].brush] for stroke in part.strokes])
        counts = torch.tensor([len(stroke.trajectory) for stroke in part.strokes])
        trajectories = torch.tensor(part.trajectories(), dtype=torch.float32)
        marks = brushes.at_mean_pressure(pressures[rows]).marks(trajectories, pixels_per_metre)
        yield _Drawn(marks.evened(counts), colours[rows])


@torch.no_grad()
def _painted(onto: Tensor, drawn: Iterable[_Drawn], top: int = 0) -> Tensor:
    """Return an image (C, H, W) after these marks, where it begins `top` pixels below the sheet's upper edge."""
    image, down = onto.contiguous(), torch.tensor([0.0, top])
    for each in drawn:
        marks = each.marks
        shape = marks.falloff, marks.plateau, marks.opacity
        image = composite(image, marks.points - down, marks.thickness, each.colours, *shape)
    return image


def _image(channels_first: Tensor) -> Image:
    return channels_first.clamp(0, 1).permute(1, 2, 0).numpy()
