"""Tools that the planner has never seen, on a simulated easel, and what is learned of them from photographs.

A tool is a medium of libmypaint, of another size than any built-in brush, that lands beside its place and scatters.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from media import RADIUS

from maulstick.brush_fit.fit import fit_brush
from maulstick.calibration.camera import locate
from maulstick.calibration.chart import CHART, with_chart
from maulstick.calibration.collect import collect, trials_of
from maulstick.calibration.colour import Colours, Whites, lamp_of, whites_of
from maulstick.calibration.eye import Eye
from maulstick.jobs.practice import practice, room_around
from maulstick.painting.brush import Brush, load_brush
from maulstick.painting.painting import Painting, Sheet
from maulstick.painting.painting_file import write_painting
from maulstick.painting.raster import Canvas
from maulstick.robot.camera.tag_frame import TagFrame
from maulstick.robot.journal import Journal, journal_of
from maulstick.robot.routine import Prompt
from maulstick.robot.simulated.camera import SimulatedCamera
from maulstick.robot.simulated.easel import SimulatedEasel
from maulstick.robot.simulated.sheets import MyPaintSheet
from maulstick.robot.workplace import Workplace
from maulstick.storage.arrays import Image
from maulstick.style import Style

NOMINAL = "marker"
"""The built-in brush that is nearest in width to all tools."""

_ROOM, _LEARNED = 0.3, 60  # metres: side of the sheet of strokes to learn from; and their number
_INK, _FLAT = 4000.0, 4000.0  # pixels per metre of the sheet and of photographs that are made flat: about a webcam's
_PATCH = 0.03  # metres: side of a patch of the chart


@dataclass(frozen=True)
class Tool:
    """What the easel holds: a medium of `media.RADIUS`.

    depth: of pressure 1, metres.  offset, scatter: of where strokes land, metres; one sigma.
    """

    medium: str
    depth: float
    offset: tuple[float, float]
    scatter: float

    @property
    def nominal(self) -> Brush:
        """What is known of it before it is calibrated: about as wide as a built-in brush, and its depth."""
        return load_brush(NOMINAL).model_copy(update={"depth": (0.0, self.depth)})

    def calibrated(self, style: Style, seed: int) -> Brush:
        """The brush, from one sheet of strokes and a photograph before and after."""
        sheet = practice(style, self.nominal, Sheet(width=_ROOM, height=_ROOM), _LEARNED, seed=seed)
        easel = ToolEasel(self, _ROOM, seed)
        depth = (0.0, self.depth)
        with easel.at_work(sheet) as workplace, TemporaryDirectory() as folder:
            photographs = collect(sheet, workplace, easel.photograph, Path(folder), each=False)
            room = room_around(self.nominal)
            trials = trials_of(
                sheet,
                photographs,
                Path(folder) / "trials",
                pixels_per_metre=_FLAT,
                medium=self.medium,
                depth=depth,
                room=room,
            )
            return fit_brush(trials, trials.pixels_per_metre, self.medium, source=self.medium, depth=depth).brush


TOOLS = {
    tool.medium: tool
    for tool in (
        Tool("acrylic", 8e-3, (-0.4e-3, -0.6e-3), 0.2e-3),
        Tool("brush", 8e-3, (-0.5e-3, 0.7e-3), 0.2e-3),
        Tool("marker", 2e-3, (0.5e-3, 0.5e-3), 0.15e-3),
        Tool("marker_fat", 2e-3, (0.6e-3, -0.4e-3), 0.15e-3),
    )
}


class ToolEasel:
    """A new sheet before the machine, and over it a camera whose colours are known from a chart.

    side: of the sheet, metres.  seed: of where strokes land, and of the camera's pose and noise.
    """

    def __init__(self, tool: Tool, side: float, seed: int) -> None:
        canvas, tags = Canvas(side, side, _INK), TagFrame(side, side)
        rng = np.random.default_rng(seed)
        self.sheet = MyPaintSheet(canvas, tool.medium, RADIUS[tool.medium], tool.depth)
        self.robot = SimulatedEasel(self.sheet, offset=tool.offset, scatter=tool.scatter, rng=rng)
        self.told = self.robot.easel(side, side)
        camera = SimulatedCamera(self.sheet.image, canvas, rng)
        self._eye = Eye.opened(camera, Canvas(side, side, _FLAT), tags, chart=_colours())

    def photograph(self) -> Image:
        """The flat sheet, as finely as it is seen."""
        return self._eye.look().image

    @contextmanager
    def at_work(self, painting: Painting) -> Iterator[Workplace]:
        """The machine, painting that, with somebody who changes its pens."""

        def ask(action: Prompt) -> None:
            self.robot.hold(painting.paints[action.paint].colour)

        with TemporaryDirectory() as folder:
            path = Path(folder) / "painting.json"
            write_painting(painting, path)
            with self.robot, Journal.open(journal_of(path)) as journal:
                journal.revise(path)
                yield Workplace(self.robot, self.told, journal, ask)

    def paint(self, painting: Painting) -> Image:
        """Paint it on the sheet as it is; the photograph."""
        with self.at_work(painting) as workplace:
            workplace.do(workplace.left_of(painting))
        return self.photograph()


@cache
def _colours() -> Colours:
    """What the camera makes of colours, measured on a chart as `maulstick calibrate colours` does."""
    canvas, tags = Canvas(_ROOM, _ROOM, 20 / _PATCH), TagFrame(_ROOM, _ROOM)
    bare = np.ones((canvas.height_px, canvas.width_px, 3), dtype=np.float32)
    chart = bare.copy()
    chart[60:140, 40:160] = CHART.reshape(4, 6, 3).repeat(20, axis=0).repeat(20, axis=1)
    corners = np.array([(50, 70), (150, 70), (150, 130), (50, 130)]) / canvas.pixels_per_metre
    sheets = [bare]
    camera = SimulatedCamera(lambda: sheets[-1], canvas, np.random.default_rng(0), tags=tags)

    def seen() -> tuple[Image, Whites]:
        photograph = camera.photograph()
        view = locate(photograph, tags)
        return view.rectify(photograph, canvas), whites_of(photograph, view, tags)

    lamp = lamp_of(*seen())
    sheets.append(chart)
    return with_chart(lamp, *seen(), canvas, corners)[0]
