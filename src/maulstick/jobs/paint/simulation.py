"""Simulation: the simulated easel as ``maulstick paint`` uses it, with paints at hand and a camera."""

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from maulstick.errors import InputError
from maulstick.painting.painting import Painting
from maulstick.painting.picture import encode_png
from maulstick.painting.raster import Canvas
from maulstick.robot.camera.tag_frame import TagFrame
from maulstick.robot.easel import Easel
from maulstick.robot.machines import SPECS
from maulstick.robot.routine import Draw, Prompt, routine
from maulstick.robot.simulated.camera import SimulatedCamera
from maulstick.robot.simulated.easel import ARM, WEIGHTLESS, SimulatedEasel
from maulstick.robot.simulated.sheets import MyPaintSheet, sheet_for
from maulstick.robot.tray import Tray
from maulstick.storage.files import atomic_write

_FINE = 6000  # pixels per metre of the simulated sheet: two across the thinnest line, that of a fineliner
_MOST_PX = 2048  # longest side of the simulated sheet, which bounds memory and time
_ASKS = "sim:pens"
_PACES = {"sim": (float("inf"), WEIGHTLESS), _ASKS: (float("inf"), ARM), "sim:real": (1.0, ARM)}
"""Pace, in times of real time, and limits of each simulated machine."""


@dataclass(frozen=True)
class Simulation:
    """A simulated easel for a painting, and the painting.

    asks: whether it asks the operator for each pen, as a machine without a tray does; else it changes them by itself.
    """

    robot: SimulatedEasel
    painting: Painting
    asks: bool

    @classmethod
    def of(cls, spec: str, painting: Painting, easel: Easel | None, tray: Tray | None) -> "Simulation":
        """Return the machine that the spec names.

        ``sim``; ``sim:pens`` with an arm's limits, which asks for its pens; ``sim:real`` with those, in real time.
        The sheet lies where the easel says, and the easel may narrow the limits.
        """
        if spec not in _PACES:
            raise InputError(f"there is no machine {spec!r}; there are: {SPECS}")
        pace, limits = _PACES[spec]
        size = painting.sheet.width, painting.sheet.height
        canvas = Canvas(*size, min(_FINE, _MOST_PX / max(size)))
        wells = [] if tray is None else zip(tray.wells_of(painting), painting.paints, strict=True)
        sheet = sheet_for(tuple(painting.brushes.values()), canvas)
        sheet.lay(painting.sheet.image(canvas))
        robot = SimulatedEasel(
            sheet,
            easel,
            wells=[(well.x, well.y, paint.colour) for well, paint in wells],
            pace=pace,
            limits=limits if easel is None or easel.limits is None else limits.narrowed(easel.limits),
        )
        simulation = cls(robot, painting, spec == _ASKS)
        simulation._take(0)
        return simulation

    @property
    def note(self) -> str | None:
        """Sentence that says what is simplified; None where libmypaint draws."""
        if isinstance(self.robot.sheet, MyPaintSheet):
            return None
        return (
            "libmypaint is not installed, so the sheet takes our own brush model's ink; on Debian: "
            "apt-get install libmypaint-1.5-1 mypaint-brushes"
        )

    def ask(self, action: Prompt) -> None:
        """Change or refill the pen as prompted."""
        self._take(action.paint)

    def camera(self, tags: TagFrame) -> SimulatedCamera:
        """Return a simulated camera over the sheet."""
        sheet = self.robot.sheet
        return SimulatedCamera(sheet.image, sheet.canvas, np.random.default_rng(0), tags=tags)

    def paint_again(self, easel: Easel, done: Collection[int]) -> None:
        """Paint the strokes that are done onto the new sheet, as an earlier run left them."""
        others = [stroke.id for stroke in self.painting.strokes if stroke.id not in done]
        limits = self.robot.limits
        for action in routine(self.painting, easel, limits, speed=limits.speed, done=others):
            if isinstance(action, Draw):
                self._take(action.paint)
                self.robot.mark(action.motion.path)
        self._take(0)

    def write_photograph(self, painting: Path) -> Path:
        """Write a picture of the sheet beside the painting, and return its path."""
        path = painting.with_name(f"{painting.stem}-painted.png")
        atomic_write(path, encode_png(self.robot.sheet.image()))
        return path

    def _take(self, paint: int) -> None:
        """Take up the brush and the colour of a paint."""
        wanted = self.painting.paints[paint]
        self.robot.hold(wanted.colour)
        self.robot.sheet.take(self.painting.brushes[wanted.brush])
