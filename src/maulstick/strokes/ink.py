"""Ink: raw strokes as they were recorded, and their file."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np

from maulstick.errors import InputError
from maulstick.storage.arrays import Floats, Ints, read_arrays, write_arrays
from maulstick.storage.text import counted

KIND = "ink"
"""Kind of a file of arrays that holds ink."""

_LARGEST_SHEET = 100.0  # metres a side; a larger one is a mistake in the units


@dataclass(frozen=True, repr=False)
class Ink:
    """Raw strokes on a sheet, each with its own number of samples.

    samples: (P, 4) of (t, x, y, pressure), stroke after stroke: seconds since the recording began; metres, x to the
    right and y down from the sheet's upper left corner; pressure in [0, 1].  A stroke whose times or pressure were not
    recorded has NaN there throughout.
    lengths: (N,) number of samples of each stroke, at least 1.
    size: (width, height) of the sheet, metres.
    source: a description of its origin, for people.
    Raises InputError where an array has another shape or values that are not allowed.
    """

    samples: Floats
    lengths: Ints
    size: tuple[float, float]
    source: str = ""

    def __post_init__(self) -> None:
        if self.samples.ndim != 2 or self.samples.shape[1] != 4:
            raise InputError(
                f"samples of ink have shape {self.samples.shape}; it must be (P, 4) of (t, x, y, pressure)"
            )
        counts = self.lengths.ravel().tolist()  # whose sum does not overflow
        if self.lengths.ndim != 1 or min(counts, default=1) < 1 or sum(counts) != len(self.samples):
            raise InputError("the lengths of the strokes must be at least 1 each and add up to the number of samples")
        if not np.isfinite(self.samples[:, 1:3]).all():
            raise InputError("a sample of the ink has no place; every x and y must be a finite number of metres")
        if not all(0 < side <= _LARGEST_SHEET for side in self.size):
            raise InputError.of_range("the sheet of the ink", f"{self.size} m", "between 0 and 100 m wide and high")
        for name, column in (("times", 0), ("pressure", 3)):
            values = self.samples[:, column]
            known = np.add.reduceat(np.isfinite(values), self._starts()) if len(values) else self.lengths
            if np.isinf(values).any() or ((known != 0) & (known != self.lengths)).any():
                raise InputError(f"the {name} of a stroke must be known at all of its samples, or NaN at all of them")
        pressure = self.samples[:, 3]
        if ((pressure < 0) | (pressure > 1)).any():
            raise InputError.of_range("pressure", f"{np.nanmin(pressure):g} to {np.nanmax(pressure):g}", "in [0, 1]")
        backwards = np.diff(self.samples[:, 0]) < 0
        backwards[self._starts()[1:] - 1] = False
        if backwards.any():
            raise InputError("the times of a stroke run backwards; they must never fall from sample to sample")

    def __len__(self) -> int:
        return len(self.lengths)

    def __repr__(self) -> str:
        """Say what `summary` does; samples fill pages."""
        return f"<Ink: {self.summary()}>"

    @classmethod
    def of(cls, strokes: Sequence[Floats], size: tuple[float, float], source: str = "") -> Self:
        """Return the ink of strokes (m, 4) of (t, x, y, pressure); m may differ from stroke to stroke."""
        samples = np.concatenate([np.zeros((0, 4)), *strokes])
        return cls(samples, np.array([len(stroke) for stroke in strokes], dtype=np.int64), size, source)

    def strokes(self) -> list[Floats]:
        """Return the samples of each stroke, (m, 4)."""
        return np.split(self.samples, self._starts()[1:]) if len(self) else []

    def summary(self) -> str:
        """Return one line for people: number of strokes, length drawn, duration, what was recorded."""
        strokes = self.strokes()
        metres = sum(float(np.hypot(*np.diff(stroke[:, 1:3], axis=0).T).sum()) for stroke in strokes)
        width, height = (f"{round(1e3 * side, 1):g}" for side in self.size)
        drawn = f"{metres:.0f}" if metres >= 100 else f"{metres:.3g}"
        told = f"{counted(len(self), 'stroke')}, {drawn} m drawn on {width} x {height} mm"
        if not strokes:
            return told
        times = self.samples[:, 0]
        unknown = np.isnan(times).all()
        told += ", times not recorded" if unknown else f", {_duration(np.nanmax(times) - np.nanmin(times))}"
        pressed = sum(not np.isnan(stroke[0, 3]) for stroke in strokes)
        part = {0: "not recorded", len(self): "recorded"}.get(pressed, f"recorded in {pressed} of them")
        return f"{told}, pressure {part}"

    def _starts(self) -> Ints:
        return np.cumsum(self.lengths) - self.lengths


def _duration(seconds: float) -> str:
    if seconds < 60:
        return f"{seconds:.3g} s"
    minutes, left = divmod(round(seconds), 60)
    return f"{minutes} min {left} s"


def write_ink(ink: Ink, path: str | Path) -> None:
    """Write the ink to a file. Raises OutputError where that fails; what was at `path` is then still there."""
    size, source = np.array(ink.size), np.array(ink.source)
    write_arrays(path, KIND, {"samples": ink.samples, "lengths": ink.lengths, "size": size, "source": source})


def read_ink(path: str | Path) -> Ink:
    """Return the ink in the file at `path`. Raises InputError where there is none."""
    arrays = read_arrays(path, KIND, ("samples", "lengths", "size", "source"))
    try:
        if arrays["size"].shape != (2,):
            raise InputError(f"its size has shape {arrays['size'].shape}; it must be (2,) of width and height")
        width, height = arrays["size"].astype(np.float64).tolist()
        if arrays["lengths"].dtype.kind not in "iu":
            raise InputError(f"the lengths of its strokes are {arrays['lengths'].dtype}; they must be whole numbers")
        samples, lengths = arrays["samples"].astype(np.float64), arrays["lengths"].astype(np.int64)
        return Ink(samples, lengths, (width, height), str(arrays["source"]))
    except (InputError, ValueError, TypeError) as error:
        raise InputError(f"{path} is not a file of {KIND}: {error}") from error
