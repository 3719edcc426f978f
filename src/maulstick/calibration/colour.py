"""Colours of photographs: an even light, one exposure for all photographs, and true colours from a chart."""

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
"""Light (3,) off the white around each tag that is seen."""

SCHEMA_VERSION: Final = 1
"""Version of the file of colours."""

_DEGREE = 3  # of the polynomial of a lamp's light over the sheet
_TERMS = [(i, j) for i in range(_DEGREE + 1) for j in range(_DEGREE + 1 - i)]  # powers of x and y
_SAMPLES = 200  # across a sheet, to fit its light
_RIM = 0.02  # share of the sheet along its edges that is left out, as the bed may be seen there
_OUTLIER = 4.0  # median deviations beyond which a place does not count for the lamp
_UNEVEN = 0.04  # standard deviation of the light, as a share, beyond which there is something on the sheet
_WHITEST, _CLIPPED = 0.995, 0.01  # sRGB from which a pixel is overexposed, and the share that may be
_DAZZLED = 0.25  # share of a sheet with something on it that may be overexposed: a lamp is never quite even
_DARKEST = 1e-3  # least light, so that no division or logarithm is of zero
_BLACKEST = 0.02  # least light off paper, as in docs/paints.md: of one that is said to give none, all would be black
_RING = 16  # samples along each side of a tag's white rim
_SAME_SIZE = 1e-6  # metres: 8.5in is not quite 215.9mm in binary numbers
_Row = tuple[float, float, float]
_Share = Annotated[float, Field(ge=0, le=1)]
_UNCHANGED: Final = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class Colours(BaseModel):
    """Correction of the colours that a lamp and a camera change.

    lamp: coefficients of a cubic in x and y, -1 to 1 across the sheet: the logarithm of the light off bare paper, in
    each channel.  whites: light around the tags at that moment.  paper: colour of the sheet, sRGB in [0, 1].
    matrix: (3, 3), from light under an even lamp to true light.  sheet: width and height of the sheet of the lamp,
    metres; None where that was not kept.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    schema_version: Literal[1] = SCHEMA_VERSION
    lamp: Annotated[tuple[_Row, ...], Field(min_length=len(_TERMS), max_length=len(_TERMS))]
    whites: dict[int, _Row]
    paper: tuple[_Share, _Share, _Share] = (1.0, 1.0, 1.0)
    matrix: tuple[_Row, _Row, _Row] = _UNCHANGED
    sheet: tuple[float, float] | None = None

    @property
    def paper_light(self) -> Floats:
        """Light (3,) off the bare sheet under an even lamp; also a paper that is said to be black gives some."""
        return np.maximum(light_of(np.array(self.paper)), _BLACKEST)

    def with_sheet(self, sheet: tuple[float, float]) -> Self:
        """Return the colours with the size of their sheet, (width, height) in metres."""
        return self.model_copy(update={"sheet": sheet})

    def is_of_another(self, sheet: tuple[float, float]) -> bool:
        """Return whether the lamp is known to be that of a sheet of another size than (width, height), metres."""
        return self.sheet is not None and not np.allclose(self.sheet, sheet, rtol=0, atol=_SAME_SIZE)

    def with_matrix(self, matrix: Floats) -> Self:
        """Return the colours with another matrix (3, 3)."""
        return self.model_copy(update={"matrix": tuple(tuple(row) for row in matrix.tolist())})

    def correct(self, flat: Image, whites: Whites) -> Image:
        """Return a flat photograph of the whole sheet (H, W, 3), sRGB in [0, 1], in true colours.

        whites: of the same photograph. The exposure is corrected by the tags seen in both; without any, it counts as
        unchanged. Raises InputError where the photograph is overexposed.
        """
        return colours_of(self.evened(flat, whites) @ np.array(self.matrix, dtype=np.float32).T)

    def evened(self, flat: Image, whites: Whites) -> Image:
        """Return the light (H, W, 3) of such a photograph under an even lamp and one exposure, before the matrix.

        Raises InputError where a quarter of the sheet, or half of the tags, are overexposed.
        """
        dazzling = [tag for tag, white in whites.items() if (colours_of(white) >= _WHITEST).any()]
        if (flat >= _WHITEST).any(axis=-1).mean() > _DAZZLED or 2 * len(dazzling) >= max(len(whites), 1):
            raise InputError("the photograph is overexposed; lower the camera's exposure or dim the lamp")
        height, width = flat.shape[:2]
        lamp = _powers(np.linspace(-1, 1, width), np.linspace(-1, 1, height)) @ np.array(self.lamp)
        gains = [
            np.asarray(whites[tag]) / np.maximum(self.whites[tag], _DARKEST) for tag in whites.keys() & self.whites
        ]
        exposure = np.median(gains, axis=0) if gains else np.ones(3)
        gain = self.paper_light / np.maximum(np.exp(lamp) * exposure, _DARKEST)
        return np.asarray(light_of(flat) * gain, dtype=np.float32)


def whites_of(photo: Image, view: CameraView, frame: TagFrame) -> dict[int, Floats]:
    """Return the light (3,) off the white around each tag that `view` was found by, in the photograph (H, W, 3)."""
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
    """Fit the colours to a flat photograph (H, W, 3) of the bare sheet, whose own colour is `paper`.

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
    """Write colours as JSON. Raises OutputError where that fails; what was at `path` is then still there."""
    write_record(colours, path)


def read_colours(path: str | Path) -> Colours:
    """Read the colours in the file at `path`. Raises InputError where there are none."""
    return read_record(Colours, path, "camera's colours")


def _powers(x: Floats, y: Floats) -> Floats:
    """Return the powers (len(y), len(x), terms) of the lamp's polynomial at places x, y in [-1, 1]."""
    return np.stack([y[:, None] ** j * x**i for i, j in _TERMS], axis=-1)
