"""Takes that were recorded live, kept as files: whatever becomes of them can be tried again."""

from pathlib import Path

import numpy as np

from maulstick.arrays import read_arrays, write_arrays
from maulstick.errors import InputError
from maulstick.recording.take import Take

KIND = "take"
_SHAPES = {
    "times": (),
    "pen_positions": (3,),
    "pen_rotations": (4,),
    "pen_markers": (None, 3),
    "canvas_markers": (3, 3),
}


def write_take(take: Take, path: str | Path) -> None:
    """Write the take to a file. Raises OutputError where that fails; what was at `path` is then still there."""
    write_arrays(path, KIND, vars(take))


def read_take(path: str | Path) -> Take:
    """The take in the file at `path`. Raises InputError where there is none."""
    arrays = read_arrays(path, KIND, tuple(_SHAPES))
    frames = len(arrays["times"]) if arrays["times"].ndim else 0
    for name, shape in _SHAPES.items():
        came = arrays[name].shape
        right = len(came) == 1 + len(shape) and came[0] == frames
        if not (right and all(want in (None, side) for want, side in zip(shape, came[1:], strict=True))):
            raise InputError(f"{path} is not a file of {KIND}: its {name} have shape {came}")
        if arrays[name].dtype != np.float64:
            raise InputError(f"{path} is not a file of {KIND}: its {name} are not float64")
    take = Take(*(np.asarray(array, dtype=np.float64) for array in arrays.values()))
    if not (frames and np.isfinite(take.times).all() and (np.diff(take.times) > 0).all()):
        raise InputError(f"{path} is not a file of {KIND}: its times do not rise from frame to frame")
    return take
