"""A painting: the commanded strokes in painting order, each with its paint, on a sheet; and its file (design §1, §3).

Numbers are rounded when a painting is made (lengths to a micrometre), so that its file says all there is to say.
"""

import base64
import json
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Final, Literal, Self

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    JsonValue,
    PlainSerializer,
    ValidationError,
    model_validator,
)

from maulstick.errors import InputError, validation_fault
from maulstick.painting.brush import Brush, Name
from maulstick.painting.picture import decode_png, spread
from maulstick.painting.raster import Canvas
from maulstick.storage.arrays import Floats, Image
from maulstick.storage.files import atomic_write, file_to_read

SCHEMA_VERSION: Final = 1
_LARGEST_FILE = 256 * 2**20  # bytes: some 250,000 strokes
_SLACK = 2e-6  # metres: what rounding may move two ends of a length


def _rounded(number: float) -> float:
    return round(number, 6) + 0.0  # never -0.0


def _nine_digits(number: float) -> float:
    return float(f"{number:.9g}")  # all that a float32 holds


def _encodable(text: Any) -> Any:
    return text.encode(errors="replace").decode() if isinstance(text, str) else text  # names of files may be any bytes


def _plain(options: dict[str, JsonValue]) -> dict[str, JsonValue]:
    plain: dict[str, JsonValue] = json.loads(_encodable(json.dumps(options, ensure_ascii=False, allow_nan=False)))
    return plain


def _from_base64(content: Any) -> Any:
    if not isinstance(content, str):
        return content
    try:
        return base64.b64decode(content, validate=True)
    except ValueError:
        raise ValueError("it is not base64; embed a PNG in base64") from None


def _to_base64(content: bytes) -> str:
    return base64.b64encode(content).decode()


def _decodable(content: bytes) -> bytes:
    decode_png(content)
    return content


Metres = Annotated[float, AfterValidator(_rounded)]
Length = Annotated[float, AfterValidator(_rounded), Field(gt=0)]
Share = Annotated[float, Field(ge=0, le=1), AfterValidator(_rounded)]
Point = tuple[Metres, Metres, Share]
Colour = tuple[Share, Share, Share]
Png = Annotated[
    bytes, BeforeValidator(_from_base64), AfterValidator(_decodable), PlainSerializer(_to_base64, when_used="json")
]
Area = tuple[Metres, Metres, Length, Length]


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Paint(_Part):
    """A colour (sRGB) and the brush that applies it, by its name in the painting; name: what its tube says."""

    colour: Colour
    brush: Name
    name: Name | None = None

    @property
    def hex(self) -> str:
        """The colour as ``#rrggbb``."""
        return hex_colour(self.colour)

    @property
    def label(self) -> str:
        """What a person knows it by: the colour as ``#rrggbb``, after its name where it has one."""
        return self.hex if self.name is None else f"{self.name} {self.hex}"


class StyleUse(_Part):
    """Where a style made a stroke: all that planning again needs.

    name, hash: of the style.  code: what it decoded.  pose: (dx, dy, dtheta), metres and radians.
    """

    name: Name
    hash: Name
    code: tuple[Annotated[float, AfterValidator(_nine_digits)], ...]
    pose: tuple[Metres, Metres, Annotated[float, AfterValidator(_nine_digits)]]


class Stroke(_Part):
    """One stroke, as it is commanded: R(dtheta)(x, y) + (dx, dy). Where its mark lands is for `Brush.mark` to say.

    id: its name for good, unique in the painting.  paint: index into the painting's paints.
    trajectory: (n, 3) points (x, y, pressure), metres on the canvas and [0, 1].  speed: metres a second at each point.
    """

    id: Annotated[int, Field(ge=0)]
    paint: Annotated[int, Field(ge=0)]
    trajectory: Annotated[tuple[Point, ...], Field(min_length=1)]
    speed: tuple[Length, ...] | None = None
    style: StyleUse | None = None

    @model_validator(mode="after")
    def _one_speed_a_point(self) -> Self:
        if self.speed is not None and len(self.speed) != len(self.trajectory):
            raise ValueError(f"there are {len(self.speed)} speeds for {len(self.trajectory)} points; give one a point")
        return self


class Sheet(_Part):
    """What is painted on: width and height in metres, and the colour of the paper (sRGB).

    picture: where something is on the sheet before the first stroke, its photograph, a PNG of 8-bit sRGB of at most
    4096 pixels a side, which covers the sheet; base64 in the file.
    """

    width: Length
    height: Length
    paper: Colour = (1.0, 1.0, 1.0)
    picture: Png | None = None

    def image(self, canvas: Canvas) -> Image:
        """The sheet before the first stroke on the pixels of the canvas, (height_px, width_px, 3) in [0, 1]."""
        if self.picture is not None:
            return spread(decode_png(self.picture), canvas)
        return np.full((canvas.height_px, canvas.width_px, 3), self.paper, dtype=np.float32)


class Provenance(_Part):
    """How a painting was made: Maulstick's version, the picture (name and SHA-256), the seed and the options.

    metrics: how near the plan came to the picture, each by its name (psnr in dB, ssim ...).
    """

    version: Name
    image: Annotated[str, BeforeValidator(_encodable)] | None = None
    image_sha256: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")] | None = None
    seed: int = 0
    options: Annotated[dict[str, JsonValue], AfterValidator(_plain)] = Field(default_factory=dict)
    metrics: dict[Name, float] = Field(default_factory=dict)


def _whole_sheet(fields: dict[str, Any]) -> Area:
    sheet = fields.get("sheet") or Sheet(width=1, height=1)  # a sheet that was refused is reported by itself
    return (0.0, 0.0, sheet.width, sheet.height)


class Painting(_Part):
    """Strokes in painting order, and all that is needed to paint, preview or plan them again.

    sheet: what is painted on.  area: the picture's place on it, (x, y, width, height), metres.
    brushes: embedded whole, by name.  paints: what strokes point into.
    """

    schema_version: Literal[1] = SCHEMA_VERSION
    sheet: Sheet
    area: Area = Field(default_factory=_whole_sheet)
    provenance: Provenance
    brushes: dict[Name, Brush]
    paints: tuple[Paint, ...]
    strokes: tuple[Stroke, ...]

    @model_validator(mode="after")
    def _agrees_with_itself(self) -> Self:
        x, y, width, height = self.area
        if min(x, y) < -_SLACK or x + width > self.sheet.width + _SLACK or y + height > self.sheet.height + _SLACK:
            size = f"{self.sheet.width:g} x {self.sheet.height:g} m"
            raise ValueError(f"area: {list(self.area)} does not lie on the sheet; it must be within its {size}")
        for index, paint in enumerate(self.paints):
            if paint.brush not in self.brushes:
                there = ", ".join(sorted(self.brushes)) or "none"
                raise ValueError(f"paints[{index}].brush: there is no {paint.brush!r} in brushes; there are: {there}")
        seen: set[int] = set()
        for index, stroke in enumerate(self.strokes):
            if stroke.paint >= len(self.paints):
                allowed = f"an index into the {len(self.paints)} paints, from 0"
                raise ValueError(f"strokes[{index}].paint: it is {stroke.paint}; it must be {allowed}")
            if stroke.id in seen:
                raise ValueError(f"strokes[{index}].id: {stroke.id} is an earlier stroke's; give every stroke its own")
            seen.add(stroke.id)
        return self

    def trajectories(self) -> Floats:
        """Commanded (x, y, pressure), (N, n, 3), metres; a shorter one repeats its last point, which draws nothing."""
        longest = max((len(stroke.trajectory) for stroke in self.strokes), default=1)
        padded = [s.trajectory + s.trajectory[-1:] * (longest - len(s.trajectory)) for s in self.strokes]
        return np.array(padded, dtype=np.float64).reshape(-1, longest, 3)

    def lengths(self) -> Floats:
        """(N,) metres that each stroke is drawn."""
        steps = np.diff(self.trajectories()[..., :2], axis=1)
        return np.asarray(np.hypot(steps[..., 0], steps[..., 1]).sum(axis=1))

    def metres_of_paints(self) -> Floats:
        """(k,) metres that are drawn with each paint."""
        paint_of = np.array([stroke.paint for stroke in self.strokes], dtype=np.int64)
        return np.asarray(np.bincount(paint_of, self.lengths(), len(self.paints)), dtype=np.float64)

    def paint_changes(self) -> int:
        """How often the painter must take up another paint after the first."""
        return sum(before.paint != after.paint for before, after in pairwise(self.strokes))


def hex_colour(colour: tuple[float, float, float]) -> str:
    """An sRGB colour in [0, 1] as ``#rrggbb``."""
    return "#" + "".join(f"{round(255 * channel):02x}" for channel in colour)


def write_painting(painting: Painting, path: str | Path) -> None:
    """Write `painting` as JSON, an entry a line (so a stroke a line), the same bytes for the same painting.

    Raises OutputError where that fails; what was at `path` is then still there.
    """
    fields = painting.model_dump(mode="json")
    fields["sheet"] = _said(fields["sheet"])
    for name in ("paints", "strokes"):
        fields[name] = [_said(entry) for entry in fields[name]]
    body = ",\n".join(f"  {json.dumps(name)}: {_an_entry_a_line(value)}" for name, value in fields.items())
    atomic_write(path, f"{{\n{body}\n}}\n".encode())


def read_painting(path: str | Path) -> Painting:
    """The painting in the file at `path`.

    Raises InputError, naming the file and the field, where there is none or it is not a painting of this schema.
    """
    path = file_to_read(path, "painting")
    if path.stat().st_size > _LARGEST_FILE:
        raise InputError(f"{path} is larger than {_LARGEST_FILE >> 20} MiB; no painting is; name a painting.json")
    try:
        painting = Painting.model_validate_json(path.read_bytes(), strict=True)
    except ValidationError as error:
        raise InputError(f"{path} is not a painting: {_fault(error)}") from error
    except OSError as error:
        raise InputError(f"cannot read the painting {path}: {error.strerror}") from error
    if "schema_version" not in painting.model_fields_set:
        raise InputError(f"{path} is not a painting: schema_version: it is missing; write {SCHEMA_VERSION}")
    return painting


def _said(fields: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in fields.items() if value is not None}


def _an_entry_a_line(value: Any) -> str:
    if isinstance(value, dict):
        lines = [f"{json.dumps(name)}: {json.dumps(entry)}" for name, entry in value.items()]
    elif isinstance(value, list):
        lines = [json.dumps(entry) for entry in value]
    else:
        return json.dumps(value)
    opening, closing = "{}" if isinstance(value, dict) else "[]"
    return f"{opening}\n    " + ",\n    ".join(lines) + f"\n  {closing}" if lines else opening + closing


def _fault(error: ValidationError) -> str:
    faults = error.errors(include_url=False)
    for fault in faults:
        if fault["loc"] == ("schema_version",) and isinstance(came := fault["input"], int):
            remedy = "update Maulstick" if came > SCHEMA_VERSION else "write the painting again"
            return f"schema_version: it is {came}, and this Maulstick reads version {SCHEMA_VERSION}; {remedy}"
    if not faults[0]["loc"] and faults[0]["type"] == "value_error":
        return str(faults[0]["ctx"]["error"])  # `Painting._agrees_with_itself` names the field
    return validation_fault(error)
