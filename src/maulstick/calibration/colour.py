"""The colours of a photograph: an even light, one exposure for all photographs, and true colours from a chart."""

from collections.abc import Mapping
from math import ceil
from pathlib import Path
from typing import Annotated, Final, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from maulstick.calibration.camera import CameraView
from maulstick.calibration.tags import sampled
from maulstick.colour.srgb import colours_of, light_of
from maulstick.errors import InputError
from maulstick.robot.camera.tag_frame import TagFrame
from maulstick.storage.arrays import Floats, Image
from maulstick.storage.records import read_record, write_record

Whites = Mapping[int, Floats]
"""The light (3,) off the white around each tag that is seen."""

SCHEMA_VERSION: Final = 1
_DEGREE = 3
_TERMS = [(i, j) for i in range(_DEGREE + 1) for j in range(_DEGREE + 1 - i)]
_SAMPLES = 200  # across a sheet, to fit its light
_RIM = 0.02  # of the sheet, where the bed may shine through
_OUTLIER = 4.0  # times the usual deviation
_UNEVEN = 0.04  # of the light that is left: there is something on the sheet
_WHITEST, _CLIPPED = 0.995, 0.01
_DARKEST = 1e-3  # light
_RING = 16  # samples along each side of a tag
_Row = tuple[float, float, float]
_Share = Annotated[float, Field(ge=0, le=1)]
_UNCHANGED: Final = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class Colours(BaseModel):
    """How the lamp and the camera change colours, and what they were.

    lamp: of a cubic in x and y, -1 to 1 across the sheet: the logarithm of the light off bare paper in each channel.
    whites: the light around the tags at that moment.  paper: the sheet's colour, sRGB.
    matrix: (3, 3), from light under an even lamp to true light.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    schema_version: Literal[1] = SCHEMA_VERSION
    lamp: Annotated[tuple[_Row, ...], Field(min_length=len(_TERMS), max_length=len(_TERMS))]
    whites: dict[int, _Row]
    paper: tuple[_Share, _Share, _Share] = (1.0, 1.0, 1.0)
    matrix: tuple[_Row, _Row, _Row] = _UNCHANGED

    def with_matrix(self, matrix: Floats) -> Self:
        """The same with another matrix (3, 3)."""
        return self.model_copy(update={"matrix": tuple(tuple(row) for row in matrix.tolist())})

    def correct(self, flat: Image, whites: Whites) -> Image:
        """A flat photograph of the whole sheet (H, W, 3), sRGB in [0, 1], in true colours.

        whites: of the same photograph.  Those that are known of both tell what the exposure did; none, that it stayed.
        """
        return colours_of(self.evened(flat, whites) @ np.array(self.matrix, dtype=np.float32).T)

    def evened(self, flat: Image, whites: Whites) -> Image:
        """The light of such a photograph under an even lamp and one exposure, before the matrix."""
        height, width = flat.shape[:2]
        lamp = _powers(np.linspace(-1, 1, width), np.linspace(-1, 1, height)) @ np.array(self.lamp)
        gains = [
            np.asarray(whites[tag]) / np.maximum(self.whites[tag], _DARKEST) for tag in whites.keys() & self.whites
        ]
        exposure = np.median(gains, axis=0) if gains else np.ones(3)
        paper = light_of(np.array(self.paper, dtype=np.float32))
        return np.asarray(light_of(flat) * (paper / np.maximum(np.exp(lamp) * exposure, _DARKEST)), dtype=np.float32)


def whites_of(photo: Image, view: CameraView, frame: TagFrame) -> dict[int, Floats]:
    """The light off the white around each tag that `view` was found by, in the photograph (H, W, 3)."""
    found = {}
    shares = np.linspace(0, 1, _RING)[:, None]
    for tag in view.tags:
        corners = frame.corners(tag)
        middle = corners.mean(axis=0)
        ring = middle + (corners - middle) * (1 + frame.quiet / frame.side)
        points = np.concatenate([a + shares * (b - a) for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True)])
        found[tag] = np.median(light_of(sampled(photo, view.to_photo(points))), axis=0).astype(np.float64)
    return found


def lamp_of(flat: Image, whites: Whites, paper: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> Colours:
    """The colours from a flat photograph of the bare sheet (H, W, 3), whose colour `paper` is said to be.

    whites: of the same photograph, none where there are no tags.
    Raises InputError where the photograph is overexposed, or there is something on the sheet.
    """
    clipped = (flat >= _WHITEST).mean(axis=(0, 1)).max()
    if clipped > _CLIPPED:
        raise InputError(f"{clipped:.0%} of the sheet is overexposed; lower the camera's exposure or dim the lamp")
    step = max(1, max(flat.shape[:2]) // _SAMPLES)
    rows, columns = (np.arange(ceil(_RIM * size), size - ceil(_RIM * size), step) for size in flat.shape[:2])
    terms = _powers(2 * columns / (flat.shape[1] - 1) - 1, 2 * rows / (flat.shape[0] - 1) - 1).reshape(-1, len(_TERMS))
    light = light_of(flat[np.ix_(rows, columns)]).reshape(-1, 3).astype(np.float64)
    logs = np.log(np.maximum(light, _DARKEST))
    usual = np.ones(len(logs), dtype=bool)
    for _ in range(3):
        numbers = np.linalg.lstsq(terms[usual], logs[usual], rcond=None)[0]
        apart = np.abs(logs - terms @ numbers).max(axis=1)
        usual = apart <= _OUTLIER * np.median(apart)
    spread = float(np.sqrt(np.mean(np.square(logs - terms @ numbers))))
    if spread > _UNEVEN:
        raise InputError(
            f"the sheet's brightness varies by {spread:.0%} beside the lamp's; photograph it bare and whole"
        )
    kept = {tag: tuple(float(x) for x in white) for tag, white in whites.items()}
    return Colours.model_validate({"lamp": numbers.tolist(), "whites": kept, "paper": paper})


def write_colours(colours: Colours, path: str | Path) -> None:
    """Write the JSON of colours; raises OutputError where that fails, and what was at `path` is then still there."""
    write_record(colours, path)


def read_colours(path: str | Path) -> Colours:
    """The colours in a file; raises InputError where there are none."""
    return read_record(Colours, path, "camera's colours")


def _powers(x: Floats, y: Floats) -> Floats:
    """(y, x, terms)."""
    return np.stack([y[:, None] ** j * x**i for i, j in _TERMS], axis=-1)
