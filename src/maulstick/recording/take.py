"""A take: what motion capture saw of a pen and a canvas, whichever way it came."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Take:
    """F frames in the frame of the capture system, metres and seconds; NaN where something was not seen.

    times: (F,), rising.
    pen_positions: (F, 3) and pen_rotations: (F, 4), quaternions (x, y, z, w), of the pen's rigid body.
    pen_markers: (F, M, 3), the markers on the pen in a fixed order; M is 0 where none were exported.
    canvas_markers: (F, 3, 3), the markers at three corners of the canvas, in a fixed but unknown order.
    """

    times: Floats
    pen_positions: Floats
    pen_rotations: Floats
    pen_markers: Floats
    canvas_markers: Floats

    def __len__(self) -> int:
        return len(self.times)
