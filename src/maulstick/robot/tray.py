"""The tray and its file: wells of paint, water and a cloth beside the sheet, and how far a dip of paint reaches."""

from collections.abc import Collection
from itertools import combinations
from math import dist
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from maulstick.errors import InputError
from maulstick.painting.brush import Name
from maulstick.painting.painting import Painting
from maulstick.storage.arrays import Floats
from maulstick.storage.records import read_record

_LONGEST = 20.0  # metres that a brush paints with one dip: more is millimetres that were taken for metres
_TURN = 12  # points per turn in a well: a circle to within 4 % of its radius

_Metres = Annotated[float, Field(allow_inf_nan=False)]
_Above = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Well(_Part):
    """Place where the tip turns: paint, water, or a cloth. Metres in the canvas frame, which goes on past the sheet.

    height: height of the tip in it above the paper, negative below.  radius: of a turn.  turns: number of turns.
    """

    x: _Metres
    y: _Metres
    height: _Metres
    radius: _Above = 3e-3
    turns: Annotated[int, Field(ge=1, le=20)] = 1

    def path(self) -> Floats:
        """Return the path (n, 3) of x, y and height, metres: in at the middle, round, and out at the middle."""
        angle = 2 * np.pi * np.arange(self.turns * _TURN + 1) / _TURN
        ring = np.stack([self.x + self.radius * np.cos(angle), self.y + self.radius * np.sin(angle)], axis=1)
        places = np.concatenate([[[self.x, self.y]], ring, [[self.x, self.y]]])
        return np.concatenate([places, np.full((len(places), 1), self.height)], axis=1)

    def is_on(self, width: float, height: float) -> bool:
        """Whether the tip turns over a sheet of that size, metres."""
        nearest = min(max(self.x, 0.0), width), min(max(self.y, 0.0), height)
        return dist((self.x, self.y), nearest) < self.radius

    def overlaps(self, other: "Well") -> bool:
        """Whether the tip turns where it turns in another well."""
        return dist((self.x, self.y), (other.x, other.y)) < self.radius + other.radius


class Tray(_Part):
    """Tray beside the sheet.

    reach: metres that one dip paints.  clearance: height above the paper at which the tip passes over all wells.
    speed: metres per second in the wells.  paints: the wells, by the colour (``#rrggbb``) or the name of their paint.
    water, cloth: places where a brush is rinsed and wiped before it takes another paint.
    """

    schema_version: Literal[1]
    reach: _Above
    clearance: _Above
    speed: _Above = 0.05
    paints: dict[Name, Well]
    water: Well
    cloth: Well

    @field_validator("reach")
    @classmethod
    def _in_metres(cls, reach: float) -> float:
        if reach > _LONGEST:
            raise ValueError(f"it is {reach:g} m; it must be at most {_LONGEST:g}, so divide millimetres by 1000")
        return reach

    @field_validator("paints")
    @classmethod
    def _named_as_paints_are(cls, paints: dict[Name, Well]) -> dict[Name, Well]:
        """Return the wells with colours as `Paint.hex` writes them, ``#ffcc00`` for ``#FFCC00``."""
        named = {name.lower() if name.startswith("#") else name: well for name, well in paints.items()}
        if len(named) < len(paints):
            raise ValueError("a colour is named twice, in small letters and in capitals; leave one out")
        return named

    @model_validator(mode="after")
    def _passes_over(self) -> Self:
        for name, well in {**self.paints, "water": self.water, "cloth": self.cloth}.items():
            if well.height >= self.clearance:
                raise ValueError(
                    f"{name}: its height {well.height:g} m is not below the clearance {self.clearance:g} m"
                )
        return self

    def wells_of(self, painting: Painting) -> list[Well]:
        """Return the wells of a painting's paints, in their order. Raises InputError where a paint has none."""
        found = [self.paints.get(paint.hex) or self.paints.get(paint.name or "") for paint in painting.paints]
        missing = [paint.label for paint, well in zip(painting.paints, found, strict=True) if well is None]
        if missing:
            there = ", ".join(sorted(self.paints)) or "none"
            raise InputError(f"the tray has no well for the paint {missing[0]}; there are: {there}; add it to its file")
        return [well for well in found if well is not None]

    def check_places(self, painting: Painting, dipped: Collection[int], rinsed: bool) -> None:
        """Raise InputError where a well that a painting needs is on its sheet, or overlaps another.

        dipped: paints that are taken up.  rinsed: whether water and cloth are needed.
        """
        wells, sheet = self.wells_of(painting), painting.sheet
        of_paints = [(painting.paints[paint].hex, wells[paint]) for paint in sorted(dipped)]
        own = {(colour, id(well)): well for colour, well in of_paints}  # several brushes share the well of a colour
        needed = [(f"the well of {colour}", well) for (colour, _), well in own.items()]
        if rinsed:
            needed += [("the water", self.water), ("the cloth", self.cloth)]
        for name, well in needed:
            if well.is_on(sheet.width, sheet.height):
                raise InputError(
                    f"{name} of the tray is on the sheet of {1e3 * sheet.width:g} x {1e3 * sheet.height:g} mm, at x "
                    f"{1e3 * well.x:.0f} and y {1e3 * well.y:.0f} mm; move it beside the sheet"
                )
        for (name, well), (other, there) in combinations(needed, 2):
            if well.overlaps(there):
                raise InputError(
                    f"{name} and {other} of the tray are {1e3 * dist((well.x, well.y), (there.x, there.y)):.0f} mm "
                    f"apart, and the tip turns within {1e3 * well.radius:g} and {1e3 * there.radius:g} mm; move one, "
                    "or make its radius smaller"
                )


def read_tray(path: str | Path) -> Tray:
    """Read the tray in the file at `path`. Raises InputError where there is none."""
    return read_record(Tray, path, "tray")
