"""Sheets of the simulator: painted by libmypaint, or stamped by OpenCV where libmypaint is not installed."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import final

import numpy as np

from maulstick.errors import InputError
from maulstick.painting.brush import Brush
from maulstick.painting.raster import Canvas
from maulstick.robot.camera.opencv import opencv
from maulstick.robot.simulated.mypaint import MyPaintPaper
from maulstick.storage.arrays import Floats, Image
from maulstick.strokes.strokes import path_lengths, resample

Colour = tuple[float, float, float]

_THINNEST = 0.1e-3  # metres: least half-width that is stamped, so that light strokes are seen
_FINE = 4  # fractional bits of the places that OpenCV draws at: 1/16 of a pixel
_SLOWLY = 6.0  # radii per second: slow, since libmypaint's marks depend on speed, and those of a machine's tools do not
_STEP = 0.25  # half-widths between two stamps, so that their edge is smooth


@dataclass(frozen=True)
class _Tool:
    """Medium of libmypaint, its radius, the half-width of its widest mark, and the depth for that mark; metres."""

    medium: str
    radius: float
    widest: float
    depth: float


_TOOLS = {  # by the brush that was fitted to such a tool
    "fineliner": _Tool("marker_fat", 0.5e-3, 0.2e-3, 8e-3),
    "marker": _Tool("marker", 1.2e-3, 1.8e-3, 2e-3),
    "round": _Tool("acrylic", 3.2e-3, 7.9e-3, 8e-3),
}


class InkedSheet(ABC):
    """White sheet that takes the marks of a medium.

    canvas: size of the sheet, and pixels of `image`.  depth: metres below first touch at pressure 1.
    """

    canvas: Canvas
    depth: float

    @abstractmethod
    def draw(self, trajectory: Floats, colour: Colour) -> None:
        """Draw a trajectory (n, 3), metres and pressure in [0, 1]."""

    @abstractmethod
    def image(self) -> Image:
        """Return the sheet as it is now, (height_px, width_px, 3) sRGB in [0, 1]."""


@final
class MyPaintSheet(InkedSheet):
    """Sheet that libmypaint draws on; medium, radius: as in `mypaint.MyPaintPaper.draw`."""

    def __init__(self, canvas: Canvas, medium: str, radius: float, depth: float) -> None:
        """Make a sheet. Raises InputError where libmypaint is not installed."""
        self.canvas, self.depth, self._medium, self._radius = canvas, depth, medium, radius
        self._paper, self._speed = MyPaintPaper(canvas), max(_SLOWLY * radius, 1e-3)

    def draw(self, trajectory: Floats, colour: Colour) -> None:
        """As in `InkedSheet`."""
        self._paper.draw(trajectory, self._medium, radius=self._radius, colour=colour, speed=self._speed)

    def image(self) -> Image:
        """As in `InkedSheet`."""
        return self._paper.photograph()


@final
class StampedSheet(InkedSheet):
    """Sheet on which OpenCV stamps discs along a path; half_width: of the mark at pressure 0 and 1, metres."""

    def __init__(self, canvas: Canvas, half_width: tuple[float, float], depth: float) -> None:
        """Make a sheet. Raises InputError where OpenCV is not installed."""
        self.canvas, self.depth, self._half_width = canvas, depth, half_width
        self._cv2 = opencv()
        self._image: Image = np.ones((canvas.height_px, canvas.width_px, 3), dtype=np.float32)

    def draw(self, trajectory: Floats, colour: Colour) -> None:
        """As in `InkedSheet`."""
        step = _STEP * self._half_width[0]
        path = resample(trajectory, 1 + int(np.ceil(path_lengths(trajectory[:, :2]) / step)))
        radii = np.interp(path[:, 2], (0, 1), self._half_width) * self.canvas.pixels_per_metre
        mask = np.zeros(self._image.shape[:2], dtype=np.uint8)
        for (x, y), radius in zip(path[:, :2] * self.canvas.pixels_per_metre - 0.5, radii, strict=True):
            centre = round(x * 2**_FINE), round(y * 2**_FINE)
            size = round(radius * 2**_FINE)
            self._cv2.circle(mask, centre, size, 255, self._cv2.FILLED, self._cv2.LINE_AA, _FINE)
        share = mask[..., None].astype(np.float32) / 255
        self._image = (self._image * (1 - share) + np.array(colour) * share).astype(np.float32)

    def image(self) -> Image:
        """As in `InkedSheet`."""
        return self._image.copy()


def sheet_for(brush: Brush, canvas: Canvas) -> InkedSheet:
    """Make a sheet whose medium is a tool like the one that the brush was fitted to, not the fitted brush itself."""
    tool = _TOOLS[min(_TOOLS, key=lambda name: (name != brush.name, abs(_TOOLS[name].widest - brush.widest)))]
    depth = max(brush.depth) or tool.depth
    try:
        return MyPaintSheet(canvas, tool.medium, tool.radius, depth)
    except InputError:  # libmypaint is not installed
        return StampedSheet(canvas, (0.9 * max(brush.thinnest, _THINNEST), 0.9 * brush.widest), depth)
