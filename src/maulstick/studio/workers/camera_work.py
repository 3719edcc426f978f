"""Photographs of a camera over the sheet, and its view of the sheet by corners that a person shows."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from maulstick.painting.picture import encode_jpeg
from maulstick.robot.camera.camera import open_camera

Corners = tuple[tuple[float, float], ...]
"""Upper left, upper right, lower right and lower left corner of the sheet, shares of a photograph's sides."""

_FIRST: Corners = ((0.2, 0.2), (0.8, 0.2), (0.8, 0.8), (0.2, 0.8))  # where they lie before anybody has shown them
_LONGEST_PX = 2000  # of the photograph on the page: five times nearer, its pixels are seen


@dataclass(frozen=True)
class SeenSheet:
    """Photograph of a sheet, a JPEG for a page. size: of what the camera took, pixels.  corners: of the sheet."""

    photograph: bytes
    size: tuple[int, int]
    corners: Corners


def see_sheet(camera: str, view: Path, sheet: tuple[float, float]) -> SeenSheet:
    """Take a photograph, with the corners of a sheet (width, height), metres, by the view in that file, if it is there.

    Raises CameraError where the camera takes none, InputError where the file holds no view.
    """
    from maulstick.calibration.camera import read_view  # loads SciPy

    with open_camera(camera) as opened:
        photograph = opened.photograph()
    size = photograph.shape[1], photograph.shape[0]
    corners = _FIRST
    if view.is_file() and (known := read_view(view)).size == size:
        (x, y), sides = sheet, np.array(size)
        pixels = known.to_photo(np.array([[0, 0], [x, 0], [x, y], [0, y]]))
        corners = tuple((across, down) for across, down in ((pixels + 0.5) / sides).clip(0, 1).tolist())
    return SeenSheet(encode_jpeg(photograph, _LONGEST_PX), size, corners)


def keep_corners(view: Path, corners: Corners, sheet: tuple[float, float], size: tuple[int, int]) -> None:
    """Write the view in which a sheet has these corners, as ``maulstick calibrate camera --corners --keep`` does.

    sheet: width and height, metres.  size: of the photograph, pixels.
    Raises InputError where they are no corners of a sheet, OutputError where it cannot be written.
    """
    from maulstick.calibration.camera import view_of_corners, write_view  # load SciPy

    write_view(view_of_corners(np.array(corners) * np.array(size) - 0.5, sheet, size), view)
