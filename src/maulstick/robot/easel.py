"""Position of the sheet before a machine: the only conversion between the canvas frame and the machine's frame."""

from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from maulstick.errors import InputError
from maulstick.robot.limits import Limits, Point
from maulstick.storage.arrays import Floats
from maulstick.storage.records import read_record, write_record

_FARTHEST = {"corner": 100.0, "travel": 1.0}  # metres: more is millimetres that were taken for metres
_SQUARE = 1e-6  # tolerance of unit length and right angle; more than the rounding of a file's decimals
_Finite = Annotated[float, Field(allow_inf_nan=False)]
_Above = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class Pen(BaseModel):
    """Servo that lifts a plotter's pen; `up` and `down` are positions in the machine's own units.

    seconds: time that lifting or lowering takes.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    up: _Finite
    down: _Finite
    seconds: Annotated[float, Field(ge=0, le=10)] = 0.2

    @model_validator(mode="after")
    def _is_lifted(self) -> Self:
        if self.up == self.down:
            raise ValueError("up and down are the same, so the pen is never lifted; give two numbers that differ")
        return self


class Easel(BaseModel):
    """Position of a sheet before a machine, in the machine's frame (right-handed, z up), metres.

    corner: (x, y, z) of the sheet's upper left corner, where the tip just touches the paper.
    right, down: unit vectors along the sheet's upper and left edge.
    deepest: depth below first touch that the tip may reach.  travel: height above the paper between strokes.
    limits: limits narrower than the machine's, for this place.  pen: servo of a plotter that has one.
    error: root mean square distance of the touched points from the fitted sheet, 0 where none were touched.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    schema_version: Literal[1] = 1
    corner: Point
    right: Point
    down: Point
    deepest: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0
    travel: _Above = 5e-3
    limits: Limits | None = None
    pen: Pen | None = None
    error: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0

    @model_validator(mode="after")
    def _is_a_frame(self) -> Self:
        if not np.isfinite(self.corner).all():
            raise ValueError(f"corner: {self.corner} is not a place; give three finite numbers")
        axes = np.array([self.right, self.down])
        if not np.allclose(axes @ axes.T, np.eye(2), atol=_SQUARE):
            raise ValueError("right and down must be two unit vectors at a right angle")
        if self.up[2] <= 0:
            raise ValueError("the paper faces away from the machine; right and down are exchanged, or one is reversed")
        return self

    @property
    def up(self) -> Floats:
        """Unit vector (3,) out of the paper."""
        (a, b, c), (x, y, z) = self.down, self.right
        return np.array([b * z - c * y, c * x - a * z, a * y - b * x])  # np.cross takes ten times as long

    @property
    def tilt(self) -> float:
        """Angle between the paper and the machine's xy plane, radians."""
        return float(np.arccos(np.clip(self.up[2], -1, 1)))

    def canvas_to_machine(self, path: Floats) -> Floats:
        """Return machine places (..., 3) for x, y on the sheet and height above the paper (..., 3), all in metres."""
        return np.asarray(self.corner + np.asarray(path) @ np.array([self.right, self.down, self.up]))

    def machine_to_canvas(self, path: Floats) -> Floats:
        """Return the inverse of `canvas_to_machine`: x, y on the sheet and height above the paper (..., 3), metres."""
        return np.asarray((np.asarray(path) - self.corner) @ np.array([self.right, self.down, self.up]).T)

    def shifted(self, dx: float, dy: float, turn: float = 0.0) -> "Easel":
        """Return the easel of a sheet moved in its plane by (dx, dy), metres, and turned about its corner, radians."""
        right, down = np.array(self.right), np.array(self.down)
        corner = self.corner + dx * right + dy * down
        turned = np.cos(turn) * right + np.sin(turn) * down, np.cos(turn) * down - np.sin(turn) * right
        moved = {"corner": corner.tolist(), "right": turned[0].tolist(), "down": turned[1].tolist()}
        return Easel.model_validate({**self.model_dump(), **moved})


def read_easel(path: str | Path) -> Easel:
    """Read the easel in the file at `path`. Raises InputError where there is none, or it is in millimetres."""
    easel = read_record(Easel, path, "easel")
    for name, length in (("corner", max(map(abs, easel.corner))), ("travel", easel.travel)):
        if length > _FARTHEST[name]:
            came = f"{path} has its {name} at {length:g} m"
            raise InputError(f"{came}; it must be at most {_FARTHEST[name]:g}, so divide millimetres by 1000")
    return easel


def write_easel(easel: Easel, path: str | Path) -> None:
    """Write the easel as JSON. Raises OutputError where that fails; what was at `path` is then still there."""
    write_record(easel, path)
