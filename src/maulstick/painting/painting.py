"""Paintings: commanded strokes in painting order, each with its paint, on a sheet.

Numbers are rounded when a painting is made (lengths to a micrometre), so that its file says all there is to say.
"""

from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, Any, Final, Literal, Self

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from maulstick.painting.brush import Brush, Name
from maulstick.painting.fields import Area, Colour, Length, NineDigits, Options, Png, Point, Pose, Text
from maulstick.painting.picture import decode_png, spread
from maulstick.painting.raster import Canvas
from maulstick.painting.succession import Succession
from maulstick.storage.arrays import Floats, Image
from maulstick.storage.text import counted

SCHEMA_VERSION: Final = 2
"""Version of the format of the files that are written; version 1, whose strokes say less, is read too."""

OFF_SHEET: Final = 1e-3
"""Metres that a commanded stroke may lie off its sheet: about as well as a sheet is cut, and laid before a machine."""

_MOST_POINTS = 2**20  # of the trajectories of one part of a painting: 24 MiB of numbers, 32,768 strokes as planned
_SLACK = 2e-6  # metres: how much rounding can change a sum of two lengths


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Paint(_Part):
    """A colour (sRGB in [0, 1]) and the brush that applies it, by its name in the painting; name: as on the tube."""

    colour: Colour
    brush: Name
    name: Name | None = None

    @property
    def hex(self) -> str:
        """The colour as ``#rrggbb``."""
        return hex_colour(self.colour)

    @property
    def label(self) -> str:
        """The colour as ``#rrggbb``, after the paint's name where it has one."""
        return self.hex if self.name is None else f"{self.name} {self.hex}"


class StyleUse(_Part):
    """The style that made a stroke, and what is needed to plan the stroke again.

    name, hash: of the style.  code: the latent code that it decoded.  pose: (dx, dy, dtheta), metres and radians.
    """

    name: Name
    hash: Name
    code: tuple[NineDigits, ...]
    pose: Pose


class Stroke(_Part):
    """A stroke as it is commanded: R(dtheta)(x, y) + (dx, dy). `Brush.mark` gives the place of its mark.

    id: a number that never changes, unique in the painting.  paint: index into the painting's paints.
    trajectory: n points (x, y, pressure), metres on the canvas and [0, 1].  speed: metres per second at each point.
    locked: whether planning again leaves it as it is.  origin: who drew it; a guide also says where others go.
    region: name of the region that it was planned in, None where the plan had none.
    """

    id: Annotated[int, Field(ge=0)]
    paint: Annotated[int, Field(ge=0)]
    trajectory: Annotated[tuple[Point, ...], Field(min_length=1)]
    speed: tuple[Length, ...] | None = None
    style: StyleUse | None = None
    locked: bool = False
    origin: Literal["planned", "person", "guide"] = "planned"
    region: Name | None = None

    @model_validator(mode="after")
    def _one_speed_per_point(self) -> Self:
        if self.speed is not None and len(self.speed) != len(self.trajectory):
            raise ValueError(
                f"it has {counted(len(self.speed), 'speed')} for {counted(len(self.trajectory), 'point')}; "
                "give one per point"
            )
        return self


class Sheet(_Part):
    """The sheet that is painted on: width and height in metres, and the colour of the paper (sRGB in [0, 1]).

    picture: photograph of the whole sheet before the first stroke, where it is not empty: a PNG of 8-bit sRGB of at
    most 4096 pixels per side; base64 in the file.
    """

    width: Length
    height: Length
    paper: Colour = (1.0, 1.0, 1.0)
    picture: Png | None = None

    @property
    def millimetres(self) -> str:
        """The size for people, as in ``200 x 160 mm``."""
        return f"{1e3 * self.width:g} x {1e3 * self.height:g} mm"

    def overhang(self, points: Floats) -> Floats:
        """Return how far strokes of points (N, n, 2), metres, reach beyond the sheet's edges, (N,); below 0 within."""
        beyond = np.maximum(-points, points - (self.width, self.height))
        return np.asarray(beyond.max(axis=(1, 2), initial=-np.inf))

    def image(self, canvas: Canvas) -> Image:
        """Return the sheet before the first stroke on the canvas's pixels, (height_px, width_px, 3) sRGB in [0, 1]."""
        if self.picture is not None:
            return spread(decode_png(self.picture), canvas)
        return np.full((canvas.height_px, canvas.width_px, 3), self.paper, dtype=np.float32)


class Provenance(_Part):
    """Origin of a painting: Maulstick's version, the picture (name and SHA-256), the seed and the options.

    metrics: measures of how near the plan came to the picture, by name: psnr in dB, ssim and others at the truth,
    psnr_planned and the terms of the loss of the pixels that a plan ends on.
    """

    version: Name
    image: Text | None = None
    image_sha256: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")] | None = None
    seed: int = 0
    options: Options = Field(default_factory=dict)
    metrics: dict[Name, float] = Field(default_factory=dict)


def _of_today(version: Any) -> Any:
    return SCHEMA_VERSION if version == 1 and type(version) is int else version


def _whole_sheet(fields: dict[str, Any]) -> Area:
    sheet = fields.get("sheet") or Sheet(width=1, height=1)  # a sheet that was refused is reported by itself
    return (0.0, 0.0, sheet.width, sheet.height)


class Painting(_Part):
    """Strokes in painting order, with all that is needed to paint, preview or plan them again.

    sheet: what is painted on; no commanded point lies more than `OFF_SHEET` beyond its edges, or a machine would draw
    on its bed.  area: the picture's place on it, (x, y, width, height), metres.
    brushes: all brushes by name.  paints: the list that a stroke's `paint` is an index into.
    succession: what the hand draws next, where strokes are to be drawn in its order; not in the file where None.
    literal: whether strokes go straight from point to point and are painted in just this order, as a drawing is, where
    others are `refined` and put in a quick order; not in the file where False.
    Raises ValidationError where a field is wrong or two of them do not agree.
    """

    schema_version: Annotated[Literal[2], BeforeValidator(_of_today)] = SCHEMA_VERSION
    sheet: Sheet
    area: Area = Field(default_factory=_whole_sheet)
    provenance: Provenance
    brushes: dict[Name, Brush]
    paints: tuple[Paint, ...]
    strokes: tuple[Stroke, ...]
    succession: Succession | None = None
    literal: bool = False

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
                allowed = f"an index into the {counted(len(self.paints), 'paint')}, from 0"
                raise ValueError(f"strokes[{index}].paint: it is {stroke.paint}; it must be {allowed}")
            if stroke.id in seen:
                raise ValueError(f"strokes[{index}].id: {stroke.id} is an earlier stroke's; give every stroke its own")
            seen.add(stroke.id)
        overhang = np.concatenate([self.sheet.overhang(part.trajectories()[..., :2]) for part in self.parts()])
        for index in np.flatnonzero(overhang > OFF_SHEET + _SLACK)[:1]:
            raise ValueError(
                f"stroke {self.strokes[index].id} reaches {1e3 * overhang[index]:.4g} mm beyond the sheet of "
                f"{self.sheet.millimetres}, onto a machine's bed; at most {1e3 * OFF_SHEET:g} mm is allowed: "
                "move the stroke, or give a larger sheet"
            )
        return self

    def parts(self) -> Iterator[Self]:
        """Yield the painting as parts of successive strokes, so few that the `trajectories` of a part stay small.

        A part has at most 2**20 points, padded ones counted, or a single stroke; so one stroke of many points does
        not pad all others.
        """
        begin, longest = 0, 1
        for index, stroke in enumerate(self.strokes):
            longest = max(longest, len(stroke.trajectory))
            if index > begin and longest * (index + 1 - begin) > _MOST_POINTS:
                yield self.model_copy(update={"strokes": self.strokes[begin:index]})
                begin, longest = index, len(stroke.trajectory)
        yield self.model_copy(update={"strokes": self.strokes[begin:]})

    def trajectories(self) -> Floats:
        """Return commanded points (N, n, 3) of (x, y, pressure), metres; shorter strokes repeat their last point.

        One very long stroke makes this very large; `parts` are of bounded size.
        """
        longest = max((len(stroke.trajectory) for stroke in self.strokes), default=1)
        padded = [s.trajectory + s.trajectory[-1:] * (longest - len(s.trajectory)) for s in self.strokes]
        return np.array(padded, dtype=np.float64).reshape(-1, longest, 3)

    def lengths(self) -> Floats:
        """Return the length of each stroke, (N,), metres."""
        steps = (np.diff(part.trajectories()[..., :2], axis=1) for part in self.parts())
        return np.concatenate([np.hypot(each[..., 0], each[..., 1]).sum(axis=1) for each in steps])

    def metres_of_paints(self) -> Floats:
        """Return the length that is drawn with each paint, (k,), metres."""
        paint_of = np.array([stroke.paint for stroke in self.strokes], dtype=np.int64)
        return np.asarray(np.bincount(paint_of, self.lengths(), len(self.paints)), dtype=np.float64)

    def colours(self) -> list[tuple[Paint, float]]:
        """Return the colours that have to be mixed: of each its first paint, and the metres drawn by all brushes."""
        found: dict[tuple[Colour, str | None], tuple[Paint, float]] = {}
        for paint, metres in zip(self.paints, self.metres_of_paints().tolist(), strict=True):
            first, before = found.get((paint.colour, paint.name), (paint, 0.0))
            found[paint.colour, paint.name] = first, before + metres
        return list(found.values())

    def brush_changes(self) -> int:
        """Number of times that another brush must be put in after the first."""
        used = [self.paints[stroke.paint].brush for stroke in self.strokes]
        return sum(before != after for before, after in pairwise(used))

    def paint_changes(self) -> int:
        """Number of times that another paint must be taken up after the first."""
        return sum(before.paint != after.paint for before, after in pairwise(self.strokes))


def hex_colour(colour: tuple[float, float, float]) -> str:
    """Return an sRGB colour in [0, 1] as ``#rrggbb``."""
    return "#" + "".join(f"{round(255 * channel):02x}" for channel in colour)
