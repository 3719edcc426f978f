"""Limits of a machine, and the checks that every motion has to pass."""

from typing import Annotated, Final, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from maulstick.errors import InputError
from maulstick.robot.reach import Reach
from maulstick.storage.arrays import Floats

_SHARE = 1e-12  # least component of a direction, so that no division is by zero

SLACK: Final = 1e-9
"""Metres, or metres per second, beyond a limit that count as rounding."""

_Above = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Point = tuple[float, float, float]


class Limits(BaseModel):
    """Limits of a machine in its own frame (right-handed, z up), metres and seconds.

    lower, upper: corners (x, y, z) of the workspace.
    speed: highest speed of the tip.  climb: highest speed of its height.  acceleration: highest acceleration of either.
    axes: highest accelerations of x, y and z, where each axis has a limit of its own, as Grbl's do.
    deviation: distance from a corner at which the tip may pass without stopping (Grbl's junction deviation); 0 stops,
    and so does None, unless these limits narrow others that say it.
    varies_pressure: whether it can vary the height within a stroke; if not, it only lifts its pen and lowers it.
    lifting: seconds for lifting or lowering, beside what the height takes.
    settling: seconds from the end of a motion until the machine says so, and takes the next one.
    tilt: largest angle between the paper and the machine's xy plane, radians.
    reach: what of the workspace an arm gets to, where that is known.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    lower: Point
    upper: Point
    speed: _Above
    climb: _Above
    acceleration: _Above
    axes: tuple[_Above, _Above, _Above] | None = None
    deviation: Annotated[float, Field(ge=0, allow_inf_nan=False)] | None = None
    varies_pressure: bool
    lifting: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0
    settling: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0
    tilt: _Above = 0.1
    reach: Reach | None = None

    @model_validator(mode="after")
    def _has_room(self) -> Self:
        if not (np.isfinite([self.lower, self.upper]).all() and np.all(np.less(self.lower, self.upper))):
            raise ValueError(f"the workspace from {self.lower} to {self.upper} has no room; give lower, then upper")
        return self

    def check_path(self, path: Floats) -> None:
        """Raise InputError where a point of the path (n, 3) lies outside the workspace, saying by how much."""
        path = np.asarray(path, dtype=np.float64)
        if path.ndim != 2 or path.shape[1] != 3 or len(path) == 0:
            raise InputError(f"a path has shape {path.shape}; it must be (n, 3) with n of at least 1")
        if not np.isfinite(path).all():
            raise InputError("a point of the path is not a finite number")
        for axis, name in enumerate("xyz"):
            least, most = float(path[:, axis].min()), float(path[:, axis].max())
            low, high = self.lower[axis], self.upper[axis]
            beyond = max(low - least, most - high)
            if beyond > SLACK:
                came = least if low - least > most - high else most
                allowed = f"{1e3 * low:g} to {1e3 * high:g} mm: {1e3 * beyond:.4g} mm less far"
                raise InputError.of_range(f"the machine's {name}", f"{1e3 * came:.6g} mm", allowed)

    def check_height(self, height: float) -> None:
        """Raise InputError as `check_path` where a height, metres, lies outside the workspace, whatever x and y are."""
        self.check_path(np.array([[*self.lower[:2], height]]))

    def check_speed(self, speed: Floats) -> None:
        """Raise InputError where a speed (n,), metres per second, is not above 0 and at most the machine's."""
        speed = np.asarray(speed, dtype=np.float64)
        wrong = speed[~((speed > 0) & (speed <= self.speed + SLACK))]  # so that NaN is wrong as well
        if len(wrong):
            allowed = f"above 0 and at most {1e3 * self.speed:g} mm/s"
            raise InputError.of_range("the speed", f"{1e3 * wrong[0]:g} mm/s", allowed)

    def holds(self, places: Floats) -> bool:
        """Return whether all places (n, 3) lie in the workspace and, for an arm, within its reach."""
        if (places < np.subtract(self.lower, SLACK)).any() or (places > np.add(self.upper, SLACK)).any():
            return False
        return self.reach is None or not self.reach.beyond(places).any()

    def acceleration_along(self, units: Floats) -> Floats:
        """Return the highest acceleration (n,) along unit vectors (n, 3), metres per second squared."""
        if self.axes is None:
            return np.full(len(units), self.acceleration)
        return np.asarray((self.axes / np.maximum(np.abs(units), _SHARE)).min(axis=1))

    def narrowed(self, other: "Limits") -> "Limits":
        """Return the stricter of both limits in everything; an arm has one reach, so that of either.

        Raises InputError where the workspaces do not overlap.
        """
        lower, upper = np.maximum(self.lower, other.lower), np.minimum(self.upper, other.upper)
        if not np.all(lower < upper):
            raise InputError(
                f"the workspaces from {self.lower} to {self.upper} m and from {other.lower} to {other.upper} m have no "
                "place in common; mend the limits in the easel's file"
            )
        return Limits(
            lower=tuple(lower.tolist()),
            upper=tuple(upper.tolist()),
            speed=min(self.speed, other.speed),
            climb=min(self.climb, other.climb),
            acceleration=min(self.acceleration, other.acceleration),
            axes=None if self.axes is other.axes is None else tuple(np.minimum(self._gains, other._gains).tolist()),
            deviation=min((each for each in (self.deviation, other.deviation) if each is not None), default=None),
            varies_pressure=self.varies_pressure and other.varies_pressure,
            lifting=max(self.lifting, other.lifting),
            settling=max(self.settling, other.settling),
            tilt=min(self.tilt, other.tilt),
            reach=self.reach or other.reach,
        )

    def shifted(self, by: Floats) -> "Limits":
        """Return the same limits with the workspace shifted by (3,), metres, in a frame whose origin has moved."""
        lower, upper = (np.asarray(np.add(end, by) + 0.0).tolist() for end in (self.lower, self.upper))
        return self.model_copy(update={"lower": tuple(lower), "upper": tuple(upper)})

    @property
    def _gains(self) -> Point:
        """Highest accelerations of x, y and z, metres per second squared."""
        return self.axes or (self.acceleration,) * 3
