"""Reach of an arm that holds its pen downwards: how near and how far it gets, by the lengths of its links."""

from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from maulstick.storage.arrays import Floats

_Above = Annotated[float, Field(gt=0, allow_inf_nan=False)]
_Length = Annotated[float, Field(ge=0, allow_inf_nan=False)]
_Finite = Annotated[float, Field(allow_inf_nan=False)]


class Reach(BaseModel):
    """Reach of one model, in the machine's frame, whose z is the axis of the base; metres.

    What counts is the wrist: where the axis that turns the pen crosses the one that tilts it, straight above the pen.

    model: its name for people.  shoulder: height of the shoulder's axis.
    nearest, farthest: distances from the shoulder that the end of the forearm can have, in the arm's plane.
    forward: from there to the wrist, level, away from the base.  sideways: of the wrist from the plane of the shoulder.
    printed: the reach that the maker prints, beyond which the wrist does not go either.
    column: radius about the base's axis that the wrist keeps out of.
    flange: from the wrist to the flange.  wrist: (x, y, z) from the tip to the wrist, as the pen is held.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    model: str
    shoulder: _Finite
    nearest: _Length
    farthest: _Above
    forward: _Length = 0.0
    sideways: _Length = 0.0
    printed: _Above
    column: _Length
    flange: _Length
    wrist: tuple[_Finite, _Finite, _Finite] = (0.0, 0.0, 0.0)

    def holding(self, turned: Floats, tip: Floats) -> "Reach":
        """Return the reach with a pen that is held so.

        turned: (3, 3) orientation of the flange in the machine's frame.
        tip: (3,) place of the pen's tip as the flange sees it, metres.
        """
        x, y, z = (-np.asarray(turned) @ np.add(tip, [0.0, 0.0, self.flange])).tolist()
        return self.model_copy(update={"wrist": (x, y, z)})

    def radii(self, places: Floats) -> tuple[Floats, Floats, Floats]:
        """Return how far the wrist is from the base's axis, the least and the most it may be, (n,) each, metres.

        The last is below 0 for places (n, 3) that are too high or too low for any distance.
        """
        wrist = np.asarray(places) + self.wrist
        height = wrist[:, 2] - self.shoulder
        stretched = _leg(self.farthest, height)
        most = np.minimum(np.hypot(stretched + self.forward, self.sideways), _leg(self.printed, height))
        folded = np.hypot(_leg(self.nearest, height).clip(min=0), self.sideways)
        return np.hypot(wrist[:, 0], wrist[:, 1]), np.maximum(folded, self.column), np.where(stretched < 0, -1.0, most)

    def beyond(self, places: Floats) -> Floats:
        """Return by how many metres (n,) places (n, 3) are too far, or below 0, too near; 0 where they are reached."""
        radius, least, most = self.radii(places)
        return np.where(radius > most, radius - most, np.minimum(radius - least, 0))

    def fault(self, place: Floats) -> str:
        """Return what is wrong with a place (3,) that is not reached, as in ``is 46 mm too far from the base ...``."""
        (radius,), (least,), (most,) = (np.asarray(value) for value in self.radii(place[None]))
        if most < 0:
            too = "high" if place[2] + self.wrist[2] > self.shoulder else "low"
            return f"is too {too} for the {self.model} at any distance from its base"
        if radius > most:
            allowed = f"whose wrist gets {1e3 * most:.0f} mm from its axis at that height"
            return f"is {1e3 * (radius - most):.3g} mm too far from the base of the {self.model}, {allowed}"
        allowed = f"whose wrist must stay {1e3 * least:.0f} mm from its axis at that height"
        return f"is {1e3 * (least - radius):.3g} mm too near to the base of the {self.model}, {allowed}"


def _leg(long: float, height: Floats) -> Floats:
    """Return the level side (n,) of a right triangle with that hypotenuse, -1 where it is shorter than the height."""
    square = long**2 - height**2
    return np.where(square < 0, -1.0, np.sqrt(square.clip(min=0)))
