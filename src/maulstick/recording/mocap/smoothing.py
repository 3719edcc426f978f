"""Smoothing of a movement that trembles, has outliers and gaps."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.linalg import solveh_banded
from scipy.ndimage import maximum_filter1d

from maulstick.storage.arrays import Bools, Floats, Ints

_FEWEST = 6  # sightings, to say anything of a stretch
_OUTLYING, _TOLERATED = 5.0, 5e-4  # standard deviations; metres, within which nothing is an outlier
_ROUNDS, _THEREABOUTS = 12, 9  # the latter in frames
_PILOT = 30.0  # hertz
_CHOICES = (8.0, 10.0, 12.5, 16.0, 20.0, 25.0, 32.0, 40.0, 50.0)  # hertz
_FIFTH = np.array([-1.0, 5.0, -10.0, 10.0, -5.0, 1.0])


@dataclass(frozen=True)
class Smoothed:
    """A movement at F times.

    values: (F, k); NaN where they are not known.  used: (F,), which sightings counted.
    noise: of an axis, RMS, as it was before smoothing.  hertz: at which a movement comes through by half.
    """

    values: Floats
    used: Bools
    noise: float
    hertz: float


def smooth(times: Floats, values: Floats, gap: float) -> Smoothed:
    """The movement behind values (F, k) at times (F,), rising; NaN where there was no sighting.

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
        # Only the worst thereabouts: it has bent the curve away from its neighbours.
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
    """Stretches of f frames in which no gap is too long, stretch after stretch.

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
        """(f, k): the least squares of what is left over, plus the stiffness times those of the differences."""
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
        """Standard deviation of an axis, from the fifth differences: no hand moves that fast."""
        if len(self.frames) < len(_FIFTH):
            return 0.0
        whole = np.asarray(np.all(self.differences, axis=1))  # crosses no end of a stretch
        fifth = (sliding_window_view(self.values, len(_FIFTH), axis=0) @ _FIFTH)[whole[:-2] & whole[2:]]
        fifth = fifth[np.isfinite(fifth)]
        return float(1.4826 * np.median(np.abs(fifth)) / np.linalg.norm(_FIFTH)) if len(fifth) else 0.0

    def risk(self, hertz: float, noise: float) -> float:
        """What the squared error of the curve is expected to be, but for a constant."""
        response = 1 / (1 + self._stiffness(hertz) * (2 * np.sin(np.linspace(0, np.pi / 2, 1000))) ** 6)
        return float(np.nanmean((self.values - self.curve(hertz)) ** 2) + 2 * noise**2 * response.mean())

    def _stiffness(self, hertz: float) -> float:
        return float((2 * np.sin(min(np.pi * hertz * self.interval, np.pi / 2))) ** -6)
