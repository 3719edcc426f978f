"""Smoothing of a movement with noise, outliers and gaps."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.linalg import solveh_banded
from scipy.ndimage import maximum_filter1d

from maulstick.storage.arrays import Bools, Floats, Ints

_FEWEST = 6  # sightings of a stretch; shorter ones are left out
_OUTLYING, _TOLERATED = 5.0, 5e-4  # least error of an outlier: standard deviations of noise, and metres
_ROUNDS, _THEREABOUTS = 12, 9  # most rounds of leaving out outliers, one per so many frames in each
_PILOT = 30.0  # hertz: cutoff of the curve that outliers are measured from
_CHOICES = (8.0, 10.0, 12.5, 16.0, 20.0, 25.0, 32.0, 40.0, 50.0)  # hertz: cutoffs that are tried
_FIFTH = np.array([-1.0, 5.0, -10.0, 10.0, -5.0, 1.0])  # coefficients of the fifth difference


@dataclass(frozen=True)
class Smoothed:
    """Smoothed movement at F times.

    values: (F, k); NaN where they are unknown.  used: (F,), sightings that were used.
    noise: RMS of an axis before smoothing.  hertz: cutoff, the frequency that is halved.
    """

    values: Floats
    used: Bools
    noise: float
    hertz: float


def smooth(times: Floats, values: Floats, gap: float) -> Smoothed:
    """Smooth values (F, k) at rising times (F,), seconds; values are NaN where there was no sighting.

    Penalised least squares on the third difference, which is a smoothing spline (Whittaker 1923; Eilers, "A perfect
    smoother", 2003): it goes through gaps of up to `gap` seconds and on to the very ends. Its stiffness is the one of
    least risk for the noise that the fifth differences show (Stein's unbiased estimate), which leaves more of a fast
    hand than of a slow one, and more where there is less noise. Sightings off by five times the noise, and half a
    millimetre at least, are left out.
    """
    used = np.isfinite(values[:, 0])
    result = np.full_like(values, np.nan)
    seen = _Sightings.of(times, values, used, gap)
    noise, hertz = seen.noise(), _PILOT
    for _ in range(_ROUNDS):
        off = np.nan_to_num(np.linalg.norm(seen.values - seen.curve(_PILOT), axis=1))
        # Only the worst one of its neighbourhood, since it has pulled the curve away from its neighbours.
        worst = (off > max(_OUTLYING * noise, _TOLERATED)) & (off == maximum_filter1d(off, _THEREABOUTS))
        if not worst.any():
            break
        used[seen.frames[worst]] = False
        seen = _Sightings.of(times, values, used, gap)
    if len(seen.frames):
        hertz = min(_CHOICES, key=lambda hertz: seen.risk(hertz, noise))
        result[seen.frames] = seen.curve(hertz)
    return Smoothed(result, used & np.isfinite(result[:, 0]), noise, hertz)


@dataclass(frozen=True)
class _Sightings:
    """Stretches without long gaps, one after another, f frames in all.

    values: (f, k), NaN within gaps.  differences: (f - 3, 4), the coefficients of the third divided differences: -1,
    3, -3, 1 at even times, 0 where they would cross from one stretch to the next.  interval: seconds.
    """

    frames: Ints
    values: Floats
    differences: Floats
    interval: float

    @classmethod
    def of(cls, times: Floats, values: Floats, used: Bools, gap: float) -> Self:
        sightings = np.flatnonzero(used)
        breaks = np.flatnonzero(np.diff(times[sightings]) > gap) + 1
        stretches = [stretch for stretch in np.split(sightings, breaks) if len(stretch) >= _FEWEST]
        frames = np.concatenate([np.zeros(0, int), *(np.arange(part[0], part[-1] + 1) for part in stretches)])
        if not len(frames):
            return cls(frames, values[frames], np.zeros((0, 4)), 1.0)
        interval = float(np.median(np.diff(times)))
        four = sliding_window_view(times[frames] / interval, 4)
        differences = 6 / (four[:, :, None] - four[:, None, :] + np.eye(4)).prod(axis=2)
        starts = np.isin(frames, [stretch[0] for stretch in stretches])
        differences[sliding_window_view(starts, 4)[:, 1:].any(axis=1)] = 0
        return cls(frames, np.where(used[frames, None], values[frames], np.nan), differences, interval)

    def curve(self, hertz: float) -> Floats:
        """Curve (f, k) that minimises the squares of residuals plus stiffness times the squares of its differences."""
        if not len(self.frames):
            return self.values
        seen = np.isfinite(self.values)
        bands = np.zeros((4, len(self.frames)))
        bands[0] = seen[:, 0]
        for i in range(4):
            for j in range(i, 4):
                products = self.differences[:, i] * self.differences[:, j]
                bands[j - i, i : i + len(products)] += self._stiffness(hertz) * products
        curve: Floats = solveh_banded(bands, np.where(seen, self.values, 0), lower=True, check_finite=False)
        return curve

    def noise(self) -> float:
        """Standard deviation of an axis, from the fifth differences, to which a hand's movement contributes nothing."""
        if len(self.frames) < len(_FIFTH):
            return 0.0
        whole = np.asarray(np.all(self.differences, axis=1))  # within one stretch
        fifth = (sliding_window_view(self.values, len(_FIFTH), axis=0) @ _FIFTH)[whole[:-2] & whole[2:]]
        fifth = fifth[np.isfinite(fifth)]
        return float(1.4826 * np.median(np.abs(fifth)) / np.linalg.norm(_FIFTH)) if len(fifth) else 0.0

    def risk(self, hertz: float, noise: float) -> float:
        """Expected squared error of the curve, without a constant (Stein's unbiased estimate)."""
        response = 1 / (1 + self._stiffness(hertz) * (2 * np.sin(np.linspace(0, np.pi / 2, 1000))) ** 6)
        return float(np.nanmean((self.values - self.curve(hertz)) ** 2) + 2 * noise**2 * response.mean())

    def _stiffness(self, hertz: float) -> float:
        return float((2 * np.sin(min(np.pi * hertz * self.interval, np.pi / 2))) ** -6)
