"""Calibration of the tip of a pen by turning the pen about it."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from maulstick.errors import InputError
from maulstick.recording.mocap.take import Take
from maulstick.recording.mocap.tip import steady
from maulstick.storage.arrays import Floats
from maulstick.storage.text import counted

_FEWEST = 50  # frames that must show the pen
_LEAST_TURN = np.radians(8.0)  # RMS; cones of 25 degrees give 15
_WORST, _EXACT = 2e-3, 1e-9  # metres: largest residual that is accepted, and error below which no frame is an outlier
_ROUNDS, _OUTLYING = 10, 3.5  # most rounds of leaving out outliers, and their error in multiples of the median
_ABOUT = 0.1  # metres: rough distance from a rigid body to the tip


@dataclass(frozen=True)
class Pivot:
    """Tip of a pen, found by turning the pen about it.

    tip: (3,), in the frame of the pen's rigid body, metres.
    residual: RMS distance of the tip from its mean place, metres.
    rejected: number of frames that were left out as outliers.
    """

    tip: Floats
    residual: float
    rejected: int


def calibrate_pivot(take: Take) -> Pivot:
    """Find the tip of a pen that was turned about its resting tip in all directions.

    With the pose (R, p) of the pen in each frame, this is least squares for R tip + p = the place of the tip; frames
    that do not fit are left out and it is solved again.

    Raises InputError where the pen was seen or turned too little, or its tip moved.
    """
    seen = np.isfinite(take.pen_positions[:, 0]) & np.isfinite(take.pen_rotations).all(axis=1)
    rotations = Rotation.from_quat(take.pen_rotations[seen]).as_matrix().reshape(-1, 3, 3)
    positions = take.pen_positions[seen]
    # The tip is not known yet, so one point on each of the three axes is used instead.
    kept = steady(take.times[seen], _ABOUT * rotations.reshape(-1, 9))
    if kept.sum() < _FEWEST:
        raise InputError(
            f"the pen can be followed in {counted(int(kept.sum()), 'frame')} of the pivot take; "
            f"it must be {_FEWEST} at least"
        )
    for _ in range(_ROUNDS):
        tip, turned = _solve(rotations[kept], positions[kept])
        places = rotations @ tip + positions
        errors = np.linalg.norm(places - np.median(places[kept], axis=0), axis=1)
        before, kept = kept, errors <= max(_OUTLYING * float(np.median(errors[kept])), _EXACT)
        if (kept == before).all():
            break
    if turned < _LEAST_TURN:
        raise InputError(
            f"the pen was turned by {np.degrees(turned):.1f} degrees (RMS) in the pivot take; it must be "
            f"{np.degrees(_LEAST_TURN):.0f} at least about every axis: lean it by 30 degrees to all sides"
        )
    residual = float(np.sqrt(np.mean(errors[kept] ** 2)))
    if residual > _WORST:
        raise InputError(
            f"the tip strays {residual * 1e3:.1f} mm (RMS) from one place in the pivot take; it must be at most "
            f"{_WORST * 1e3:g} mm: stand the tip in a small hole and turn the pen about it, nothing else"
        )
    return Pivot(tip, residual, int((~kept).sum()))


def _solve(rotations: Floats, positions: Floats) -> tuple[Floats, float]:
    """Solve for the tip; return also the RMS turn, radians, in the direction that is determined worst."""
    turns, moves = rotations - rotations.mean(axis=0), positions - positions.mean(axis=0)
    normal = np.einsum("fij,fik->jk", turns, turns)
    tip = np.linalg.lstsq(normal, -np.einsum("fij,fi->j", turns, moves))[0]
    return tip, float(np.sqrt(max(0.0, np.linalg.eigvalsh(normal)[0]) / len(turns)))
