"""First guess of a brush: widths from the covered areas, offsets from their centres."""

from collections.abc import Sequence

import numpy as np
import torch
from scipy.optimize import nnls

from maulstick.brush_fit.descent import PAPER, Unknowns
from maulstick.brush_fit.evidence import Evidence
from maulstick.brush_fit.window import Window
from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import path_lengths

_WIDER = 1.3  # true half-width / that of the covered area, since a cone's edge is too pale to be seen
_FURTHEST = 2e-3  # metres: largest first guess of a stroke's offset


def first_guess(evidence: Evidence) -> Unknowns:
    """Return unknowns from which the descent can start."""
    windows, paths, pixels_per_metre = evidence.windows, evidence.paths, evidence.pixels_per_metre
    pressure = evidence.pressures()
    half_widths = np.array([_half_width(w, p, pixels_per_metre) for w, p in zip(windows, paths, strict=True)])
    unit = float(np.median(half_widths))
    (beta, alpha), _ = nnls(np.stack([np.ones_like(pressure), pressure], axis=1), _WIDER * half_widths / unit)
    raw = {
        "scale": torch.zeros(2),
        "alpha": torch.tensor([np.log(np.expm1(max(alpha, 0.05)))], dtype=torch.float32),
        "beta": torch.tensor([beta], dtype=torch.float32),
        "falloff": torch.tensor([-0.5]),
    }
    if not has_pressures(paths):
        raw.pop("alpha")
        raw["beta"] = torch.tensor([_WIDER])
    places = [_place(w, p, pixels_per_metre) for w, p in zip(windows, paths, strict=True)]
    depth = [np.quantile(np.abs(w.after - w.before)[w.covered], 0.9) for w in windows]
    dark = windows[0].after.shape[2] == 1
    return Unknowns(
        unit,
        {name: raw[name] for name in PAPER if name in raw},
        torch.tensor(np.array(places) / unit, dtype=torch.float32),
        torch.tensor(np.log(np.clip(depth, 0.05, 0.95)) if dark else np.full(len(windows), -0.1), dtype=torch.float32),
        None if dark else torch.tensor(_colour(windows), dtype=torch.float32).logit(1e-2),
    )


def has_pressures(paths: Sequence[Floats]) -> bool:
    """Return whether the strokes (n, 3) were drawn at more than one pressure."""
    pressure = np.array([path[:, 2] for path in paths])
    return bool(np.ptp(pressure) > 0.1)


def _half_width(window: Window, path: Floats, pixels_per_metre: float) -> float:
    """Half-width w, metres, of a stroke of constant width that covers the same area: area = 2 length w + π w²."""
    area = window.covered.sum() / pixels_per_metre**2
    length = float(path_lengths(path[:, :2]))
    return float((np.sqrt(length**2 + np.pi * area) - length) / np.pi)


def _place(window: Window, path: Floats, pixels_per_metre: float) -> Floats:
    rows, columns = np.nonzero(window.covered)
    seen = np.array([columns.mean() + 0.5, rows.mean() + 0.5]) / pixels_per_metre + window.corner
    beside: Floats = np.clip(seen - path[:, :2].mean(axis=0), -_FURTHEST, _FURTHEST)
    return beside


def _colour(windows: Sequence[Window]) -> Floats:
    """Median colour of the most changed pixels of all strokes."""
    deepest = []
    for window in windows:
        change = np.abs(window.after - window.before).mean(axis=2)
        deepest.append(window.after[window.covered & (change >= np.quantile(change[window.covered], 0.75))])
    colour: Floats = np.median(np.concatenate(deepest), axis=0)
    return colour
