"""Reader of strokes that a web page recorded from pointer events, in Maulstick's own JSON (docs/pointer-events.md)."""

from codecs import BOM_UTF8
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic.dataclasses import dataclass

from maulstick.errors import InputError, validation_fault
from maulstick.recording.files.page import Page
from maulstick.storage.arrays import Floats

NO_PRESSURE = 0.5
"""Pressure that a browser must report for hardware without pressure, such as a mouse (W3C Pointer Events)."""

_Number = Annotated[float, Field(allow_inf_nan=False)]
_Side = Annotated[_Number, Field(gt=0)]


@dataclass(
    slots=True, config=ConfigDict(extra="ignore")
)  # a page may write other fields of its events too, such as tiltX
class _Point:
    timeStamp: _Number  # noqa: N815
    x: _Number
    y: _Number
    pressure: Annotated[_Number, Field(ge=0, le=1)]


class _Recording(BaseModel):
    model_config = ConfigDict(extra="forbid")

    schema_version: Literal[1]
    size_mm: tuple[_Side, _Side]
    strokes: list[list[_Point]]


def read_pointer_events(content: bytes) -> Page:
    """Read the page in a JSON recording.

    Raises InputError, naming the field, where it is not one, and where most points lie off the sheet, as those of a
    recording in pixels do.
    """
    try:
        recording = _Recording.model_validate_json(content.removeprefix(BOM_UTF8), strict=True)
    except ValidationError as error:
        raise InputError(validation_fault(error)) from error
    for index, points in enumerate(recording.strokes):
        if not points:
            raise InputError(f"strokes[{index}] has no points; leave it out")
    strokes = [_stroke(points) for points in recording.strokes]
    _check_on_sheet(strokes, recording.size_mm)
    return Page(strokes, unit=1e-3, size=recording.size_mm, kind="pointer events")


def _stroke(points: list[_Point]) -> Floats:
    stroke = np.array([(point.timeStamp * 1e-3, point.x, point.y, point.pressure) for point in points])
    if (stroke[:, 3] == NO_PRESSURE).all():
        stroke[:, 3] = np.nan
    return stroke


def _check_on_sheet(strokes: list[Floats], size: tuple[float, float]) -> None:
    places = np.concatenate([np.zeros((0, 4)), *strokes])[:, 1:3]
    off = ((places < 0) | (places > size)).any(axis=1)
    if 2 * off.sum() <= len(places):
        return
    low, high = places.min(axis=0), places.max(axis=0)
    beyond = np.concatenate([-low, high - size])
    farthest = int(beyond.argmax())
    way, value = ("from", low[farthest]) if farthest < 2 else ("to", high[farthest - 2])
    raise InputError(
        f"its strokes lie off the sheet of {size[0]:g} x {size[1]:g} mm ({'xy'[farthest % 2]} {way} {value:.4g} mm); "
        "x and y must be millimetres"
    )
