"""A camera over a sheet: flat images of the canvas in true colours, even after camera or sheet have moved."""

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
"""Kind of the file of an eye."""

_STILL = 0.5e-3  # metres: a smaller shift may be an error of the photograph, and counts as none
_FAR = 0.05  # metres: a larger shift is no accident that painting could follow


@dataclass(frozen=True)
class Observation:
    """Observation of the sheet in one photograph.

    image: (canvas.height_px, canvas.width_px, 3) sRGB in [0, 1], the sheet.  shift: of the sheet since the first
    photograph, or None while it has not moved.  notes: sentences for people.
    """

    image: Image
    shift: Shift | None
    notes: tuple[str, ...]

    def easel(self, first: Easel, canvas: Canvas) -> Easel:
        """Return the easel of the sheet where it lies now, given the easel at first."""
        if self.shift is None:
            return first
        corner = _over(self.shift, canvas)[:2, 2]
        return first.shifted(float(corner[0]), float(corner[1]), self.shift.dtheta)


@final
class Eye:
    """Camera that looks at a sheet, and knows its tags, its colours and its first photograph.

    canvas: of the images.  tags: frame of tags beside the sheet.  view: of a camera that does not move, instead of
    tags.  colours: correction of light and camera.  start: the first photograph, flat and with a margin, with which
    later ones are compared; where edges cannot be seen, they are compared with the one before.
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
        """Return an eye that has looked at the bare sheet, whose colour is `paper`; chart: colours of this camera.

        Raises InputError where tags, view or light do not allow that, MachineError where the camera fails.
        """
        if view is not None:  # it may have been found with a smaller sheet
            view.check_sees(canvas.width, canvas.height)
        photo = camera.photograph()
        seen = view or locate(photo, tags)
        wide = seen.rectify(photo, canvas, MARGIN)
        colours = lamp_of(_sheet(wide, canvas), whites_of(photo, seen, tags), paper)
        if chart is not None:
            colours = colours.with_matrix(np.array(chart.matrix))
        return cls(camera, canvas, tags, colours, wide, view)

    def look(self) -> Observation:
        """Take a photograph, and return what it shows.

        Raises MachineError where the camera fails or takes a photograph of another size, tags are hidden, the light has
        grown too bright, or the sheet has gone too far.
        """
        photo = self.camera.photograph()
        try:
            view = self._view or locate(photo, self.tags)
            wide = view.rectify(photo, self.canvas, MARGIN)
        except InputError as error:
            raise MachineError(f"{error}, and go on") from error
        shift = shift_between(self._start, wide, self.canvas) or shift_between(self._before, wide, self.canvas)
        hidden = view.hidden if self._view is None else ()
        notes = [f"tag {tag} is hidden; the other three do" for tag in hidden]
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
        try:
            image = self._colours.correct(_sheet(wide, self.canvas), whites_of(photo, view, self.tags))
        except InputError as error:
            raise MachineError(f"{error}, and go on") from error
        self._before = wide
        return Observation(image, shift, tuple(notes))

    def write(self, path: Path) -> None:
        """Write the first photograph and the colours, for `opened_again`. Raises OutputError where that fails."""
        start = (255 * self._start).round().astype(np.uint8)
        write_arrays(path, KIND, {"colours": np.array(self._colours.model_dump_json()), "start": start})

    @classmethod
    def opened_again(
        cls, camera: Camera, canvas: Canvas, tags: TagFrame, path: Path, view: CameraView | None = None
    ) -> Self:
        """Read the eye that was written to `path`. Raises InputError where there is none."""
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
    """Return the sheet alone from a flat photograph with a margin."""
    around = margin_px(canvas, MARGIN)
    return wide[around : around + canvas.height_px, around : around + canvas.width_px]


def _over(shift: Shift, canvas: Canvas) -> Floats:
    """Return the map (3, 3), homogeneous, from places on the moved sheet to the canvas frame of the sheet at first."""
    middle = np.array([canvas.width, canvas.height]) / 2
    cos, sin = np.cos(shift.dtheta), np.sin(shift.dtheta)
    there = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
    there[:2, 2] = np.add(middle, (shift.dx, shift.dy)) - there[:2, :2] @ middle
    return there


def _moved(view: CameraView, shift: Shift, canvas: Canvas) -> CameraView:
    """Return the view of a sheet that has moved by `shift`."""
    homography = np.array(view.homography) @ _over(shift, canvas)
    return CameraView.model_validate({**view.model_dump(), "homography": homography.tolist()})
