"""Opacity of whole strokes, and its dependence on their mean pressure."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from maulstick.storage.arrays import Floats

_PRESSURES = np.linspace(0.1, 1.0, 19)  # candidates for `solid`
_LEAST = 1e-3  # opacity: a brush must leave a mark
_NORMAL = 1.4826  # standard deviation / median absolute deviation, of a normal distribution


@dataclass(frozen=True)
class Flow:
    """Opacity, faint and solid as in `Brush`; scatter: standard deviation of strokes about them, a share of opacity."""

    opacity: float
    faint: float
    solid: float
    scatter: float

    def at(self, pressure: Floats) -> Floats:
        """Opacity (N,) of strokes with these mean pressures (N,)."""
        return self.opacity * (self.faint + (1 - self.faint) * np.minimum(pressure / self.solid, 1))


def fit_flow(pressure: Floats, opacity: Floats, pales: bool) -> Flow:
    """Fit the flow of strokes with mean pressures (N,) and opacities (N,).  pales: whether light ones are paler."""
    flow = (_paling if pales else _even)(pressure, opacity)
    scatter = _NORMAL * np.median(np.abs(opacity - flow.at(pressure))) / flow.opacity
    return Flow(flow.opacity, flow.faint, flow.solid, float(scatter))


def _even(pressure: Floats, opacity: Floats) -> Flow:
    return Flow(float(np.median(opacity).clip(_LEAST, 1)), 1.0, 1.0, 0.0)


def _paling(pressure: Floats, opacity: Floats) -> Flow:
    """Fit `faint` and `opacity` for each candidate of `solid`, and return the flow of least absolute deviation."""
    fits = []
    for solid in _PRESSURES:
        risen = np.minimum(pressure / solid, 1)
        at_0, at_solid = _line(risen, opacity)
        top = float(np.clip(at_solid, _LEAST, 1))
        fits.append(Flow(top, float(np.clip(at_0 / top, _LEAST, 1)), float(solid), 0.0))
    return min(fits, key=lambda flow: float(np.abs(opacity - flow.at(pressure)).mean()))


def _line(x: Floats, y: Floats) -> tuple[float, float]:
    """Heights at 0 and at 1 of the line through points x, y (N,), by robust least squares."""

    def off(ends: Floats) -> Floats:
        return np.asarray(ends[0] * (1 - x) + ends[1] * x - y)

    fit = least_squares(off, (0.5, 0.5), loss="soft_l1", f_scale=0.02)
    return float(fit.x[0]), float(fit.x[1])
