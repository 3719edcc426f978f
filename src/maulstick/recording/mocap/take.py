"""Takes: motion capture of a pen and a canvas, from any source, and their files."""

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Self

import numpy as np

from maulstick.errors import InputError
from maulstick.storage.arrays import Bools, Floats, read_arrays, write_arrays

KIND = "take"
"""Kind of a file of arrays that holds a take."""

_UNIT_NORM = 0.01  # tolerance of a quaternion's length, for rounded exports


@dataclass(frozen=True)
class Take:
    """Motion capture of F frames, in the frame of the capture system, metres and seconds; NaN where it was not seen.

    times: (F,), rising.
    pen_positions: (F, 3) and pen_rotations: (F, 4), quaternions (x, y, z, w) of length 1, of the pen's rigid body.
    pen_markers: (F, M, 3), the markers on the pen in a fixed order; M is 0 where none were exported.
    canvas_markers: (F, 3, 3), the markers at three corners of the canvas, in a fixed but unknown order.
    Raises InputError for other shapes, times that do not rise, or other quaternions.
    """

    times: Floats
    pen_positions: Floats
    pen_rotations: Floats
    pen_markers: Floats
    canvas_markers: Floats

    def __post_init__(self) -> None:
        frames, markers = self.times.size, self.pen_markers.shape[1:2]
        shapes = (frames,), (frames, 3), (frames, 4), (frames, *markers, 3), (frames, 3, 3)
        for (name, values), shape in zip(vars(self).items(), shapes, strict=True):
            if values.shape != shape:
                raise InputError(f"the {name} of a take have shape {values.shape}; it must be {shape}")
        if not (len(self) and np.isfinite(self.times).all() and (np.diff(self.times) > 0).all()):
            raise InputError("the times of a take must rise from frame to frame")
        seen = ~np.isnan(self.pen_rotations).any(axis=1)
        if not is_unit(self.pen_rotations[seen]).all():
            raise InputError("a quaternion of a take is not of length 1; it must be, or NaN where it was not seen")

    def __len__(self) -> int:
        return len(self.times)

    def interrupted(self, gap: float) -> Self:
        """Return the take with a frame that shows nothing in each pause longer than `gap`, seconds, between frames."""
        after = np.flatnonzero(np.diff(self.times) > gap) + 1
        middles = (self.times[after - 1] + self.times[after]) / 2
        seen = (np.insert(values, after, np.nan, axis=0) for name, values in vars(self).items() if name != "times")
        return type(self)(np.insert(self.times, after, middles), *seen)


def is_unit(quaternions: Floats) -> Bools:
    """Return a mask (...) of the quaternions (..., 4) that are of length 1, within a hundredth."""
    with np.errstate(over="ignore"):
        unit: Bools = np.abs(np.linalg.norm(quaternions, axis=-1) - 1) <= _UNIT_NORM
    return unit


def write_take(take: Take, path: str | Path) -> None:
    """Write the take to a file. Raises OutputError where that fails; what was at `path` is then still there."""
    write_arrays(path, KIND, vars(take))


def read_take(path: str | Path) -> Take:
    """Return the take in the file at `path`. Raises InputError where there is none."""
    arrays = read_arrays(path, KIND, tuple(field.name for field in fields(Take)))
    try:
        return Take(*(array.astype(np.float64) for array in arrays.values()))
    except (InputError, ValueError, TypeError) as error:
        raise InputError(f"{path} is not a file of {KIND}: {error}") from error
