"""A camera over a sheet: flat images of the canvas in true colours, wherever camera and sheet have gone meanwhile."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final, Self, final

import numpy as np
from pydantic import ValidationError

from maulstick.calibration.camera import CameraView, locate, margin_px
from maulstick.calibration.colour import Colours, lamp_of, whites_of
from maulstick.calibration.drift import MARGIN, Shift, sheet_place, shift_between
from maulstick.errors import InputError, MachineError, validation_fault
from maulstick.painting.raster import Canvas
from maulstick.robot.camera.camera import Camera
from maulstick.robot.camera.tag_frame import TagFrame
from maulstick.robot.easel import Easel
from maulstick.storage.arrays import Floats, Image, read_arrays, write_arrays

KIND: Final = "eye"
_STILL = 0.5e-3  # metres: what a photograph may be wrong by
_FAR = 0.05  # metres: no nudge any more


@dataclass(frozen=True)
class Observation:
    """What was seen.

    image: (canvas.height_px, canvas.width_px, 3) sRGB in [0, 1], the sheet.  shift: how far it lies from where it was
    at first, or None while it is still there.  notes: for people.
    """

    image: Image
    shift: Shift | None
    notes: tuple[str, ...]

    def easel(self, first: Easel, canvas: Canvas) -> Easel:
        """Where the sheet lies now, if it lay so at first."""
        if self.shift is None:
            return first
        corner = _over(self.shift, canvas)[:2, 2]
        return first.shifted(float(corner[0]), float(corner[1]), self.shift.dtheta)


@final
class Eye:
    """Looks at a sheet through a camera.

    canvas: of the images.  tags: beside the sheet.  view: of a camera that does not move, in their stead.
    colours: of the light.  start: the first photograph, flat and with a margin, which later ones are compared with;
    where edges cannot be seen, the one before, as if it had lain there.
    """

    def __init__(
        self, camera: Camera, canvas: Canvas, tags: TagFrame, colours: Colours, start: Image, view: CameraView | None
    ) -> None:
        self.camera, self.canvas, self.tags, self._view = camera, canvas, tags, view
        self._colours, self._start, self._before = colours, start, start
        self._had_edges = sheet_place(start, canvas) is not None

    @classmethod
    def opened(
        cls,
        camera: Camera,
        canvas: Canvas,
        tags: TagFrame,
        paper: tuple[float, float, float] = (1.0, 1.0, 1.0),
        chart: Colours | None = None,
        view: CameraView | None = None,
    ) -> Self:
        """An eye that has looked at the bare sheet, whose colour is `paper`; chart: what is known of this camera.

        Raises InputError where tags or light do not let it see, MachineError where the camera fails.
        """
        photo = camera.photograph()
        seen = view or locate(photo, tags)
        wide = seen.rectify(photo, canvas, MARGIN)
        colours = lamp_of(_sheet(wide, canvas), whites_of(photo, seen, tags), paper)
        if chart is not None:
            colours = colours.with_matrix(np.array(chart.matrix))
        return cls(camera, canvas, tags, colours, wide, view)

    def look(self) -> Observation:
        """Take a photograph.

        Raises MachineError where the camera fails, tags are hidden, or the sheet is no longer where it can be.
        """
        photo = self.camera.photograph()
        try:
            view = self._view or locate(photo, self.tags)
        except InputError as error:
            raise MachineError(f"{error}, and go on") from error
        wide = view.rectify(photo, self.canvas, MARGIN)
        shift = shift_between(self._start, wide, self.canvas) or shift_between(self._before, wide, self.canvas)
        notes = [f"tag {tag} is hidden; the other three do" for tag in view.hidden]
        if shift is None and self._had_edges:
            raise MachineError("the sheet is not seen where it lay; put it back, or take away what hides it, and go on")
        if shift is None:
            notes.append("neither the edges of the sheet nor anything on it can be seen, so it is taken to lie still")
        elif (far := shift.furthest(self.canvas)) > _FAR:
            raise MachineError(f"the sheet has moved by {1e3 * far:.0f} mm; put it back, and go on")
        elif far > _STILL:
            notes.append(f"the sheet has moved by {1e3 * far:.1f} mm; painting goes on where it lies now")
        else:
            shift = None
        if shift is not None:
            wide = _moved(view, shift, self.canvas).rectify(photo, self.canvas, MARGIN)
        self._before, flat = wide, _sheet(wide, self.canvas)
        return Observation(self._colours.correct(flat, whites_of(photo, view, self.tags)), shift, tuple(notes))

    def write(self, path: Path) -> None:
        """Write what was seen at first, for `opened_again`. Raises OutputError where that fails."""
        start = (255 * self._start).round().astype(np.uint8)
        write_arrays(path, KIND, {"colours": np.array(self._colours.model_dump_json()), "start": start})

    @classmethod
    def opened_again(
        cls, camera: Camera, canvas: Canvas, tags: TagFrame, path: Path, view: CameraView | None = None
    ) -> Self:
        """The eye that was written to `path`. Raises InputError where there is none."""
        arrays = read_arrays(path, KIND, ("colours", "start"))
        around = 2 * margin_px(canvas, MARGIN)
        if arrays["start"].shape != (canvas.height_px + around, canvas.width_px + around, 3):
            raise InputError(f"{path} is of a sheet of another size; begin again on a bare one")
        try:
            colours = Colours.model_validate_json(str(arrays["colours"]))
        except ValidationError as error:
            raise InputError(f"{path} is damaged: {validation_fault(error)}; begin again on a bare sheet") from error
        return cls(camera, canvas, tags, colours, arrays["start"].astype(np.float32) / np.float32(255), view)


def _sheet(wide: Image, canvas: Canvas) -> Image:
    """The sheet alone in a flat photograph with a margin."""
    around = margin_px(canvas, MARGIN)
    return wide[around : around + canvas.height_px, around : around + canvas.width_px]


def _over(shift: Shift, canvas: Canvas) -> Floats:
    """(3, 3) from places on the sheet to where they were when it had not moved, homogeneous."""
    middle = np.array([canvas.width, canvas.height]) / 2
    cos, sin = np.cos(shift.dtheta), np.sin(shift.dtheta)
    there = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
    there[:2, 2] = np.add(middle, (shift.dx, shift.dy)) - there[:2, :2] @ middle
    return there


def _moved(view: CameraView, shift: Shift, canvas: Canvas) -> CameraView:
    homography = np.array(view.homography) @ _over(shift, canvas)
    return CameraView.model_validate({**view.model_dump(), "homography": homography.tolist()})
