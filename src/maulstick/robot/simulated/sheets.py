"""Sheets that take ink, for the simulator: painted by libmypaint, or where that is missing, by the brush model."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from maulstick.errors import InputError
from maulstick.painting.brush import Brush
from maulstick.painting.raster import Canvas
from maulstick.rendering.kernels import _cpu
from maulstick.robot.simulated.mypaint import MyPaintPaper
from maulstick.storage.arrays import Floats, Image

Colour = tuple[float, float, float]

_DEPTH = 2e-3  # metres: of pressure 1, for a brush that does not say
_SLOWLY = 6.0  # radii per second: slow, since libmypaint's marks depend on speed, and those of a machine do not


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
    "wash": _Tool("marker", 8.5e-3, 9.4e-3, 5e-3),
}


class InkedSheet(ABC):
    """Sheet that takes the marks of a tool: white until another is laid.

    canvas: size of the sheet, and pixels of `image`.  depth: of the tool, metres below first touch at pressure 1.
    deepest: of all tools that it was made for.
    """

    canvas: Canvas
    depth: float
    deepest: float

    @abstractmethod
    def take(self, brush: Brush) -> None:
        """Draw from now on with a tool like the one that the brush was fitted to."""

    @abstractmethod
    def lay(self, picture: Image) -> None:
        """Put a picture (height_px, width_px, 3), sRGB in [0, 1], on the sheet, in place of what is there."""

    @abstractmethod
    def draw(self, trajectory: Floats, colour: Colour) -> None:
        """Draw a trajectory (n, 3), metres and pressure in [0, 1]."""

    @abstractmethod
    def image(self) -> Image:
        """Return the sheet as it is now, (height_px, width_px, 3) sRGB in [0, 1]."""


@final
class MyPaintSheet(InkedSheet):
    """Sheet that libmypaint draws on; medium, radius: of the tool, as in `mypaint.MyPaintPaper.draw`."""

    def __init__(self, canvas: Canvas, medium: str, radius: float, depth: float) -> None:
        """Make a sheet. Raises InputError where libmypaint is not installed."""
        self.canvas, self.depth, self.deepest, self._paper = canvas, depth, depth, MyPaintPaper(canvas)
        self._medium, self._radius = medium, radius

    def take(self, brush: Brush) -> None:
        """As in `InkedSheet`."""
        tool = _tool_like(brush)
        self._medium, self._radius, self.depth = tool.medium, tool.radius, tool.depth

    def lay(self, picture: Image) -> None:
        """As in `InkedSheet`."""
        self._paper.lay(picture)

    def draw(self, trajectory: Floats, colour: Colour) -> None:
        """As in `InkedSheet`."""
        speed = max(_SLOWLY * self._radius, 1e-3)
        self._paper.draw(trajectory, self._medium, radius=self._radius, colour=colour, speed=speed)

    def image(self) -> Image:
        """As in `InkedSheet`."""
        return self._paper.photograph()


@final
class ModelSheet(InkedSheet):
    """A sheet that takes ink as the brush model says; for a computer without libmypaint."""

    def __init__(self, canvas: Canvas, brush: Brush) -> None:
        self.canvas = canvas
        self._image = np.ones((3, canvas.height_px, canvas.width_px), dtype=np.float32)
        self.take(brush)
        self.deepest = self.depth

    def take(self, brush: Brush) -> None:
        """As in `InkedSheet`, but with the brush itself."""
        self.depth, self._brush = max(brush.depth) or _DEPTH, brush

    def lay(self, picture: Image) -> None:
        """As in `InkedSheet`."""
        self._image[:] = picture.transpose(2, 0, 1)

    def draw(self, trajectory: Floats, colour: Colour) -> None:
        """As in `InkedSheet`."""
        points, half_width, opacity = self._brush.bare_mark(trajectory)
        points, half_width = points * self.canvas.pixels_per_metre, half_width * self.canvas.pixels_per_metre
        reach = max(float(half_width.max()), 0.0) + 1
        size = (self.canvas.width_px, self.canvas.height_px)
        left, top = np.floor(points.min(axis=0) - reach).clip(0, size).astype(int)
        right, bottom = np.ceil(points.max(axis=0) + reach).clip(0, size).astype(int)
        if left == right or top == bottom:
            return
        window = self._image[:, top:bottom, left:right]
        painted = np.empty(window.shape, dtype=np.float32)
        stroke = ([points - (left, top)], [half_width], [colour])
        numbers = ([self._brush.falloff], [self._brush.plateau], [opacity])
        arrays = (np.ascontiguousarray(each, dtype=np.float32) for each in (window, *stroke, *numbers))
        _cpu.composite(_cpu.instruction_sets()[0], 1, *arrays, painted)
        window[:] = painted

    def image(self) -> Image:
        """As in `InkedSheet`."""
        return np.ascontiguousarray(self._image.transpose(1, 2, 0)).clip(0, 1)


def sheet_for(brushes: Sequence[Brush], canvas: Canvas) -> InkedSheet:
    """Make a sheet for tools like those that the brushes were fitted to, and take up the first."""
    first = _tool_like(brushes[0])
    sheet: InkedSheet
    try:
        sheet = MyPaintSheet(canvas, first.medium, first.radius, first.depth)
    except InputError:  # libmypaint is not installed
        sheet = ModelSheet(canvas, brushes[0])
    for brush in (*brushes[1:], brushes[0]):
        sheet.take(brush)
        sheet.deepest = max(sheet.deepest, sheet.depth)
    return sheet


def _tool_like(brush: Brush) -> _Tool:
    """Return the tool of that name, else the one that is about as broad, as deep as the brush says."""
    tool = _TOOLS[min(_TOOLS, key=lambda name: (name != brush.name, abs(_TOOLS[name].widest - brush.widest)))]
    return replace(tool, depth=max(brush.depth) or tool.depth)
