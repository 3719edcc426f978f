"""Wacom drawings (Apache-2.0, see NOTICE): all that ships and was learned from people is learned from these."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from maulstick.strokes.ink import Ink
from maulstick.strokes.strokes import Strokes

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"
LONGER_SIDE = 0.15
"""Metres: the drawings do not say how large they are."""
_MARGIN = 0.01
_FINER = 8


def wacom_hands(least: int = 10) -> dict[str, Strokes]:
    """The strokes of each drawing or document that has at least so many."""
    return {name: strokes for name, strokes in each_drawing() if len(strokes) >= least}


def each_drawing() -> list[tuple[str, Strokes]]:
    """Names and strokes of all drawings. The width that the ink of some was drawn with stands for its pressure."""
    with np.load(DATA / "uil_strokes.npz", allow_pickle=False) as file:
        strokes = np.split(file["data"], np.cumsum(file["lens"])[:-1])
        sources = file["source"]
    drawings = []
    for source in sorted(set(sources.tolist())):
        drawn = [stroke[np.isfinite(stroke[:, :2]).all(axis=1)] for stroke in _of(strokes, sources == source)]
        drawn = [stroke for stroke in drawn if len(stroke) > 3]
        places = np.concatenate(drawn)[:, :2]
        scale, origin = LONGER_SIDE / np.ptp(places, axis=0).max(), places.min(axis=0)
        pressures = _pressures(drawn)
        samples = [
            _finer(np.column_stack([stroke[:, 2] - stroke[0, 2], (stroke[:, :2] - origin) * scale, pressure]))
            for stroke, pressure in zip(drawn, pressures, strict=True)
        ]
        name = Path(source).stem.lower().replace(" ", "-").replace(")", "")
        drawings.append((name, Strokes.of(Ink.of(samples, (LONGER_SIDE + _MARGIN,) * 2, f"Wacom, {source}"))))
    return drawings


def _of(strokes: list[NDArray[np.float64]], chosen: NDArray[np.bool_]) -> list[NDArray[np.float64]]:
    return [stroke for stroke, wanted in zip(strokes, chosen, strict=True) if wanted]


def _pressures(drawn: list[NDArray[np.float64]]) -> list[NDArray[np.float64]]:
    """Pressure in [0, 1] of each sample of each stroke, from pressure or from the width of the ink."""
    pressure, width = (np.concatenate([stroke[:, column] for stroke in drawn]) for column in (3, 6))
    varying = np.isfinite(width) & (np.nanmax(width, initial=0) > np.nanmin(width, initial=np.inf))
    if np.isfinite(pressure).any():
        known = [np.isfinite(stroke[:, 3]).all() for stroke in drawn]
        return [
            np.clip(stroke[:, 3], 0, 1) * (1 if whole else np.nan) for stroke, whole in zip(drawn, known, strict=True)
        ]
    if varying.any():
        thin, wide = np.nanquantile(width, (0.02, 0.98))
        return [np.clip((stroke[:, 6] - thin) / max(wide - thin, 1e-9), 0, 1) for stroke in drawn]
    return [np.full(len(stroke), np.nan) for stroke in drawn]


def _finer(samples: NDArray[np.float64]) -> NDArray[np.float64]:
    """A stroke (m, 4) drawn through its samples smoothly: many have so few that straight lines would show corners."""
    at = np.arange(len(samples))
    fine = np.linspace(0, at[-1], _FINER * at[-1] + 1)
    curve = CubicHermiteSpline(at, samples[:, 1:3], np.gradient(samples[:, 1:3], axis=0))(fine)
    rest = [np.interp(fine, at, samples[:, column]) for column in (0, 3)]
    return np.column_stack([np.maximum.accumulate(rest[0]), curve, rest[1]])
